/// Stored rows in the forms that other programs read.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "results/advice_record.hpp"
#include "results/fingerprint.hpp"
#include "results/json.hpp"
#include "results/limit_row.hpp"
#include "results/row.hpp"

namespace hmax {

/// Every form; the first one is the default. The last one is of measured rows alone.
inline constexpr std::array<std::string_view, 3> export_formats{"csv", "jsonl", "gbench"};

/// The columns of a measured row in their order; the first 17 are fixed by contract, units are in the names
/// (`_s` is seconds). `error_*` and reference_error are in the unit of the state; realtime_factor is
/// t_reached / cpu_median_s, simulated seconds (from t = 0) per CPU second, or the same by device_median_s.
///
/// A number that does not apply is null: h in mode adaptive, rtol and atol in mode fixed, `cpu_*` of a
/// device, `device_*` and clock_mhz of the processor. A number that could not be obtained is not finite, and
/// `status` says so.
Json object_of(const Row& row);

/// Every column of a limit but its details; of advice every one. A number that does not apply is null, a
/// limit that no step reaches is "unbounded"; steps, limits and times in s.
Json object_of(const LimitRow& row);
Json object_of(const AdviceRecord& record);

namespace detail {
std::string csv_header(const Json& object);
std::string csv_line(const Json& object);
/// @param whole_numbers  write them without a fraction
std::string json_line(Json object, bool whole_numbers);
}  // namespace detail

/// One header line, one line for each row; a missing number is an empty cell, texts with commas are quoted
/// [shafranovich2005common].
template <class Record>
std::string rows_to_csv(const std::vector<Record>& rows) {
  std::string text = detail::csv_header(object_of(Record{}));
  for (const Record& row : rows) text += detail::csv_line(object_of(row));
  return text;
}

/// One JSON object per line; a missing number is null, of measured rows an infinite one too.
template <class Record>
std::string rows_to_jsonl(const std::vector<Record>& rows) {
  std::string text;
  for (const Record& row : rows) text += detail::json_line(object_of(row), !std::is_same_v<Record, Row>);
  return text;
}

/// The JSON of Google Benchmark, readable by its tools/compare.py: per row one entry of run_type "iteration"
/// for each repetition and the aggregates mean, median, stddev and cv. Times in ns; what is measured is CPU
/// time, and real_time repeats it because the tools want both. Rows without a time become entries with
/// error_occurred, those of a device too.
std::string rows_to_google_benchmark(std::span<const Row> rows, const Fingerprint& fingerprint);

/// The name of a row in rows_to_google_benchmark: every part of the key that is there, joined by slashes.
std::string benchmark_name(const RowKey& key);

}  // namespace hmax
