#include "results/sqlite/row_digest.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/text/digest.hpp"

namespace hmax::sqlite {

namespace {

/// Every table of a store; each has a column `digest`.
constexpr std::array<const char*, 8> tables{"notes",  "sessions", "rows",   "operating_points",
                                            "limits", "advice",   "scenes", "answers"};

/// Eight bytes, the lowest first: a store is read on machines of any byte order.
void add_bits(Digest& digest, std::uint64_t bits) {
  std::array<char, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(bits >> (8 * i) & 0xFF);
  digest.add({bytes.data(), bytes.size()});
}

/// The type, the length of a text, and the value: neighbours cannot pass bytes to one another.
void add_value(Digest& digest, sqlite3_value* value) {
  const int type = sqlite3_value_type(value);
  add_bits(digest, static_cast<std::uint64_t>(type));
  if (type == SQLITE_INTEGER) {
    add_bits(digest, static_cast<std::uint64_t>(sqlite3_value_int64(value)));
  } else if (type == SQLITE_FLOAT) {
    // A typed column turns -0.0 into 0.0.
    add_bits(digest, std::bit_cast<std::uint64_t>(sqlite3_value_double(value) + 0.0));
  } else if (type != SQLITE_NULL) {
    const void* bytes = sqlite3_value_blob(value);  // before its length, as SQLite asks
    const auto size = static_cast<std::size_t>(sqlite3_value_bytes(value));
    add_bits(digest, size);
    digest.add({static_cast<const char*>(bytes), size});
  }
}

extern "C" void row_digest(sqlite3_context* context, int count, sqlite3_value** values) {
  Digest digest;
  for (sqlite3_value* value : std::span(values, static_cast<std::size_t>(count))) add_value(digest, value);
  const std::string text = digest.text();
  sqlite3_result_text(context, text.c_str(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

/// The columns of a row that its digest covers: all but its number, which an index or references hold too.
std::vector<std::string> covered_columns(sqlite3* database, const char* table) {
  std::vector<std::string> names;
  Statement query(database, fmt::format("PRAGMA table_info({})", table).c_str());
  while (query.step())
    if (std::string name = query.text(1); name != "id" && name != "digest") names.push_back(std::move(name));
  std::ranges::sort(names);
  return names;
}

void check_digests(sqlite3* database, const char* table) {
  const std::vector<std::string> names = covered_columns(database, table);
  if (names.empty()) throw Failure(SQLITE_CORRUPT, 0, fmt::format("it has no table '{}'", table));
  const bool has_method = std::ranges::binary_search(names, "method");
  Statement query(
      database, fmt::format("SELECT rowid, {} FROM {} NOT INDEXED WHERE digest IS NOT row_digest({}) LIMIT 1",
                            has_method ? "method" : "''", table, fmt::join(names, ", "))
                    .c_str());
  if (!query.step()) return;
  const std::string method = has_method && query.type(1) == SQLITE_TEXT ? query.text(1) : "";
  throw DamagedRow(table, query.integer(0),
                   fmt::format("{}{}differs from its digest", method, method.empty() ? "" : ", "));
}

/// The first row that refers to one that is not there.
void check_references(sqlite3* database) {
  Statement query(database, "PRAGMA foreign_key_check");
  if (!query.step()) return;
  throw DamagedRow(query.text(0), query.integer(1),
                   fmt::format("refers to a row of {} that is not there", query.text(2)));
}

}  // namespace

DamagedRow::DamagedRow(std::string_view of_table, std::int64_t row_number, std::string_view why)
    : Failure(SQLITE_CORRUPT, 0, fmt::format("row {} of its table {}: {}", row_number, of_table, why)),
      table(of_table),
      row(row_number) {}

std::vector<std::string> split_names(const std::string& names) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < names.size();) {
    const std::size_t end = std::min(names.find(", ", begin), names.size());
    parts.push_back(names.substr(begin, end - begin));
    begin = end + 2;
  }
  return parts;
}

void add_row_digest(sqlite3* database) {
  check(database, sqlite3_create_function_v2(database, "row_digest", -1, SQLITE_UTF8 | SQLITE_DETERMINISTIC,
                                             nullptr, row_digest, nullptr, nullptr, nullptr));
}

std::string insert_into(std::string_view table, const std::string& names) {
  const std::vector<std::string> columns = split_names(names);
  std::vector<std::pair<std::string, std::string>> named;
  std::vector<std::string> values, covered;
  for (const std::string& name : columns) {
    values.push_back(fmt::format("?{}", values.size() + 1));
    named.emplace_back(name, values.back());
  }
  std::ranges::sort(named);
  for (const auto& [name, value] : named) covered.push_back(value);
  return fmt::format("INSERT INTO {} ({}, digest) VALUES ({}, row_digest({}))", table, names,
                     fmt::join(values, ", "), fmt::join(covered, ", "));
}

void check_store(sqlite3* database) {
  // Digests first: they name a row where SQLite would name a page or an index.
  for (const char* table : tables) check_digests(database, table);
  Statement pages(database, "PRAGMA integrity_check(1)");
  if (const std::string found = pages.step() ? pages.text(0) : "nothing is checked"; found != "ok")
    throw Failure(SQLITE_CORRUPT, 0, found);
  check_references(database);
}

}  // namespace hmax::sqlite
