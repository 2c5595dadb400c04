#include "results/exports.hpp"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/numbers.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

double ratio(double a, double b) { return b > 0 ? a / b : std::nan(""); }

/// Adds every field of a record. A NaN is null, infinity "unbounded".
template <class Record, class Fields>
void add_fields(Json& object, const Record& record, const Fields& fields) {
  each_field(record, fields, [&]<class T>(std::string_view name, const T& value) {
    Json& cell = object[std::string(name)] = value;
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(value)) cell = std::isnan(value) ? Json() : Json("unbounded");
  });
}

std::string csv_text(const Json& cell) {
  if (cell.is_string()) return csv_cell(cell.get_ref<const std::string&>());
  if (cell.is_number_integer()) return std::to_string(cell.get<std::int64_t>());
  return cell.is_null() || std::isnan(cell.get<double>()) ? "" : to_text(cell.get<double>());
}

/// JSON must be UTF-8; a path or formula that is not is repaired rather than refused.
std::string dumped(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// Mean, median, standard deviation (n - 1) and coefficient of variation of seconds.
struct Aggregates {
  double mean, median, stddev, cv;
};

Aggregates aggregates(const std::vector<double>& samples) {
  const auto n = static_cast<double>(samples.size());
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / n;
  double squares = 0;
  for (const double x : samples) squares += (x - mean) * (x - mean);
  const double stddev = n > 1 ? std::sqrt(squares / (n - 1)) : 0;
  return {.mean = mean,
          .median = summarise(samples).median,
          .stddev = stddev,
          .cv = mean > 0 ? stddev / mean : 0};
}

}  // namespace

Json object_of(const Row& row) {
  const RowKey& key = row.key;
  const TimingSummary time = summarise(times_of(row));
  const bool there = is_on_device(row);
  const auto when = [](bool applies, double value) { return applies ? Json(value) : Json(); };
  Json object{HMAX_KEYS(key, problem, material, method, mode),
              {"h", when(key.mode != "adaptive", key.h)},
              {"rtol", when(key.mode != "fixed", key.rtol)},
              {"t_end", key.t_end},
              HMAX_KEYS(row, outcome, t_reached, steps, rhs),
              {"cpu_median_s", when(!there, time.median)},
              {"cpu_q1_s", when(!there, time.q1)},
              {"cpu_q3_s", when(!there, time.q3)},
              {"cpu_p99_s", when(!there, time.p99)},
              HMAX_KEYS(row, error_end, error_global),
              {"realtime_factor", ratio(row.t_reached, time.median)},
              HMAX_KEYS(key, parameters, y0, control),
              {"atol", when(key.mode != "fixed", key.atol)},
              {"rejected", row.rejected},
              {"cpu_per_step_median_s", when(!there, ratio(time.median, static_cast<double>(row.steps)))},
              {"repetitions", times_of(row).size()},
              HMAX_KEYS(row, runs_per_sample, reference, reference_error, error_l2, subnormals, session),
              {"explored", std::int64_t{row.explored}},
              HMAX_KEYS(key, device, precision),
              {"clock_mhz", when(there, row.clock_mhz)},
              {"driver", row.driver},
              {"device_median_s", when(there, time.median)},
              {"device_q1_s", when(there, time.q1)},
              {"device_q3_s", when(there, time.q3)},
              {"device_p99_s", when(there, time.p99)}};
  std::string status = row.status;
  if (status.empty()) {
    for (const auto& [name, value] : object.items())
      if (value.is_number_float() && !std::isfinite(value.get<double>()))
        status += (status.empty() ? "No finite value for " : ", ") + name;
    if (!status.empty()) status += '.';
  }
  object["status"] = status;
  return object;
}

Json object_of(const LimitRow& row) {
  Json object;
  add_fields(object, row.point, point_key_fields);
  add_fields(object, row, limit_fields);
  object.erase("details");
  object["session"] = row.session;
  return object;
}

Json object_of(const AdviceRecord& record) {
  Json object;
  add_fields(object, record.key, advice_key_fields);
  add_fields(object, record, advice_fields);
  object["session"] = record.session;
  return object;
}

std::string detail::csv_header(const Json& object) {
  std::string header;
  for (const auto& [name, value] : object.items()) header += (header.empty() ? "" : ",") + name;
  return header + "\n";
}

std::string detail::csv_line(const Json& object) {
  std::string line;
  for (const auto& [name, value] : object.items())
    line += (&value == &object.front() ? "" : ",") + csv_text(value);
  return line + "\n";
}

std::string detail::json_line(Json object, bool whole_numbers) {
  constexpr double exact = 9007199254740992;  // 2^53
  for (auto& [name, value] : object.items()) {
    if (!whole_numbers || !value.is_number_float()) continue;
    const double number = value.get<double>();
    if (number == std::trunc(number) && std::abs(number) < exact && !(number == 0 && std::signbit(number)))
      value = static_cast<std::int64_t>(number);
  }
  return dumped(object, -1) + "\n";
}

std::string benchmark_name(const RowKey& key) {
  std::string name = key.problem;
  const auto add = [&](const std::string& part) {
    if (!part.empty()) name += '/' + part;
  };
  add(key.material);
  add(key.parameters);
  if (!key.y0.empty()) add("y0=" + key.y0);
  add(key.method);
  add(key.mode);
  if (key.control != "none") add(key.control);
  if (!key.device.empty()) add("device:" + key.device + "/" + key.precision);
  if (key.mode != "adaptive") add("h:" + to_text(key.h));
  if (key.mode != "fixed") add("rtol:" + to_text(key.rtol) + "/atol:" + to_text(key.atol));
  add("t_end:" + to_text(key.t_end));
  return name;
}

namespace {

/// Why a row has no CPU time that others can be compared with.
std::string words_of_no_time(const Row& row) {
  if (is_on_device(row)) return "The row has the time of a device and no CPU time.";
  if (row.explored) return "The row was explored: its CPU time is not comparable.";
  return row.status.empty() ? "No CPU time was measured: " + row.outcome + "." : row.status;
}

}  // namespace

std::string rows_to_google_benchmark(std::span<const Row> rows, const Fingerprint& fingerprint) {
  constexpr double ns = 1e9;
  Json benchmarks = Json::array();
  for (std::size_t index = 0; index < rows.size(); ++index) {
    const Row& row = rows[index];
    const std::string name = benchmark_name(row.key);
    const Json base{{"name", name},     {"family_index", index},   {"per_family_instance_index", 0},
                    {"run_name", name}, {"run_type", "iteration"}, {"repetitions", row.cpu_s.size()}};
    const auto entry = [&](double real, const char* unit) {
      Json e = base;
      e["threads"] = 1;
      e["iterations"] = row.runs_per_sample;
      e["real_time"] = real;
      e["cpu_time"] = real;
      e["time_unit"] = unit;
      return e;
    };
    if (is_on_device(row) || !std::isfinite(summarise(comparable_times(row)).median)) {
      Json e = entry(0.0, "ns");
      e["repetition_index"] = 0;
      e["error_occurred"] = true;
      e["error_message"] = words_of_no_time(row);
      benchmarks.push_back(std::move(e));
      continue;
    }
    for (std::size_t repetition = 0; repetition < row.cpu_s.size(); ++repetition) {
      Json e = entry(row.cpu_s[repetition] * ns, "ns");
      e["repetition_index"] = repetition;
      e["label"] = row.outcome;
      e["steps"] = row.steps;
      e["rhs"] = row.rhs;
      if (std::isfinite(row.error_end)) e["error_end"] = row.error_end;
      if (std::isfinite(row.error_global)) e["error_global"] = row.error_global;
      if (std::isfinite(row.error_l2)) e["error_l2"] = row.error_l2;
      benchmarks.push_back(std::move(e));
    }
    const Aggregates all = aggregates(row.cpu_s);
    const std::pair<const char*, double> values[] = {
        {"mean", all.mean * ns}, {"median", all.median * ns}, {"stddev", all.stddev * ns}, {"cv", all.cv}};
    for (const auto& [aggregate, value] : values) {
      Json e = entry(value, "ns");
      e["name"] = name + "_" + aggregate;
      e["run_type"] = "aggregate";
      e["aggregate_name"] = aggregate;
      e["aggregate_unit"] = std::string_view(aggregate) == "cv" ? "percentage" : "time";
      e["iterations"] = row.cpu_s.size();
      benchmarks.push_back(std::move(e));
    }
  }
  const double cores = to_number(fingerprint.cores).value_or(0);
  const Json document{{"context",
                       {{"executable", "hmax"},
                        {"num_cpus", static_cast<int>(cores)},
                        {"library_build_type", fingerprint.debug_build ? "debug" : "release"},
                        {"hmax_clock", "CPU time of the thread; real_time repeats cpu_time"},
                        {"hmax_fingerprint", Json::parse(to_json(fingerprint))}}},
                      {"benchmarks", benchmarks}};
  return dumped(document, 2) + '\n';
}

}  // namespace hmax
