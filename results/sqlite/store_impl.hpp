/// What the parts of Store share; private to its sources.
#pragma once

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "results/sqlite/row_digest.hpp"
#include "results/sqlite/sqlite.hpp"
#include "results/store.hpp"

namespace hmax {

/// What SQLite could not do, as a sentence with a remedy.
InputError translated(const sqlite::Failure& failure, const std::filesystem::path& file);
InputError translated(const sqlite::DamagedRow& damage, const std::filesystem::path& file);

/// Runs `action` and turns what SQLite throws into an InputError about `file`.
template <class Action>
decltype(auto) reporting(const std::filesystem::path& file, Action&& action) {
  try {
    return action();
  } catch (const sqlite::DamagedRow& damage) {
    throw translated(damage, file);
  } catch (const sqlite::Failure& failure) {
    throw translated(failure, file);
  }
}

namespace sqlite {

inline bool is_special(double value) { return std::isnan(value) || (value == 0 && std::signbit(value)); }

/// See store_schema(): numbers that SQLite would change travel as text.
inline void bind_exact(Statement& statement, int index, double value) {
  if (is_special(value)) {
    statement.bind(index, to_text(value));
  } else {
    statement.bind(index, value);
  }
}

inline double exact_number(const Statement& statement, int column) {
  if (statement.type(column) != SQLITE_TEXT) return statement.number(column);
  const std::string text = statement.text(column);
  const std::optional<double> value = to_number(text);
  if (!value || !is_special(*value))
    throw Failure(SQLITE_CORRUPT, 0, "'" + text + "' stands where a number belongs");
  return *value;
}

}  // namespace sqlite

struct Store::Impl {
  std::filesystem::path file;
  sqlite::Database database;
  std::int64_t session = 0;  ///< 0 before begin_session()
  /// Prepared once; gone before the database closes.
  mutable std::unique_ptr<sqlite::Statement> insert, find;

  Impl(std::filesystem::path path, sqlite::Database opened)
      : file(std::move(path)), database(std::move(opened)) {}
  [[nodiscard]] sqlite3* db() const { return database.get(); }

  /// Id of the row with this key, 0 when there is none.
  [[nodiscard]] std::int64_t id_of(const RowKey& key) const;

  static std::unique_ptr<Impl> open(const std::filesystem::path& file, bool create);
};

}  // namespace hmax
