#include "results/limits/limit_exports.hpp"

#include "results/limits/limit_columns.hpp"

namespace hmax {

namespace {

/// text(name, value) and number(name, value) of every exported column, in order.
template <class Text, class Number>
void each_limit_column(const LimitRow& row, const Text& text, const Number& number) {
  for (const auto& column : point_key_texts) text(column.name, row.point.*column.member);
  number("t_end", row.point.t_end);
  for (const auto& column : limit_texts)
    if (column.member != &LimitRow::details) text(column.name, row.*column.member);
  for (const auto& column : limit_numbers) number(column.name, row.*column.member);
  number("session", static_cast<double>(row.session));
}

}  // namespace

std::string limits_to_csv(std::span<const LimitRow> rows) {
  return columns_to_csv(rows, [](const auto&... args) { each_limit_column(args...); });
}

std::string limits_to_jsonl(std::span<const LimitRow> rows) {
  return columns_to_jsonl(rows, [](const auto&... args) { each_limit_column(args...); });
}

std::string limit_name(const LimitRow& row) {
  const OperatingPointKey& point = row.point;
  std::string name = point.problem;
  for (const std::string& part : {point.material, point.parameters, point.asked, point.path, row.method})
    if (!part.empty()) name += "/" + part;
  return name;
}

}  // namespace hmax
