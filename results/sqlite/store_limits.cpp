#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "results/limits/limit_columns.hpp"
#include "results/sqlite/columns.hpp"
#include "results/sqlite/row_digest.hpp"
#include "results/sqlite/store_impl.hpp"

namespace hmax {

namespace {

using sqlite::bind_texts, sqlite::joined, sqlite::read_texts, sqlite::replacing;
using sqlite::Statement;

void bind_key(Statement& statement, int& index, const OperatingPointKey& key) {
  bind_texts(statement, index, key, point_key_texts);
  statement.bind(index++, key.t_end);
}

OperatingPointKey read_key(const Statement& query, int& index) {
  OperatingPointKey key;
  read_texts(query, index, key, point_key_texts);
  key.t_end = query.number(index++);
  return key;
}

std::string point_key_columns(std::string_view table = "") {
  return joined(table, "", ", ", point_key_texts) + fmt::format(", {}t_end", table);
}

std::string point_key_condition() { return joined("", " = ?", " AND ", point_key_texts) + " AND t_end = ?"; }

std::string insert_point() {
  const std::string own = joined("", "", ", ", point_texts);
  return sqlite::insert_into("operating_points", fmt::format("{}, {}, session", point_key_columns(), own)) +
         fmt::format(" ON CONFLICT ({}) DO UPDATE SET {}", point_key_columns(), replacing(own));
}

std::string insert_limit() {
  const std::string own = joined("", "", ", ", limit_texts, limit_numbers);
  return sqlite::insert_into("limits", own + ", session, point") +
         fmt::format(" ON CONFLICT (point, method) DO UPDATE SET {}", replacing(own));
}

std::string select_limits(const std::string& rest) {
  return fmt::format(
      "SELECT {}, {}, limits.session FROM limits JOIN operating_points ON limits.point = operating_points.id {}",
      point_key_columns("operating_points."), joined("limits.", "", ", ", limit_texts, limit_numbers), rest);
}

std::vector<LimitRow> read_limits(Statement& query) {
  std::vector<LimitRow> rows;
  while (query.step()) {
    LimitRow row;
    int index = 0;
    row.point = read_key(query, index);
    read_texts(query, index, row, limit_texts);
    sqlite::read_numbers(query, index, row, limit_numbers);
    row.session = query.integer(index);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::int64_t id_of_point(sqlite3* database, const OperatingPointKey& key) {
  Statement find(database, ("SELECT id FROM operating_points WHERE " + point_key_condition()).c_str());
  int index = 0;
  bind_key(find, index, key);
  return find.step() ? find.integer(0) : 0;
}

}  // namespace

std::string limit_schema() {
  return fmt::format(
      R"sql(
CREATE TABLE operating_points (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
  {},
  t_end REAL NOT NULL,
  {},
  digest TEXT NOT NULL,
  UNIQUE ({})
);
CREATE TABLE limits (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
  point INTEGER NOT NULL REFERENCES operating_points(id),
  {},
  {},
  digest TEXT NOT NULL,
  UNIQUE (point, method)
);
)sql",
      joined("", " TEXT NOT NULL", ",\n  ", point_key_texts),
      joined("", " TEXT NOT NULL", ",\n  ", point_texts), point_key_columns(),
      joined("", " TEXT NOT NULL", ",\n  ", limit_texts), joined("", " NOT NULL", ",\n  ", limit_numbers));
}

void Store::insert_limits(const OperatingPointRow& point, std::span<const LimitRow> rows) {
  if (impl_->session == 0) throw std::logic_error("Store::insert_limits needs begin_session() first.");
  if (!std::isfinite(point.key.t_end)) throw std::invalid_argument("The end of a motion must be finite.");
  reporting(impl_->file, [&] {
    sqlite::Transaction transaction(impl_->db());
    Statement add_point(impl_->db(), insert_point().c_str());
    int index = 0;
    bind_key(add_point, index, point.key);
    bind_texts(add_point, index, point, point_texts);
    add_point.bind(index, impl_->session);
    add_point.run();
    const std::int64_t id = id_of_point(impl_->db(), point.key);
    Statement add(impl_->db(), insert_limit().c_str());
    for (const LimitRow& row : rows) {
      index = 0;
      bind_texts(add, index, row, limit_texts);
      sqlite::bind_numbers(add, index, row, limit_numbers);
      add.bind(index++, impl_->session);
      add.bind(index++, id);
      add.run();
    }
    transaction.commit();
  });
}

std::optional<OperatingPointRow> Store::operating_point(const OperatingPointKey& key) const {
  return reporting(impl_->file, [&]() -> std::optional<OperatingPointRow> {
    Statement query(impl_->db(), fmt::format("SELECT {} FROM operating_points WHERE {}",
                                             joined("", "", ", ", point_texts), point_key_condition())
                                     .c_str());
    int index = 0;
    bind_key(query, index, key);
    if (!query.step()) return std::nullopt;
    OperatingPointRow row;
    row.key = key;
    index = 0;
    read_texts(query, index, row, point_texts);
    return row;
  });
}

std::vector<LimitRow> Store::limits_at(const OperatingPointKey& key) const {
  return reporting(impl_->file, [&]() -> std::vector<LimitRow> {
    Statement query(impl_->db(),
                    select_limits(fmt::format("WHERE {} ORDER BY limits.id",
                                              joined("operating_points.", " = ?", " AND ", point_key_texts) +
                                                  " AND operating_points.t_end = ?"))
                        .c_str());
    int index = 0;
    bind_key(query, index, key);
    return read_limits(query);
  });
}

std::vector<LimitRow> Store::limits() const {
  return reporting(impl_->file, [&]() -> std::vector<LimitRow> {
    Statement query(impl_->db(), select_limits(fmt::format("ORDER BY {}, limits.method",
                                                           point_key_columns("operating_points.")))
                                     .c_str());
    return read_limits(query);
  });
}

}  // namespace hmax
