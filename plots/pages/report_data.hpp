/// Stored rows as tables and figures for the scripts of the page.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>

#include "plots/pages/reported_store.hpp"

namespace hmax {

struct ReportData {
  std::string json;          ///< without '<', so that it may stand in a script element
  std::size_t left_out = 0;  ///< number of rows beyond `most_rows` of a table
};

/// Whether CPU times of a run are shown: not those of explored ones and of devices.
bool has_cpu_times(const Row& row);

/// One JSON object:
/// - `stores`: names; `words`: every text of the tables once; `cases`: what is shown in one figure;
/// - `series`: curves, `{label, method, variant}`: methods are numbered in the order of the tables, variants
/// tell the curves of a method apart;
/// - `tables`: `{id, title, tips, columns: [{key, name, unit, form}], rows}`. A row is `[store, number,
/// series, case, cell...]`. Cells of
///   the forms `text`, `long` and `list` are indices of `words`; a list is numbers with spaces between, for
///   figures alone. Numbers have six significant digits; NaN is null, infinity "inf". Tables without rows are
///   left out;
/// - `figures`: `{id, table, title, words, x, y, labels, ...}` with the keys of columns.
/// Times are in ms, as the headings say. Bytes that are not UTF-8 become U+FFFD.
/// @param most_rows  of each table
ReportData report_data(std::span<const ReportedStore> stores,
                       std::size_t most_rows = std::numeric_limits<std::size_t>::max());

}  // namespace hmax
