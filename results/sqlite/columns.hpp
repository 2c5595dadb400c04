/// Statements made of lists of fields, which are the columns of a table.
#pragma once

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "results/fields.hpp"
#include "results/sqlite/store_impl.hpp"

namespace hmax::sqlite {

/// The names of some fields, each with `before` and `after`, joined by `between`.
template <class... Fields>
std::string joined(std::string_view before, std::string_view after, std::string_view between,
                   const Fields&... lists) {
  std::string text;
  const auto add = [&](const auto& fields) {
    for (const auto& field : fields)
      text += fmt::format("{}{}{}{}", text.empty() ? "" : between, before, field.name, after);
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

inline void bind(Statement& statement, int index, const auto& value) { statement.bind(index, value); }
inline void bind(Statement& statement, int index, double value) { bind_exact(statement, index, value); }
inline void bind(Statement& statement, int index, bool value) { statement.bind(index, std::int64_t{value}); }
/// As a JSON array, in which numbers that it does not have are texts.
void bind(Statement& statement, int index, const std::vector<double>& values);

/// @throws std::invalid_argument  for a number that is not finite
template <class Key, class Fields>
void bind_key(Statement& statement, int& index, const Key& key, const Fields& fields) {
  each_field(key, fields, [&]<class T>(std::string_view name, const T& value) {
    if constexpr (std::is_same_v<T, double>) {
      if (!std::isfinite(value))
        throw std::invalid_argument(fmt::format("The key of a row has no finite {}.", name));
      statement.bind(index++, value);
    } else {
      bind(statement, index++, value);
    }
  });
}

template <class Record, class Fields>
void bind_fields(Statement& statement, int& index, const Record& record, const Fields& fields) {
  each_field(record, fields, [&](std::string_view, const auto& value) { bind(statement, index++, value); });
}

inline void read(const Statement& query, int column, std::string& value) { value = query.text(column); }
inline void read(const Statement& query, int column, std::int64_t& value) { value = query.integer(column); }
inline void read(const Statement& query, int column, double& value) { value = exact_number(query, column); }
inline void read(const Statement& query, int column, bool& value) { value = query.integer(column) != 0; }
void read(const Statement& query, int column, std::vector<double>& values);

template <class Record, class Fields>
void read_fields(const Statement& query, int& index, Record& record, const Fields& fields) {
  each_field(record, fields, [&](std::string_view, auto& value) { read(query, index++, value); });
}

/// The rows of a query whose columns are the fields of a key, those of its row, and the session.
template <class Row, class Key, class KeyFields, class Fields>
std::vector<Row> read_rows(Statement& query, Key Row::*key, const KeyFields& key_fields,
                           const Fields& fields) {
  std::vector<Row> rows;
  while (query.step()) {
    Row row;
    int index = 0;
    read_fields(query, index, row.*key, key_fields);
    read_fields(query, index, row, fields);
    row.session = query.integer(index);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace hmax::sqlite
