#include <cmath>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "results/limits/advice_columns.hpp"
#include "results/sqlite/columns.hpp"
#include "results/sqlite/row_digest.hpp"
#include "results/sqlite/store_impl.hpp"

namespace hmax {

namespace {

using sqlite::joined;
using sqlite::Statement;

std::string advice_key_columns() { return joined("", "", ", ", advice_key_texts, advice_key_numbers); }
std::string key_schema() {
  return fmt::format("  {},\n  {}", joined("", " TEXT NOT NULL", ",\n  ", advice_key_texts),
                     joined("", " REAL NOT NULL", ",\n  ", advice_key_numbers));
}
std::string own_names() { return joined("", "", ", ", advice_texts, advice_numbers); }

void bind_key(Statement& statement, int& index, const AdviceKey& key) {
  sqlite::bind_texts(statement, index, key, advice_key_texts);
  for (const auto& column : advice_key_numbers) statement.bind(index++, key.*column.member);
}

void forget(sqlite3* database, const char* table, const AdviceKey& key) {
  Statement statement(database, fmt::format("DELETE FROM {} WHERE {}", table,
                                            joined("", " = ?", " AND ", advice_key_texts, advice_key_numbers))
                                    .c_str());
  int index = 0;
  bind_key(statement, index, key);
  statement.run();
}

/// A text of an answer into its table, in the column of this name.
void add_text(sqlite3* database, const char* table, const char* column, const AdviceKey& key,
              std::string_view text, std::int64_t session) {
  Statement statement(
      database,
      sqlite::insert_into(table, fmt::format("{}, {}, session", advice_key_columns(), column)).c_str());
  int index = 0;
  bind_key(statement, index, key);
  statement.bind(index++, text);
  statement.bind(index, session);
  statement.run();
}

std::string text_schema(const char* table, const char* column) {
  return fmt::format(
      R"sql(
CREATE TABLE {} (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
{},
  {} TEXT NOT NULL,
  digest TEXT NOT NULL,
  UNIQUE ({})
);
)sql",
      table, key_schema(), column, advice_key_columns());
}

/// Every text of a table, ordered by the keys.
/// @param text  the member of Kept that holds it
template <class Kept>
std::vector<Kept> texts_of(sqlite3* database, const char* table, const char* column,
                           std::string Kept::*text) {
  Statement query(database, fmt::format("SELECT {0}, {1}, session FROM {2} ORDER BY {0}",
                                        advice_key_columns(), column, table)
                                .c_str());
  std::vector<Kept> all;
  while (query.step()) {
    Kept kept;
    int index = 0;
    sqlite::read_texts(query, index, kept.key, advice_key_texts);
    sqlite::read_numbers(query, index, kept.key, advice_key_numbers);
    kept.*text = query.text(index++);
    kept.session = query.integer(index);
    all.push_back(std::move(kept));
  }
  return all;
}

}  // namespace

std::string advice_schema() {
  return fmt::format(
      R"sql(
CREATE TABLE advice (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
{},
  {},
  {},
  digest TEXT NOT NULL,
  UNIQUE ({}, method, options)
);
)sql",
      key_schema(), joined("", " TEXT NOT NULL", ",\n  ", advice_texts),
      joined("", " NOT NULL", ",\n  ", advice_numbers), advice_key_columns());
}

std::string scene_schema() { return text_schema("scenes", "scene"); }
std::string words_schema() { return text_schema("answers", "words"); }

void Store::insert_advice(const AdviceKey& key, std::span<const AdviceRecord> records, std::string_view scene,
                          std::string_view words) {
  if (impl_->session == 0) throw std::logic_error("Store::insert_advice needs begin_session() first.");
  for (const auto& column : advice_key_numbers)
    if (!std::isfinite(key.*column.member))
      throw std::invalid_argument("The numbers of a question must be finite.");
  reporting(impl_->file, [&] {
    sqlite::Transaction transaction(impl_->db());
    for (const char* table : {"advice", "scenes", "answers"}) forget(impl_->db(), table, key);
    if (!scene.empty()) add_text(impl_->db(), "scenes", "scene", key, scene, impl_->session);
    if (!words.empty()) add_text(impl_->db(), "answers", "words", key, words, impl_->session);
    Statement add(impl_->db(), sqlite::insert_into("advice", fmt::format("{}, {}, session",
                                                                         advice_key_columns(), own_names()))
                                   .c_str());
    for (const AdviceRecord& record : records) {
      int index = 0;
      bind_key(add, index, key);
      sqlite::bind_texts(add, index, record, advice_texts);
      sqlite::bind_numbers(add, index, record, advice_numbers);
      add.bind(index, impl_->session);
      add.run();
    }
    transaction.commit();
  });
}

std::vector<AdviceRecord> Store::advice() const {
  return reporting(impl_->file, [&]() -> std::vector<AdviceRecord> {
    Statement query(impl_->db(), fmt::format("SELECT {0}, {1}, session FROM advice ORDER BY {0}, id",
                                             advice_key_columns(), own_names())
                                     .c_str());
    std::vector<AdviceRecord> records;
    while (query.step()) {
      AdviceRecord record;
      int index = 0;
      sqlite::read_texts(query, index, record.key, advice_key_texts);
      sqlite::read_numbers(query, index, record.key, advice_key_numbers);
      sqlite::read_texts(query, index, record, advice_texts);
      sqlite::read_numbers(query, index, record, advice_numbers);
      record.session = query.integer(index);
      records.push_back(std::move(record));
    }
    return records;
  });
}

std::vector<AdviceScene> Store::scenes() const {
  return reporting(impl_->file, [&]() -> std::vector<AdviceScene> {
    return texts_of(impl_->db(), "scenes", "scene", &AdviceScene::scene);
  });
}

std::vector<AdviceWords> Store::advice_words() const {
  return reporting(impl_->file, [&]() -> std::vector<AdviceWords> {
    return texts_of(impl_->db(), "answers", "words", &AdviceWords::words);
  });
}

}  // namespace hmax
