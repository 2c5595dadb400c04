/// Statements made of lists of columns.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "results/limits/columns.hpp"
#include "results/sqlite/store_impl.hpp"

namespace hmax::sqlite {

/// The names of some columns, each with `before` and `after`, joined by `between`.
template <class... Columns>
std::string joined(std::string_view before, std::string_view after, std::string_view between,
                   const Columns&... lists) {
  std::string text;
  const auto add = [&](const auto& columns) {
    for (const auto& column : columns)
      text += fmt::format("{}{}{}{}", text.empty() ? "" : between, before, column.name, after);
  };
  (add(lists), ...);
  return text;
}

/// "session = excluded.session, digest = excluded.digest, a = excluded.a": what replaces a row of the same
/// key.
inline std::string replacing(const std::string& names) {
  std::string text = "session = excluded.session, digest = excluded.digest";
  for (const std::string& name : split_names(names)) text += fmt::format(", {0} = excluded.{0}", name);
  return text;
}

template <class Owner, std::size_t n>
void bind_texts(Statement& statement, int& index, const Owner& owner,
                const std::array<Column<Owner, std::string>, n>& columns) {
  for (const auto& column : columns) statement.bind(index++, std::string_view(owner.*column.member));
}

template <class Owner, std::size_t n>
void read_texts(const Statement& query, int& index, Owner& owner,
                const std::array<Column<Owner, std::string>, n>& columns) {
  for (const auto& column : columns) owner.*column.member = query.text(index++);
}

template <class Owner, std::size_t n>
void bind_numbers(Statement& statement, int& index, const Owner& owner,
                  const std::array<Column<Owner, double>, n>& columns) {
  for (const auto& column : columns) bind_exact(statement, index++, owner.*column.member);
}

template <class Owner, std::size_t n>
void read_numbers(const Statement& query, int& index, Owner& owner,
                  const std::array<Column<Owner, double>, n>& columns) {
  for (const auto& column : columns) owner.*column.member = exact_number(query, index++);
}

}  // namespace hmax::sqlite
