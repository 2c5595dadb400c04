/// Columns of stored rows: one list serves the table of the store, the exports and the comparison.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "core/numbers.hpp"
#include "results/table.hpp"

namespace hmax {

template <class Owner, class T>
struct Column {
  std::string_view name;
  T Owner::*member;
};

/// One header line, one line a row. A NaN is an empty cell, infinity is "unbounded".
/// @param each_column  each_column(row, text, number) calls text(name, value) or number(name, value) of every
/// column
template <class Row, class Each>
std::string columns_to_csv(std::span<const Row> rows, const Each& each_column) {
  std::string header, text;
  const auto name = [&](std::string_view column, const auto&) {
    header += (header.empty() ? "" : ",") + std::string(column);
  };
  each_column(Row{}, name, name);
  for (const Row& row : rows) {
    std::string line;
    bool first = true;
    const auto add = [&](const std::string& cell) {
      line += (first ? "" : ",") + cell;
      first = false;
    };
    each_column(
        row, [&](std::string_view, const std::string& value) { add(csv_cell(value)); },
        [&](std::string_view, double value) {
          add(std::isnan(value) ? "" : std::isinf(value) ? "unbounded" : to_text(value));
        });
    text += line + "\n";
  }
  return header + "\n" + text;
}

/// One JSON object a line; a NaN is null. Whole numbers are written without a fraction.
template <class Row, class Each>
std::string columns_to_jsonl(std::span<const Row> rows, const Each& each_column) {
  using Json = nlohmann::ordered_json;
  const auto json = [](double value) {
    if (std::isnan(value)) return Json();
    if (std::isinf(value)) return Json("unbounded");
    constexpr double exact = 9007199254740992;  // 2^53
    return value == std::trunc(value) && std::abs(value) < exact && !(value == 0 && std::signbit(value))
               ? Json(static_cast<std::int64_t>(value))
               : Json(value);
  };
  std::string text;
  for (const Row& row : rows) {
    Json object;
    each_column(
        row, [&](std::string_view name, const std::string& value) { object[std::string(name)] = value; },
        [&](std::string_view name, double value) { object[std::string(name)] = json(value); });
    text += object.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  return text;
}

}  // namespace hmax
