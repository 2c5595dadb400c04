/// Stored rows in the forms that other programs read.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "results/fingerprint.hpp"
#include "results/row.hpp"

namespace hmax {

/// One header line, one line per row; a missing number is an empty cell, texts with commas are quoted
/// [shafranovich2005common]. The first 17 columns are fixed by contract, units are in the names (`_s` is
/// seconds). `error_*` and reference_error are in the unit of the state; realtime_factor is t_reached /
/// cpu_median_s, simulated seconds (from t = 0) per CPU second.
///
/// A number that does not apply is missing: h in mode adaptive, rtol and atol in mode fixed. A number that
/// could not be obtained is missing too, and `status` says so.
std::string rows_to_csv(std::span<const Row> rows);

/// One JSON object per line; a missing or infinite number is null.
std::string rows_to_jsonl(std::span<const Row> rows);

/// The JSON of Google Benchmark, readable by its tools/compare.py: per row one entry of run_type "iteration"
/// for each repetition and the aggregates mean, median, stddev and cv. Times in ns; what is measured is CPU
/// time, and real_time repeats it because the tools want both. Rows without a time become entries with
/// error_occurred.
std::string rows_to_google_benchmark(std::span<const Row> rows, const Fingerprint& fingerprint);

/// A form of export.
struct ExportFormat {
  std::string_view name;         ///< as users type it
  std::string_view description;  ///< a few words that explain the name, may be empty
  std::string_view opening;      ///< with which every text of it begins, unless there are no rows
  std::string (*text)(std::span<const Row> rows, const Fingerprint& fingerprint);
};

/// Every form; the first one is the default.
std::span<const ExportFormat> export_formats();

/// The name of a row in rows_to_google_benchmark: every part of the key that is there, joined by slashes.
std::string benchmark_name(const RowKey& key);

}  // namespace hmax
