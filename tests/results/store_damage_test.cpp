// Damage to a store: flipped bits, values of other types, pages that SQLite cannot read.
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "core/errors.hpp"
#include "results/exports.hpp"
#include "results/store.hpp"
#include "tests/results/made_rows.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// Texts that say what they are of.
constexpr auto name_texts = []<class T>(std::string_view name, T& value) {
  if constexpr (std::is_same_v<T, std::string>) value = "text of " + std::string(name);
};

/// Two sessions with runs, limits and advice of every table.
void make_store(const std::filesystem::path& file) {
  Store store = Store::open_or_create(file);
  for (const char* cpu : {"one", "two"}) {
    Fingerprint machine;
    machine.cpu = cpu;
    store.begin_session(machine);
    for (const char* method : {"rk4", "newmark", "explicit_euler"}) {
      Row row = made_row(method, 0.125);
      row.key.material = cpu;
      row.cpu_s = {1e-4, 2e-4};
      row.error_end = 1.0 / 3;
      row.error_l2 = std::nan("");
      row.error_global = -0.0;
      store.insert(row);
    }
    OperatingPointRow point;
    point.key.problem = "liver_benchmark";
    point.key.material = cpu;
    point.document = "{}";
    LimitRow limit;
    each_field(limit, limit_fields, name_texts);
    limit.h_max = 0.1;
    limit.re = -0.0;
    store.insert_limits(point, std::vector{limit});
    AdviceKey question;
    question.problem = cpu;
    question.rate = 100;
    AdviceRecord record;
    each_field(record, advice_fields, name_texts);
    record.h = 0.01;
    store.insert_advice(question, std::vector{record}, "{\"scene\": 1}", "{\"words\": 1}");
  }
  store.note("sweep", "a test");
}

/// Everything that commands take from a store.
std::string all_of(const Store& store) {
  std::string text = rows_to_jsonl(store.rows()) + rows_to_csv(store.rows());
  text += rows_to_csv(store.limits()) + rows_to_csv(store.advice());
  for (const LimitRow& limit : store.limits()) text += store.operating_point(limit.point).value().document;
  for (const AdviceScene& scene : store.scenes()) text += scene.key.problem + scene.scene;
  for (const AdviceWords& words : store.advice_words()) text += words.key.problem + words.words;
  for (const Row& row : store.rows()) text += std::to_string(row.session);
  for (const Session& session : store.sessions())
    text += std::to_string(session.id) + session.started + to_json(session.fingerprint);
  for (const auto& [key, value] : store.notes()) text += key + value;
  return text;
}

std::string error_of_reading(const std::filesystem::path& file) {
  return error_of<InputError>([&] { (void)all_of(Store::open_existing(file)); });
}

void damage_by_sql(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database) << ": " << sql;
  sqlite3_close(database);
}

/// The names in a column of a query's answer.
std::vector<std::string> names_of(const std::filesystem::path& file, const std::string& sql) {
  std::vector<std::string> names;
  sqlite3* database = nullptr;
  sqlite3_open(file.c_str(), &database);
  const auto take = [](void* into, int, char** cells, char**) {
    static_cast<std::vector<std::string>*>(into)->emplace_back(cells[0]);
    return 0;
  };
  sqlite3_exec(database, sql.c_str(), take, &names, nullptr);
  sqlite3_close(database);
  return names;
}

/// A copy of a store without what readers leave beside it.
void put_alone(const std::filesystem::path& file, const std::string& bytes) {
  for (const char* ending : {"-wal", "-shm", "-journal"}) std::filesystem::remove(file.string() + ending);
  write_text(file, bytes);
}

TEST(StoreDamage, AFlippedBitIsRefusedOrChangesNothing) {
  const Scratch scratch;
  make_store(scratch / "whole");
  const std::string bytes = read_text(scratch / "whole");
  const std::string expected = all_of(Store::open_existing(scratch / "whole"));
  ASSERT_GT(expected.size(), 2000U);
  // Most of a page is room for more rows: three of four flips are where something stands.
  std::mt19937 random(9);
  int refused = 0, accepted = 0;
  for (int trial = 0; trial < 600; ++trial) {
    std::size_t at = random() % bytes.size();
    while (trial % 4 != 0 && bytes[at] == 0) at = random() % bytes.size();
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 1 << random() % 8);
    put_alone(scratch / "flipped", damaged);
    std::string found;
    const std::string error =
        error_of<InputError>([&] { found = all_of(Store::open_existing(scratch / "flipped")); });
    refused += error.empty() ? 0 : 1;
    if (!error.empty()) {
      EXPECT_TRUE(says(error, "flipped"));
    } else if (found != expected) {
      ++accepted;
      ADD_FAILURE() << "a bit of byte " << at << " changes what is read";
    }
  }
  EXPECT_EQ(accepted, 0);
  EXPECT_GT(refused, 200);
}

TEST(StoreDamage, AnyChangedValueIsRefusedAndItsRowIsNamed) {
  const Scratch scratch;
  make_store(scratch / "whole");
  const std::string bytes = read_text(scratch / "whole");
  int changed = 0;
  for (const char* table :
       {"notes", "sessions", "rows", "operating_points", "limits", "advice", "scenes", "answers"}) {
    for (const std::string& column :
         names_of(scratch / "whole", std::string("SELECT name FROM pragma_table_info('") + table + "')")) {
      if (column == "id") continue;
      put_alone(scratch / "changed", bytes);
      damage_by_sql(scratch / "changed", std::string("UPDATE ") + table + " SET " + column +
                                             " = 'abc' WHERE " + "rowid = (SELECT max(rowid) FROM " + table +
                                             ")");
      const std::string error = error_of_reading(scratch / "changed");
      EXPECT_TRUE(says(error, std::string(" of its table ") + table)) << column;
      EXPECT_TRUE(says(error, "differs from its digest")) << column;
      ++changed;
    }
  }
  EXPECT_GT(changed, 100);
}

TEST(StoreDamage, TheRowAndItsMethodAreNamedAndTheRestIsReadWithoutIt) {
  const Scratch scratch;
  const auto file = scratch / "s";
  make_store(file);
  damage_by_sql(file, "UPDATE rows SET h = 'abc' WHERE id = 2");
  const std::string error = error_of_reading(file);
  EXPECT_TRUE(says(error, "row 2 of its table rows: newmark, differs from its digest"));
  EXPECT_TRUE(says(error, "DELETE FROM rows WHERE rowid = 2"));
  EXPECT_EQ(error_of<InputError>([&] { Store::open_or_create(file); }), error)
      << "nothing is resumed from it";
  damage_by_sql(file, "DELETE FROM rows WHERE rowid = 2");
  EXPECT_EQ(error_of_reading(file), "");
  EXPECT_EQ(Store::open_existing(file).size(), 5);
}

TEST(StoreDamage, OtherTypesAndRowsThatAreGoneOrReferToNothingAreRefused) {
  const Scratch scratch;
  make_store(scratch / "whole");
  const std::string bytes = read_text(scratch / "whole");
  for (const auto& [change, words] :
       {std::pair{"UPDATE rows SET t_reached = CAST(t_reached AS INTEGER)", "is damaged"},
        {"UPDATE rows SET outcome = CAST(outcome AS BLOB)", "is damaged"},
        {"UPDATE rows SET steps = 1e300", "is damaged"},
        {"UPDATE limits SET h_max = CAST(h_max AS TEXT)", "is damaged"},
        {"UPDATE rows SET error_global = 0.0", "is damaged"},
        {"DELETE FROM operating_points WHERE id = 1",
         "row 1 of its table limits: refers to a row of operating_points that is not there"},
        {"UPDATE sessions SET id = 7 WHERE id = 2", "refers to a row of sessions that is not there"},
        {"DROP TABLE advice", "it has no table 'advice'"},
        {"ALTER TABLE rows RENAME COLUMN rhs TO evaluations", "is damaged"}}) {
    put_alone(scratch / "changed", bytes);
    damage_by_sql(scratch / "changed", change);
    EXPECT_TRUE(says(error_of_reading(scratch / "changed"), words)) << change;
  }
}

TEST(StoreDamage, APageThatSqliteCannotReadNamesTheFile) {
  const Scratch scratch;
  make_store(scratch / "whole");
  const std::string bytes = read_text(scratch / "whole");
  for (std::size_t page = 1; page < bytes.size() / 4096; ++page) {
    std::string damaged = bytes;
    std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(page * 4096), 64, '\x5a');
    put_alone(scratch / "torn", damaged);
    const std::string error = error_of_reading(scratch / "torn");
    EXPECT_TRUE(says(error, "torn' is damaged")) << page;
  }
}

}  // namespace
}  // namespace hmax
