#include "results/exports.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/results/made_rows.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using nlohmann::json;

Row measured() {
  Row r = made_row("rk4", 0.1);
  r.cpu_s = {4e-3, 1e-3, 2e-3, 3e-3};
  r.runs_per_sample = 8;
  r.error_end = 1e-6;
  r.error_global = 2e-6;
  r.reference = "dop_853";
  r.reference_error = 1e-14;
  return r;
}

Row diverged() {
  Row r = measured();
  r.key.mode = "adaptive";
  r.key.h = 0;
  r.key.rtol = 1e-3;
  r.key.atol = 1e-6;
  r.key.control = "pi";
  r.outcome = "diverged";
  r.t_reached = 3;
  r.cpu_s = {};
  r.error_end = std::numeric_limits<double>::quiet_NaN();
  r.error_global = std::numeric_limits<double>::infinity();
  return r;
}

Row on_a_device() {
  Row r = measured();
  r.key.device = "card";
  r.key.precision = "double";
  r.device_s.swap(r.cpu_s);
  r.clock_mhz = 1980;
  r.driver = "driver 1, run time 2";
  return r;
}

// The contract of `hmax export`, typed here a second time on purpose.
const std::vector<std::string> fixed_keys{
    "problem",   "material",     "method",         "mode",      "h",
    "rtol",      "t_end",        "outcome",        "t_reached", "steps",
    "rhs",       "cpu_median_s", "cpu_q1_s",       "cpu_q3_s",  "cpu_p99_s",
    "error_end", "error_global", "realtime_factor"};

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

TEST(Exports, CsvHasTheFixedColumnsFirstAndEmptyCellsForMissingNumbers) {
  std::istringstream in(rows_to_csv(std::vector{measured(), diverged()}));
  std::string header, first, second, rest;
  std::getline(in, header);
  std::getline(in, first);
  std::getline(in, second);
  EXPECT_FALSE(std::getline(in, rest));
  const auto names = split(header), a = split(first), b = split(second);
  ASSERT_GE(names.size(), fixed_keys.size());
  for (std::size_t i = 0; i < fixed_keys.size(); ++i) EXPECT_EQ(names[i], fixed_keys[i]);
  ASSERT_EQ(a.size(), names.size());
  ASSERT_EQ(b.size(), names.size());
  const auto at = [&](const std::vector<std::string>& cells, const std::string& name) {
    return cells[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
  };
  EXPECT_EQ(at(a, "h"), "0.1");
  EXPECT_EQ(at(a, "rtol"), "");
  EXPECT_EQ(at(a, "y0"), "0.5,1");
  EXPECT_EQ(at(a, "cpu_median_s"), "0.0025");
  EXPECT_EQ(at(a, "realtime_factor"), "40000");
  EXPECT_EQ(at(a, "cpu_per_step_median_s"), "2.5e-06");
  EXPECT_EQ(at(b, "h"), "");
  EXPECT_EQ(at(b, "rtol"), "0.001");
  EXPECT_EQ(at(b, "error_global"), "inf");
  EXPECT_EQ(at(b, "cpu_median_s"), "");
  EXPECT_NE(at(b, "status"), "");
}

TEST(Exports, JsonlIsOneObjectPerRowWithNullsAndAStatus) {
  std::istringstream in(rows_to_jsonl(std::vector{measured(), diverged()}));
  std::string line;
  ASSERT_TRUE(std::getline(in, line));
  const json a = json::parse(line);
  for (const std::string& key : fixed_keys) EXPECT_TRUE(a.contains(key)) << key;
  EXPECT_EQ(a["h"], 0.1);
  EXPECT_TRUE(a["rtol"].is_null());
  EXPECT_EQ(a["steps"], 1000);
  EXPECT_EQ(a["cpu_q1_s"], 0.00175);
  EXPECT_EQ(a["status"], "");
  ASSERT_TRUE(std::getline(in, line));
  const json b = json::parse(line);
  EXPECT_TRUE(b["h"].is_null());
  EXPECT_TRUE(b["error_end"].is_null());
  EXPECT_TRUE(b["error_global"].is_null());
  EXPECT_TRUE(b["realtime_factor"].is_null());
  EXPECT_EQ(b["t_reached"], 3);
  EXPECT_TRUE(says(b["status"].get<std::string>(), "error_end"));
}

TEST(Exports, HaveTheTimeOfADeviceInColumnsOfItsOwn) {
  std::istringstream in(rows_to_jsonl(std::vector{measured(), on_a_device()}));
  std::string line;
  std::getline(in, line);
  const json here = json::parse(line);
  std::getline(in, line);
  const json there = json::parse(line);
  for (const char* name : {"median", "q1", "q3", "p99"}) {
    const std::string cpu = fmt::format("cpu_{}_s", name), device = fmt::format("device_{}_s", name);
    EXPECT_TRUE(here[cpu].is_number() && here[device].is_null()) << name;
    EXPECT_TRUE(there[cpu].is_null()) << name;
    EXPECT_EQ(there[device], here[cpu]) << name;
  }
  EXPECT_TRUE(there["cpu_per_step_median_s"].is_null());
  EXPECT_EQ(there["realtime_factor"], here["realtime_factor"]);
  EXPECT_EQ(there["repetitions"], 4);
  EXPECT_EQ(there["status"], "");
  EXPECT_EQ(there["device"], "card");
  EXPECT_EQ(there["precision"], "double");
  EXPECT_EQ(there["clock_mhz"], 1980);
  EXPECT_EQ(there["driver"], "driver 1, run time 2");
  EXPECT_EQ(here["device"], "");
  EXPECT_EQ(here["precision"], "");
  EXPECT_TRUE(here["clock_mhz"].is_null());
  EXPECT_EQ(here["driver"], "");
}

TEST(Exports, GoogleBenchmarkHasNoTimesOfDevices) {
  const json document = json::parse(rows_to_google_benchmark(std::vector{on_a_device()}, {}));
  ASSERT_EQ(document["benchmarks"].size(), 1U);
  EXPECT_EQ(document["benchmarks"][0]["cpu_time"], 0);
  EXPECT_TRUE(says(document["benchmarks"][0]["error_message"].get<std::string>(), "time of a device"));
}

TEST(Exports, GoogleBenchmarkHasOneEntryPerRepetitionAndItsAggregates) {
  Fingerprint print;
  print.cores = "2";
  const json document = json::parse(rows_to_google_benchmark(std::vector{measured(), diverged()}, print));
  EXPECT_EQ(document["context"]["num_cpus"], 2);
  EXPECT_EQ(document["context"]["library_build_type"], "release");
  const double expected_ns[] = {4e6, 1e6, 2e6, 3e6};
  int repetitions = 0, errors = 0;
  std::set<std::string> aggregates;
  for (const json& entry : document["benchmarks"]) {
    for (const char* key :
         {"name", "run_name", "run_type", "real_time", "cpu_time", "time_unit", "iterations", "threads"}) {
      EXPECT_TRUE(entry.contains(key)) << key;
    }
    EXPECT_EQ(entry["time_unit"], "ns");
    if (entry.contains("error_occurred")) {
      ++errors;
    } else if (entry["run_type"] == "iteration") {
      EXPECT_EQ(entry["repetition_index"], repetitions);
      EXPECT_EQ(entry["iterations"], 8);
      EXPECT_DOUBLE_EQ(entry["cpu_time"].get<double>(), expected_ns[repetitions++]);
    } else {
      const std::string name = entry["aggregate_name"];
      aggregates.insert(name);
      EXPECT_EQ(entry["name"], entry["run_name"].get<std::string>() + "_" + name);
      const double stddev = std::sqrt(5.0 / 3), mean = 2.5;
      const double value = name == "stddev" ? stddev * 1e6 : name == "cv" ? stddev / mean : mean * 1e6;
      EXPECT_NEAR(entry["cpu_time"].get<double>(), value, 1e-12 * value);
    }
  }
  EXPECT_EQ(repetitions, 4);
  EXPECT_EQ(errors, 1);
  EXPECT_EQ(aggregates, (std::set<std::string>{"mean", "median", "stddev", "cv"}));
}

TEST(Exports, EveryPartOfAKeyIsInItsBenchmarkName) {
  const RowKey key = diverged().key;
  std::set<std::string> names{benchmark_name(key)};
  const auto changed = [&](auto&& change) {
    RowKey other = key;
    change(other);
    EXPECT_TRUE(names.insert(benchmark_name(other)).second) << benchmark_name(other);
  };
  changed([](RowKey& k) { k.problem = "other"; });
  changed([](RowKey& k) { k.material = "male_fat"; });
  changed([](RowKey& k) { k.parameters = "m=1"; });
  changed([](RowKey& k) { k.y0 = "1,1"; });
  changed([](RowKey& k) { k.method = "rk2"; });
  changed([](RowKey& k) { k.mode = "sampled"; });
  changed([](RowKey& k) { k.control = "i"; });
  changed([](RowKey& k) { k.device = "card"; });
  changed([](RowKey& k) { k.device = "card", k.precision = "single"; });
  changed([](RowKey& k) { k.rtol = 1e-4; });
  changed([](RowKey& k) { k.atol = 1e-7; });
  changed([](RowKey& k) { k.t_end = 10; });
  changed([](RowKey& k) { k.mode = "sampled", k.h = 0.2; });
}

}  // namespace
}  // namespace hmax
