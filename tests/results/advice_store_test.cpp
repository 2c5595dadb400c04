#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "results/exports.hpp"
#include "results/store.hpp"
#include "tests/results/made_rows.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

AdviceKey a_question(double rate = 100) {
  AdviceKey key;
  each_field(key, advice_key_fields, []<class T>(std::string_view name, T& value) {
    if constexpr (std::is_same_v<T, std::string>) value = std::string(name) + ", 'quoted'";
  });
  key.rate = rate;
  key.tolerance = 0.01;
  key.budget = 0.001;
  return key;
}

AdviceRecord a_record(const std::string& method) {
  AdviceRecord record;
  double value = 0.1;
  each_field(record, advice_fields, [&]<class T>(std::string_view name, T& field) {
    if constexpr (std::is_same_v<T, std::string>)
      field = name;
    else if constexpr (std::is_same_v<T, double>)
      field = value *= 1.7;
  });
  record.h_max = INFINITY;
  record.h_max_observed = NAN;
  record.method = method;
  return record;
}

TEST(AdviceStore, KeepsEveryColumn) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "s.sqlite");
  EXPECT_THROW(store.insert_advice(a_question(), {}), std::logic_error);
  store.begin_session({});
  const std::vector<AdviceRecord> records{a_record("rk4"), a_record("newmark")};
  store.insert_advice(a_question(), records);
  const std::vector<AdviceRecord> kept = Store::open_existing(scratch / "s.sqlite").advice();
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].key, a_question());
  for (std::size_t i = 0; i < 2; ++i) expect_same_fields(kept[i], records[i], advice_fields);
}

TEST(AdviceStore, ReplacesTheAnswerToTheSameQuestion) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "s.sqlite");
  store.begin_session({});
  store.insert_advice(a_question(), std::vector{a_record("rk4"), a_record("newmark")});
  store.insert_advice(a_question(1000), std::vector{a_record("rk4")});
  store.insert_advice(a_question(), std::vector{a_record("symplectic_euler")});
  const std::vector<AdviceRecord> kept = store.advice();
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].method, "symplectic_euler");
  EXPECT_EQ(kept[1].key.rate, 1000);
  AdviceKey endless = a_question();
  endless.budget = INFINITY;
  EXPECT_THROW(store.insert_advice(endless, {}), std::invalid_argument);
}

TEST(AdviceStore, KeepsTheBodyAndTheWordsOfAnAnswerUntilItIsReplaced) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "s.sqlite");
  store.begin_session({});
  const std::vector records{a_record("rk4")};
  store.insert_advice(a_question(), records, "{\"points\": 1}");
  store.insert_advice(a_question(1000), records, "", "{\"facts\": []}");
  const std::vector<AdviceScene> scenes = store.scenes();
  ASSERT_EQ(scenes.size(), 1U);
  EXPECT_EQ(scenes[0].key, a_question());
  EXPECT_EQ(scenes[0].scene, "{\"points\": 1}");
  EXPECT_EQ(scenes[0].session, 1);
  const std::vector<AdviceWords> words = store.advice_words();
  ASSERT_EQ(words.size(), 1U);
  EXPECT_EQ(words[0].key, a_question(1000));
  EXPECT_EQ(words[0].words, "{\"facts\": []}");
  EXPECT_EQ(words[0].session, 1);
  for (const double rate : {100.0, 1000.0}) store.insert_advice(a_question(rate), records);
  EXPECT_TRUE(store.scenes().empty());
  EXPECT_TRUE(store.advice_words().empty());
}

TEST(AdviceExports, WriteNumbersThatDoNotApply) {
  std::vector<AdviceRecord> records{a_record("rk4")};
  records[0].key = a_question();
  const std::string csv = rows_to_csv(records), lines = rows_to_jsonl(records);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 2);
  EXPECT_TRUE(says(csv, ",unbounded,,"));
  EXPECT_TRUE(says(lines, "\"h_max\":\"unbounded\",\"h_max_observed\":null"));
  EXPECT_TRUE(says(lines, "\"rate\":100,"));
}

}  // namespace
}  // namespace hmax
