/// A thin owner of an SQLite connection and its statements; private to store.cpp, which alone knows
/// sqlite3.h.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include <sqlite3.h>

#include "core/text/utf8.hpp"

namespace hmax::sqlite {

/// A result code that SQLite gave, with its own words.
struct Failure : std::runtime_error {
  Failure(int result_code, int os_error, const std::string& words)
      : std::runtime_error(words), code(result_code), system_error(os_error) {}
  int code;          ///< extended result code
  int system_error;  ///< errno behind it, 0 when there is none
};

struct Close {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
using Database = std::unique_ptr<sqlite3, Close>;

inline void check(sqlite3* database, int code) {
  if (code != SQLITE_OK) {
    throw Failure(sqlite3_extended_errcode(database), sqlite3_system_errno(database),
                  sqlite3_errmsg(database));
  }
}

inline void execute(sqlite3* database, const char* sql) {
  check(database, sqlite3_exec(database, sql, nullptr, nullptr, nullptr));
}

/// A prepared statement; parameters and columns count from 0.
class Statement {
 public:
  Statement(sqlite3* database, const char* sql) : database_(database) {
    sqlite3_stmt* raw = nullptr;
    check(database, sqlite3_prepare_v2(database, sql, -1, &raw, nullptr));
    statement_.reset(raw);
  }

  void bind(int index, std::int64_t value) {
    check(database_, sqlite3_bind_int64(statement_.get(), index + 1, value));
  }
  void bind(int index, double value) {
    check(database_, sqlite3_bind_double(statement_.get(), index + 1, value));
  }
  /// Texts of SQLite are UTF-8. A name that is not, such as that of a file, is kept and looked up as
  /// as_utf8().
  void bind(int index, std::string_view text) {
    const std::string valid = as_utf8(text);
    check(database_, sqlite3_bind_text64(statement_.get(), index + 1, valid.data(), valid.size(),
                                         SQLITE_TRANSIENT, SQLITE_UTF8));
  }

  /// @returns true while there is a row to read
  bool step() {
    const int code = sqlite3_step(statement_.get());
    if (code == SQLITE_ROW) return true;
    if (code == SQLITE_DONE) return false;
    const Failure failure(sqlite3_extended_errcode(database_), sqlite3_system_errno(database_),
                          sqlite3_errmsg(database_));
    sqlite3_reset(statement_.get());
    throw failure;
  }
  void run() {
    while (step()) {
    }
    reset();
  }
  void reset() { sqlite3_reset(statement_.get()); }

  int type(int column) const { return sqlite3_column_type(statement_.get(), column); }
  /// Values of the row; SQLite keeps values of any type in a column and converts them without a word.
  /// @throws Failure  SQLITE_CORRUPT where the value is of another type
  std::int64_t integer(int column) const {
    expect(column, SQLITE_INTEGER, "whole number");
    return sqlite3_column_int64(statement_.get(), column);
  }
  double number(int column) const {
    expect(column, SQLITE_FLOAT, "number");
    return sqlite3_column_double(statement_.get(), column);
  }
  std::string text(int column) const {
    expect(column, SQLITE_TEXT, "text");
    const auto* data = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
    return data ? std::string(data, static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)))
                : std::string();
  }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  void expect(int column, int type_of_column, const char* name) const {
    if (type(column) != type_of_column)
      throw Failure(
          SQLITE_CORRUPT, 0,
          std::string("column ") + sqlite3_column_name(statement_.get(), column) + " holds no " + name);
  }

  sqlite3* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

inline std::int64_t integer(sqlite3* database, const char* sql) {
  Statement query(database, sql);
  return query.step() ? query.integer(0) : 0;
}

/// BEGIN IMMEDIATE ... commit(); rolled back when it ends without.
class Transaction {
 public:
  explicit Transaction(sqlite3* database) : database_(database) { execute(database, "BEGIN IMMEDIATE"); }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction() {
    if (database_) sqlite3_exec(database_, "ROLLBACK", nullptr, nullptr, nullptr);
  }
  void commit() {
    execute(database_, "COMMIT");
    database_ = nullptr;
  }

 private:
  sqlite3* database_;
};

}  // namespace hmax::sqlite
