#include <cmath>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "results/limits/advice_columns.hpp"
#include "results/sqlite/columns.hpp"
#include "results/sqlite/store_impl.hpp"

namespace hmax {

namespace {

using sqlite::joined;
using sqlite::Statement;

std::string key_names() { return joined("", "", ", ", advice_key_texts, advice_key_numbers); }
std::string own_names() { return joined("", "", ", ", advice_texts, advice_numbers); }

void bind_key(Statement& statement, int& index, const AdviceKey& key) {
  sqlite::bind_texts(statement, index, key, advice_key_texts);
  for (const auto& column : advice_key_numbers) statement.bind(index++, key.*column.member);
}

bool has_advice(sqlite3* database) { return sqlite::integer(database, "PRAGMA user_version") >= 4; }

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
  {},
  UNIQUE ({}, method, options)
);
)sql",
      joined("", " TEXT NOT NULL", ",\n  ", advice_key_texts), joined("", " REAL NOT NULL", ",\n  ", advice_key_numbers),
      joined("", " TEXT NOT NULL", ",\n  ", advice_texts), joined("", " NOT NULL", ",\n  ", advice_numbers), key_names());
}

void Store::insert_advice(const AdviceKey& key, std::span<const AdviceRecord> records) {
  if (impl_->session == 0) throw std::logic_error("Store::insert_advice needs begin_session() first.");
  for (const auto& column : advice_key_numbers)
    if (!std::isfinite(key.*column.member))
      throw std::invalid_argument("The numbers of a question must be finite.");
  reporting(impl_->file, [&] {
    sqlite::Transaction transaction(impl_->db());
    Statement forget(impl_->db(),
                     fmt::format("DELETE FROM advice WHERE {}",
                                 joined("", " = ?", " AND ", advice_key_texts, advice_key_numbers))
                         .c_str());
    int index = 0;
    bind_key(forget, index, key);
    forget.run();
    Statement add(impl_->db(),
                  fmt::format("INSERT INTO advice ({}, {}, session) VALUES ({})", key_names(), own_names(),
                              sqlite::question_marks(advice_key_texts.size() + advice_key_numbers.size() +
                                                     advice_texts.size() + advice_numbers.size() + 1))
                      .c_str());
    for (const AdviceRecord& record : records) {
      index = 0;
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
    if (!has_advice(impl_->db())) return {};
    Statement query(impl_->db(), fmt::format("SELECT {0}, {1}, session FROM advice ORDER BY {0}, id", key_names(),
                                             own_names())
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

}  // namespace hmax
