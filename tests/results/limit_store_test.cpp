#include <cmath>
#include <cstring>
#include <stdexcept>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "results/store.hpp"
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

bool same_bits(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof a) == 0;
}
template <class T>
bool same_bits(const T& a, const T& b) {
  return a == b;
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
  for (const auto& field : limit_fields)
    std::visit(
        [&]<class T>(T LimitRow::*member) {
          EXPECT_TRUE(same_bits(rows[0].*member, limit.*member)) << field.name;
        },
        field.member);
  const auto point = store.operating_point(a_point().key);
  ASSERT_TRUE(point);
  EXPECT_EQ(point->document, a_point().document);
  OperatingPointKey other = a_point().key;
  other.model = "another";
  EXPECT_FALSE(store.operating_point(other));
  EXPECT_TRUE(store.limits_at(other).empty());
}

constexpr const char* rows_of_layout_9 = R"sql(CREATE TABLE rows (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
  problem TEXT NOT NULL,
  material TEXT NOT NULL,
  parameters TEXT NOT NULL,
  y0 TEXT NOT NULL,
  method TEXT NOT NULL,
  mode TEXT NOT NULL,
  control TEXT NOT NULL,
  h REAL NOT NULL,
  rtol REAL NOT NULL,
  atol REAL NOT NULL,
  t_end REAL NOT NULL,
  outcome TEXT NOT NULL,
  t_reached NOT NULL,
  steps INTEGER NOT NULL,
  rejected INTEGER NOT NULL,
  rhs INTEGER NOT NULL,
  cpu_s TEXT NOT NULL,
  runs_per_sample INTEGER NOT NULL,
  error_end NOT NULL,
  error_global NOT NULL,
  error_l2 NOT NULL,
  reference_error NOT NULL,
  reference TEXT NOT NULL,
  subnormals INTEGER NOT NULL,
  status TEXT NOT NULL,
  explored INTEGER NOT NULL,
  digest TEXT NOT NULL,
  UNIQUE (problem, material, parameters, y0, mode, method, control, h DESC, rtol DESC, atol DESC, t_end DESC)
))sql";

constexpr const char* operating_points_of_layout_9 = R"sql(CREATE TABLE operating_points (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
  problem TEXT NOT NULL,
  material TEXT NOT NULL,
  parameters TEXT NOT NULL,
  y0 TEXT NOT NULL,
  model TEXT NOT NULL,
  asked TEXT NOT NULL,
  path TEXT NOT NULL,
  t_end REAL NOT NULL,
  document TEXT NOT NULL,
  digest TEXT NOT NULL,
  UNIQUE (problem, material, parameters, y0, model, asked, path, t_end)
))sql";

constexpr const char* limits_of_layout_9 = R"sql(CREATE TABLE limits (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
  point INTEGER NOT NULL REFERENCES operating_points(id),
  method TEXT NOT NULL,
  bound TEXT NOT NULL,
  state_kind TEXT NOT NULL,
  state TEXT NOT NULL,
  newton TEXT NOT NULL,
  verdict TEXT NOT NULL,
  path_note TEXT NOT NULL,
  note TEXT NOT NULL,
  details TEXT NOT NULL,
  h_max NOT NULL,
  h_unstable NOT NULL,
  re NOT NULL,
  im NOT NULL,
  omega NOT NULL,
  zeta NOT NULL,
  rate_slow NOT NULL,
  rate_fast NOT NULL,
  newton_h NOT NULL,
  newton_error NOT NULL,
  newton_error_bound NOT NULL,
  observed NOT NULL,
  gap NOT NULL,
  steps_used NOT NULL,
  step_defect NOT NULL,
  along_least NOT NULL,
  along_at NOT NULL,
  along_growing NOT NULL,
  along_grows_from NOT NULL,
  from_start NOT NULL,
  from_start_stride NOT NULL,
  digest TEXT NOT NULL,
  UNIQUE (point, method)
))sql";

constexpr const char* advice_of_layout_9 = R"sql(CREATE TABLE advice (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
  problem TEXT NOT NULL,
  material TEXT NOT NULL,
  parameters TEXT NOT NULL,
  y0 TEXT NOT NULL,
  model TEXT NOT NULL,
  motion TEXT NOT NULL,
  ranked_by TEXT NOT NULL,
  rate REAL NOT NULL,
  tolerance REAL NOT NULL,
  budget_s REAL NOT NULL,
  method TEXT NOT NULL,
  options TEXT NOT NULL,
  bound TEXT NOT NULL,
  verdict TEXT NOT NULL,
  status TEXT NOT NULL,
  frame_tail_s TEXT NOT NULL,
  stage TEXT NOT NULL,
  h NOT NULL,
  steps_per_frame NOT NULL,
  h_max NOT NULL,
  h_max_observed NOT NULL,
  h_accurate NOT NULL,
  error NOT NULL,
  frame_p50_s NOT NULL,
  frame_p99_s NOT NULL,
  frame_max_s NOT NULL,
  first_frame_s NOT NULL,
  frames NOT NULL,
  missed NOT NULL,
  newton_per_frame NOT NULL,
  linear_per_frame NOT NULL,
  memory_bytes NOT NULL,
  stiffening NOT NULL,
  digest TEXT NOT NULL,
  UNIQUE (problem, material, parameters, y0, model, motion, ranked_by, rate, tolerance, budget_s, method, options)
))sql";

constexpr const char* scenes_of_layout_9 = R"sql(CREATE TABLE scenes (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  session INTEGER NOT NULL REFERENCES sessions(id),
  problem TEXT NOT NULL,
  material TEXT NOT NULL,
  parameters TEXT NOT NULL,
  y0 TEXT NOT NULL,
  model TEXT NOT NULL,
  motion TEXT NOT NULL,
  ranked_by TEXT NOT NULL,
  rate REAL NOT NULL,
  tolerance REAL NOT NULL,
  budget_s REAL NOT NULL,
  scene TEXT NOT NULL,
  digest TEXT NOT NULL,
  UNIQUE (problem, material, parameters, y0, model, motion, ranked_by, rate, tolerance, budget_s)
))sql";

/// Another column in the lists is another layout: raise Store::schema_version, and write the tables
/// down here.
TEST(LimitStore, HasTheTablesOfItsLayout) {
  static_assert(Store::schema_version == 9);
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
  EXPECT_EQ(table("rows"), rows_of_layout_9);
  EXPECT_EQ(table("operating_points"), operating_points_of_layout_9);
  EXPECT_EQ(table("limits"), limits_of_layout_9);
  EXPECT_EQ(table("advice"), advice_of_layout_9);
  EXPECT_EQ(table("scenes"), scenes_of_layout_9);
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
