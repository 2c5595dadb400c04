#include "results/exports.hpp"

#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/numbers.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;
using Cell = std::variant<std::string, std::int64_t, std::optional<double>>;

constexpr std::string_view columns[] = {"problem",
                                        "material",
                                        "method",
                                        "mode",
                                        "h",
                                        "rtol",
                                        "t_end",
                                        "outcome",
                                        "t_reached",
                                        "steps",
                                        "rhs",
                                        "cpu_median_s",
                                        "cpu_q1_s",
                                        "cpu_q3_s",
                                        "cpu_p99_s",
                                        "error_end",
                                        "error_global",
                                        "realtime_factor",
                                        "parameters",
                                        "y0",
                                        "control",
                                        "atol",
                                        "rejected",
                                        "cpu_per_step_median_s",
                                        "repetitions",
                                        "runs_per_sample",
                                        "reference",
                                        "reference_error",
                                        "error_l2",
                                        "subnormals",
                                        "session",
                                        "explored",
                                        "status"};

double ratio(double a, double b) { return b > 0 ? a / b : std::nan(""); }

/// The cells of one row, in the order of `columns`.
std::vector<Cell> cells_of(const Row& row) {
  const RowKey& key = row.key;
  const TimingSummary cpu = summarise(row.cpu_s);
  const auto when = [](bool applies, double value) { return applies ? std::optional(value) : std::nullopt; };
  std::vector<Cell> cells{key.problem,
                          key.material,
                          key.method,
                          key.mode,
                          when(key.mode != "adaptive", key.h),
                          when(key.mode != "fixed", key.rtol),
                          std::optional(key.t_end),
                          row.outcome,
                          std::optional(row.t_reached),
                          row.steps,
                          row.rhs,
                          std::optional(cpu.median),
                          std::optional(cpu.q1),
                          std::optional(cpu.q3),
                          std::optional(cpu.p99),
                          std::optional(row.error_end),
                          std::optional(row.error_global),
                          std::optional(ratio(row.t_reached, cpu.median)),
                          key.parameters,
                          key.y0,
                          key.control,
                          when(key.mode != "fixed", key.atol),
                          row.rejected,
                          std::optional(ratio(cpu.median, static_cast<double>(row.steps))),
                          static_cast<std::int64_t>(row.cpu_s.size()),
                          row.runs_per_sample,
                          row.reference,
                          std::optional(row.reference_error),
                          std::optional(row.error_l2),
                          row.subnormals,
                          row.session,
                          std::int64_t{row.explored}};
  std::string status = row.status;
  if (status.empty()) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto* number = std::get_if<std::optional<double>>(&cells[i]);
      if (number && *number && !std::isfinite(**number)) {
        status += fmt::format("{}{}", status.empty() ? "No finite value for " : ", ", columns[i]);
      }
    }
    if (!status.empty()) status += '.';
  }
  cells.emplace_back(status);
  return cells;
}

std::string csv_text(const Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return csv_cell(*text);
  if (const auto* count = std::get_if<std::int64_t>(&cell)) return std::to_string(*count);
  const auto& number = std::get<std::optional<double>>(cell);
  return number && !std::isnan(*number) ? to_text(*number) : "";
}

Json json_value(const Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  if (const auto* count = std::get_if<std::int64_t>(&cell)) return *count;
  const auto& number = std::get<std::optional<double>>(cell);
  return number && std::isfinite(*number) ? Json(*number) : Json(nullptr);
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

std::string rows_to_csv(std::span<const Row> rows) {
  std::string text;
  for (const std::string_view column : columns) {
    if (!text.empty()) text += ',';
    text += column;
  }
  text += '\n';
  for (const Row& row : rows) {
    const std::vector<Cell> cells = cells_of(row);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) text += ',';
      text += csv_text(cells[i]);
    }
    text += '\n';
  }
  return text;
}

std::string rows_to_jsonl(std::span<const Row> rows) {
  std::string text;
  for (const Row& row : rows) {
    const std::vector<Cell> cells = cells_of(row);
    Json object;
    for (std::size_t i = 0; i < cells.size(); ++i) object[std::string(columns[i])] = json_value(cells[i]);
    text += dumped(object, -1) + '\n';
  }
  return text;
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
  if (key.mode != "adaptive") add("h:" + to_text(key.h));
  if (key.mode != "fixed") add("rtol:" + to_text(key.rtol) + "/atol:" + to_text(key.atol));
  add("t_end:" + to_text(key.t_end));
  return name;
}

namespace {

/// Why a row has no CPU time that others can be compared with.
std::string words_of_no_time(const Row& row) {
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
    if (!std::isfinite(summarise(comparable_times(row)).median)) {
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

std::span<const ExportFormat> export_formats() {
  static constexpr std::array<ExportFormat, 3> formats{
      {{"csv", "", "problem,material,method,mode,h,rtol,",
        [](std::span<const Row> rows, const Fingerprint&) { return rows_to_csv(rows); }},
       {"jsonl", "", "{\"problem\":\"",
        [](std::span<const Row> rows, const Fingerprint&) { return rows_to_jsonl(rows); }},
       {"gbench", "Google Benchmark's JSON", "{\n  \"context\": {\n    \"executable\": \"hmax\"",
        rows_to_google_benchmark}}};
  return formats;
}

}  // namespace hmax
