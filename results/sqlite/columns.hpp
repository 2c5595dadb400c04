/// Statements made of lists of columns.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

inline std::string question_marks(std::size_t count) {
  return fmt::format("{}", fmt::join(std::vector<char>(count, '?'), ", "));
}

/// "a = excluded.a, b = excluded.b": what replaces a row of the same key.
inline std::string replacing(const std::string& names) {
  std::string text = "session = excluded.session";
  for (std::size_t begin = 0; begin < names.size();) {
    const std::size_t end = std::min(names.find(", ", begin), names.size());
    const std::string name = names.substr(begin, end - begin);
    text += fmt::format(", {0} = excluded.{0}", name);
    begin = end + 2;
  }
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
