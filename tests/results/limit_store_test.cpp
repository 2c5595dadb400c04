#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "core/text/digest.hpp"
#include "results/store.hpp"
#include "tests/results/made_rows.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

OperatingPointRow a_point(const std::string& material = "male_slim") {
  OperatingPointRow point;
  point.key = {.problem = "liver_benchmark",
               .material = material,
               .parameters = "m=1 c=2",
               .y0 = "0.5,1",
               .model = "0123456789abcdef",
               .asked = "equilibrium",
               .path = "motion",
               .t_end = 30};
  point.document = "{\"eigenvalues\": []}";
  return point;
}

/// Every column with a value of its own, among them those that SQLite would change.
LimitRow a_limit(const std::string& method) {
  LimitRow row;
  double value = 0.1;
  each_field(row, limit_fields, [&]<class T>(std::string_view name, T& field) {
    if constexpr (std::is_same_v<T, std::string>)
      field = "text of " + std::string(name);
    else if constexpr (std::is_same_v<T, double>)
      field = value += 1.0 / 3;
  });
  row.method = method;
  row.h_max = INFINITY;
  row.h_unstable = LimitRow::none;
  row.re = -0.0;
  return row;
}

TEST(LimitStore, KeepsEveryColumnBitForBit) {
  const Scratch scratch;
  const LimitRow limit = a_limit("rk4");
  {
    Store store = Store::open_or_create(scratch / "s.sqlite");
    store.begin_session({});
    store.insert_limits(a_point(), std::span(&limit, 1));
  }
  const Store store = Store::open_existing(scratch / "s.sqlite");
  const std::vector<LimitRow> rows = store.limits_at(a_point().key);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].point, a_point().key);
  EXPECT_EQ(rows[0].session, 1);
  expect_same_fields(rows[0], limit, limit_fields);
  const auto point = store.operating_point(a_point().key);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->document, a_point().document);
  OperatingPointKey other = a_point().key;
  other.model = "another";
  EXPECT_FALSE(store.operating_point(other));
  EXPECT_TRUE(store.limits_at(other).empty());
}

/// Another column in the lists is another layout: raise Store::schema_version, and write the digests of its
/// tables down here.
TEST(LimitStore, HasTheTablesOfItsLayout) {
  static_assert(Store::schema_version == 10);
  const Scratch scratch;
  const std::string file = (scratch / "s.sqlite").string();
  Store::open_or_create(file);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const auto table = [&](const char* name) {
    std::string text;
    const std::string query = std::string("SELECT sql FROM sqlite_master WHERE name = '") + name + "'";
    const auto take = [](void* into, int, char** cells, char**) {
      *static_cast<std::string*>(into) = cells[0];
      return 0;
    };
    sqlite3_exec(database, query.c_str(), take, &text, nullptr);
    return text;
  };
  for (const auto& [name, expected] : {std::pair{"notes", "d140298ada7fad15"},
                                       {"sessions", "13703dedd1b63413"},
                                       {"rows", "eb76da570267bcbb"},
                                       {"operating_points", "839a70643d3b475a"},
                                       {"limits", "75f71ed0d6832cc4"},
                                       {"advice", "e17b5f0c1aa10b06"},
                                       {"scenes", "0663d8420c736e17"},
                                       {"answers", "5b69489cd03f4bc0"}}) {
    Digest digest;
    digest.add(table(name));
    EXPECT_EQ(digest.text(), expected) << table(name);
  }
  sqlite3_close(database);
}

TEST(LimitStore, ReplacesALimitOfTheSameKeyAndKeepsTheOthers) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "s.sqlite");
  store.begin_session({});
  const std::vector<LimitRow> both{a_limit("rk4"), a_limit("newmark")};
  store.insert_limits(a_point(), both);
  store.begin_session({});
  LimitRow changed = a_limit("rk4");
  changed.observed = 7;
  OperatingPointRow point = a_point();
  point.document = "{\"state\": \"other\"}";
  store.insert_limits(point, std::span(&changed, 1));
  store.insert_limits(a_point("female_fat"), both);

  const std::vector<LimitRow> rows = store.limits_at(point.key);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].method, "rk4");
  EXPECT_EQ(rows[0].observed, 7);
  EXPECT_EQ(rows[0].session, 2);
  EXPECT_EQ(rows[1].session, 1);
  EXPECT_EQ(store.operating_point(point.key)->document, point.document);
  const std::vector<LimitRow> all = store.limits();
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[0].point.material, "female_fat");
  EXPECT_EQ(all[0].method, "newmark");
  EXPECT_EQ(store.size(), 0);  // measured rows
}

TEST(LimitStore, RefusesLimitsWithoutASessionAndEndlessMotions) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "s.sqlite");
  const LimitRow limit = a_limit("rk4");
  EXPECT_THROW(store.insert_limits(a_point(), std::span(&limit, 1)), std::logic_error);
  store.begin_session({});
  OperatingPointRow endless = a_point();
  endless.key.t_end = INFINITY;
  EXPECT_THROW(store.insert_limits(endless, std::span(&limit, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
