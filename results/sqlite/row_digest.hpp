/// A digest beside every row of a store, by which damage to a stored value is noticed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "results/sqlite/sqlite.hpp"

namespace hmax::sqlite {

/// A row that is not as it was written.
struct DamagedRow : Failure {
  DamagedRow(std::string_view of_table, std::int64_t row_number, std::string_view why);
  std::string table;
  std::int64_t row;  ///< rowid
};

/// Lets the statements of a connection call row_digest(a, b, ...): the Digest of the types and the values.
void add_row_digest(sqlite3* database);

/// The parts of "a, b".
std::vector<std::string> split_names(const std::string& names);

/// "INSERT INTO ... VALUES (...)" of one row. The values of `names` are bound in this order; the digest of
/// the row is computed beside them, over its columns in the order of their names.
/// @param names  columns, "a, b"
std::string insert_into(std::string_view table, const std::string& names);

/// Reads a whole store once: the digest of each row, then what SQLite itself checks, pages, indexes and
/// references between tables. A hundred thousand rows take about a second.
/// @throws DamagedRow  for the first row whose digest differs, or that refers to a row that is not there
/// @throws Failure     SQLITE_CORRUPT for a damaged page, index or layout
void check_store(sqlite3* database);

}  // namespace hmax::sqlite
