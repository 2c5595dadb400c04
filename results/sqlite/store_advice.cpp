#include <array>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "results/sqlite/columns.hpp"
#include "results/sqlite/row_digest.hpp"
#include "results/sqlite/store_impl.hpp"

namespace hmax {

namespace {

using sqlite::bind_key, sqlite::joined, sqlite::read_rows;
using sqlite::Statement;

std::string names_of_question() { return joined("", "", ", ", advice_key_fields); }
std::string names_of_all() { return joined("", "", ", ", advice_key_fields, advice_fields); }

void forget(sqlite3* database, const char* table, const AdviceKey& key) {
  Statement statement(
      database,
      fmt::format("DELETE FROM {} WHERE {}", table, joined("", " = ?", " AND ", advice_key_fields)).c_str());
  int index = 0;
  bind_key(statement, index, key, advice_key_fields);
  statement.run();
}

/// A text of an answer into its table, in the column of this name.
void add_text(sqlite3* database, const char* table, const char* column, const AdviceKey& key,
              std::string_view text, std::int64_t session) {
  Statement statement(
      database,
      sqlite::insert_into(table, fmt::format("{}, {}, session", names_of_question(), column)).c_str());
  int index = 0;
  bind_key(statement, index, key, advice_key_fields);
  statement.bind(index++, text);
  statement.bind(index, session);
  statement.run();
}

/// Every text of a table, ordered by the keys.
/// @param text  the member of Kept that holds it
template <class Kept>
std::vector<Kept> texts_of(sqlite3* database, const char* table, const char* column,
                           std::string Kept::*text) {
  Statement query(database, fmt::format("SELECT {0}, {1}, session FROM {2} ORDER BY {0}", names_of_question(),
                                        column, table)
                                .c_str());
  return read_rows(query, &Kept::key, advice_key_fields, std::array{Field<Kept>{column, text}});
}

}  // namespace

void Store::insert_advice(const AdviceKey& key, std::span<const AdviceRecord> records, std::string_view scene,
                          std::string_view words) {
  if (impl_->session == 0) throw std::logic_error("Store::insert_advice needs begin_session() first.");
  reporting(impl_->file, [&] {
    sqlite::Transaction transaction(impl_->db());
    for (const char* table : {"advice", "scenes", "answers"}) forget(impl_->db(), table, key);
    if (!scene.empty()) add_text(impl_->db(), "scenes", "scene", key, scene, impl_->session);
    if (!words.empty()) add_text(impl_->db(), "answers", "words", key, words, impl_->session);
    Statement add(impl_->db(), sqlite::insert_into("advice", names_of_all() + ", session").c_str());
    for (const AdviceRecord& record : records) {
      int index = 0;
      bind_key(add, index, key, advice_key_fields);
      sqlite::bind_fields(add, index, record, advice_fields);
      add.bind(index, impl_->session);
      add.run();
    }
    transaction.commit();
  });
}

std::vector<AdviceRecord> Store::advice() const {
  return reporting(impl_->file, [&]() -> std::vector<AdviceRecord> {
    Statement query(impl_->db(), fmt::format("SELECT {}, session FROM advice ORDER BY {}, id", names_of_all(),
                                             names_of_question())
                                     .c_str());
    return read_rows(query, &AdviceRecord::key, advice_key_fields, advice_fields);
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
