#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "results/sqlite/columns.hpp"
#include "results/sqlite/row_digest.hpp"
#include "results/sqlite/store_impl.hpp"

namespace hmax {

namespace {

using sqlite::bind_key, sqlite::joined, sqlite::replacing;
using sqlite::Statement;

std::string names_of_point(std::string_view table = "") { return joined(table, "", ", ", point_key_fields); }

std::string is_of_point(std::string_view table = "") {
  return joined(table, " = ?", " AND ", point_key_fields);
}

std::string insert_point() {
  return sqlite::insert_into("operating_points", names_of_point() + ", document, session") +
         fmt::format(" ON CONFLICT ({}) DO UPDATE SET {}", names_of_point(), replacing("document"));
}

std::string insert_limit() {
  const std::string own = joined("", "", ", ", limit_fields);
  return sqlite::insert_into("limits", own + ", session, point") +
         fmt::format(" ON CONFLICT (point, method) DO UPDATE SET {}", replacing(own));
}

std::string select_limits(const std::string& rest) {
  return fmt::format(
      "SELECT {}, {}, limits.session FROM limits JOIN operating_points ON limits.point = operating_points.id {}",
      names_of_point("operating_points."), joined("limits.", "", ", ", limit_fields), rest);
}

std::vector<LimitRow> read_limits(Statement& query) {
  return sqlite::read_rows(query, &LimitRow::point, point_key_fields, limit_fields);
}

std::int64_t id_of_point(sqlite3* database, const OperatingPointKey& key) {
  Statement find(database, ("SELECT id FROM operating_points WHERE " + is_of_point()).c_str());
  int index = 0;
  bind_key(find, index, key, point_key_fields);
  return find.step() ? find.integer(0) : 0;
}

}  // namespace

void Store::insert_limits(const OperatingPointRow& point, std::span<const LimitRow> rows) {
  if (impl_->session == 0) throw std::logic_error("Store::insert_limits needs begin_session() first.");
  reporting(impl_->file, [&] {
    sqlite::Transaction transaction(impl_->db());
    Statement add_point(impl_->db(), insert_point().c_str());
    int index = 0;
    bind_key(add_point, index, point.key, point_key_fields);
    add_point.bind(index++, point.document);
    add_point.bind(index, impl_->session);
    add_point.run();
    const std::int64_t id = id_of_point(impl_->db(), point.key);
    Statement add(impl_->db(), insert_limit().c_str());
    for (const LimitRow& row : rows) {
      index = 0;
      sqlite::bind_fields(add, index, row, limit_fields);
      add.bind(index++, impl_->session);
      add.bind(index++, id);
      add.run();
    }
    transaction.commit();
  });
}

std::optional<OperatingPointRow> Store::operating_point(const OperatingPointKey& key) const {
  return reporting(impl_->file, [&]() -> std::optional<OperatingPointRow> {
    Statement query(impl_->db(), ("SELECT document FROM operating_points WHERE " + is_of_point()).c_str());
    int index = 0;
    bind_key(query, index, key, point_key_fields);
    if (!query.step()) return std::nullopt;
    return OperatingPointRow{.key = key, .document = query.text(0)};
  });
}

std::vector<LimitRow> Store::limits_at(const OperatingPointKey& key) const {
  return reporting(impl_->file, [&]() -> std::vector<LimitRow> {
    Statement query(
        impl_->db(),
        select_limits(fmt::format("WHERE {} ORDER BY limits.id", is_of_point("operating_points."))).c_str());
    int index = 0;
    bind_key(query, index, key, point_key_fields);
    return read_limits(query);
  });
}

std::vector<LimitRow> Store::limits() const {
  return reporting(impl_->file, [&]() -> std::vector<LimitRow> {
    Statement query(impl_->db(), select_limits(fmt::format("ORDER BY {}, limits.method",
                                                           names_of_point("operating_points.")))
                                     .c_str());
    return read_limits(query);
  });
}

}  // namespace hmax
