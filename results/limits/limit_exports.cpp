#include "results/limits/limit_exports.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "results/limits/limit_columns.hpp"
#include "results/numbers.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

/// text(name, value) and number(name, value) of every exported column, in order.
template <class Text, class Number>
void each_column(const LimitRow& row, const Text& text, const Number& number) {
  for (const auto& column : point_key_texts) text(column.name, row.point.*column.member);
  number("t_end", row.point.t_end);
  for (const auto& column : limit_texts)
    if (column.member != &LimitRow::details) text(column.name, row.*column.member);
  for (const auto& column : limit_numbers) number(column.name, row.*column.member);
  number("session", static_cast<double>(row.session));
}

}  // namespace

std::string limits_to_csv(std::span<const LimitRow> rows) {
  std::string header, text;
  const auto name = [&](std::string_view column, const auto&) {
    header += (header.empty() ? "" : ",") + std::string(column);
  };
  each_column({}, name, name);
  for (const LimitRow& row : rows) {
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

std::string limits_to_jsonl(std::span<const LimitRow> rows) {
  std::string text;
  for (const LimitRow& row : rows) {
    Json object;
    each_column(
        row, [&](std::string_view name, const std::string& value) { object[std::string(name)] = value; },
        [&](std::string_view name, double value) {
          object[std::string(name)] =
              std::isnan(value) ? Json() : std::isinf(value) ? Json("unbounded") : Json(value);
        });
    text += object.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  return text;
}

std::string limit_name(const LimitRow& row) {
  const OperatingPointKey& point = row.point;
  std::string name = point.problem;
  for (const std::string& part : {point.material, point.parameters, point.asked, point.path, row.method})
    if (!part.empty()) name += "/" + part;
  return name;
}

}  // namespace hmax
