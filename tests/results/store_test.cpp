#include "results/store.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/results/made_rows.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

Row row(const std::string& method, double h) {
  Row r = made_row(method, h);
  r.cpu_s = {1e-4, 2e-4, 1.5e-4};
  r.error_end = 1e-6;
  r.error_global = 2e-6;
  r.error_l2 = 1.5e-6;
  r.reference_error = 1e-14;
  r.reference = "dop_853 at 1e-14";
  return r;
}

void expect_same_row(const Row& a, const Row& b) {
  EXPECT_EQ(a.key, b.key);
  expect_same_fields(a, b, row_fields);
}

TEST(Store, EveryFieldComesBackBitForBit) {
  Scratch scratch;
  Row first = row("rk4", 0.1);
  first.key.material = "male_fat:heavy";
  constexpr char hostile[] = "a=1 \0 b='\"; DROP TABLE rows; -- \xc3\xa4";
  first.key.parameters = std::string(hostile, sizeof hostile - 1);
  first.key.rtol = 0.1 + 0.2;
  first.key.atol = std::numeric_limits<double>::denorm_min();
  first.outcome = "diverged";
  first.t_reached = nan;
  first.steps = std::numeric_limits<std::int64_t>::max();
  first.rejected = 7;
  first.rhs = (std::int64_t{1} << 53) + 1;
  first.cpu_s = {0.1,    -0.0,    0.0,   nan, inf, -inf, std::numeric_limits<double>::denorm_min(),
                 1e-308, 1.0 / 3, 1e300, 2};
  first.runs_per_sample = 12345;
  first.error_end = -0.0;
  first.error_global = inf;
  first.reference_error = 3 * std::numeric_limits<double>::denorm_min();
  first.reference = "exact";
  first.subnormals = 42;
  first.status = "It diverged at t = 3.";
  Row second = row("rk4", 0.2);
  second.error_end = -inf;
  second.cpu_s = {};
  {
    Store store = Store::open_or_create(scratch / "a.sqlite");
    EXPECT_EQ(store.begin_session({}), 1);
    store.insert(first);
    store.insert(second);
  }
  const Store store = Store::open_existing(scratch / "a.sqlite");
  const std::vector<Row> rows = store.rows();
  ASSERT_EQ(rows.size(), 2u);
  const bool swapped = rows[0].key.h == 0.2;
  expect_same_row(rows[swapped ? 1 : 0], first);
  expect_same_row(rows[swapped ? 0 : 1], second);
  EXPECT_EQ(rows[0].session, 1);
  EXPECT_TRUE(store.contains(first.key));
  EXPECT_FALSE(store.contains(row("rk4", 0.1).key));
}

TEST(Store, OrderOfRowsDoesNotDependOnOrderOfInsertion) {
  Scratch scratch;
  std::vector<Row> rows;
  for (const char* method : {"explicit_euler", "rk4", "dormand_prince_54"}) {
    for (const double h : {2.0, 0.6, 0.05, 0.00005}) rows.push_back(row(method, h));
  }
  std::mt19937 random(1);
  std::vector<RowKey> order;
  for (int trial = 0; trial < 5; ++trial) {
    std::shuffle(rows.begin(), rows.end(), random);
    Store store = Store::open_or_create(scratch / std::to_string(trial));
    store.begin_session({});
    for (const Row& r : rows) store.insert(r);
    std::vector<RowKey> keys;
    for (const Row& r : store.rows()) keys.push_back(r.key);
    if (trial == 0) order = keys;
    EXPECT_EQ(keys, order);
  }
  EXPECT_EQ(order.front().method, "dormand_prince_54");
  EXPECT_EQ(order[0].h, 2.0);
  EXPECT_EQ(order[3].h, 0.00005);
}

TEST(Store, KeepsARowOfADeviceBesideThatOfTheProcessor) {
  Scratch scratch;
  Store store = Store::open_or_create(scratch / "a");
  store.begin_session({});
  const Row here = row("rk4", 1);
  Row there = here, other = here;
  there.key.device = "card";
  there.key.precision = "double";
  there.cpu_s = {};
  there.device_s = {1e-6, 2e-6};
  there.clock_mhz = 1980;
  there.driver = "driver 1, run time 2";
  store.insert(here);
  EXPECT_FALSE(store.contains(there.key));
  EXPECT_FALSE(store.contains_measured(there.key));
  store.insert(there);
  other.key = there.key;
  other.key.precision = "single";
  store.insert(other);
  const std::vector<Row> rows = store.rows();
  ASSERT_EQ(rows.size(), 3U);
  expect_same_row(rows[0], here);
  expect_same_row(rows[1], there);
  EXPECT_EQ(rows[2].key.precision, "single");
}

TEST(Store, AKeyIsStoredOnceAndASpanWithADoubleIsStoredNotAtAll) {
  Scratch scratch;
  Store store = Store::open_or_create(scratch / "a");
  EXPECT_THROW(store.insert(row("rk4", 1)), std::logic_error);  // no session
  store.begin_session({});
  store.insert(row("rk4", 1));
  EXPECT_THROW(store.insert(row("rk4", 1)), std::logic_error);
  EXPECT_THROW(store.insert(std::vector{row("rk4", 3), row("rk4", 4), row("rk4", 3)}), std::logic_error);
  EXPECT_EQ(store.size(), 1);
  Row minus = row("rk4", 1);
  minus.key.rtol = -0.0;
  EXPECT_TRUE(store.contains(minus.key));
  minus.key.rtol = nan;
  EXPECT_THROW(store.insert(minus), std::invalid_argument);
  store.insert(std::vector{row("rk4", 3), row("rk4", 4)});
  EXPECT_EQ(store.size(), 3);
}

TEST(Store, ARowOfAnotherSessionIsThatOfAnotherProcess) {
  Scratch scratch;
  Store here = Store::open_or_create(scratch / "a"), there = Store::open_or_create(scratch / "a");
  there.begin_session({});
  there.insert(row("rk4", 1));
  // `here` has looked for missing rows before.
  here.begin_session({});
  EXPECT_THROW(here.insert(row("rk4", 1)), InputError);
  EXPECT_EQ(here.size(), 1);
}

TEST(Store, ARowNamesTheSessionThatMeasuredIt) {
  Scratch scratch;
  Fingerprint one, two;
  one.cpu = "one";
  two.cpu = "two";
  two.libraries["sqlite"] = "3";
  two.debug_build = true;
  {
    Store store = Store::open_or_create(scratch / "a");
    store.begin_session(one);
    store.insert(row("rk4", 1));
  }
  Store store = Store::open_or_create(scratch / "a");
  store.begin_session(two);
  store.insert(row("rk4", 0.5));
  const auto sessions = store.sessions();
  ASSERT_EQ(sessions.size(), 2u);
  EXPECT_EQ(sessions[0].fingerprint, one);
  EXPECT_EQ(sessions[1].fingerprint, two);
  EXPECT_EQ(sessions[1].started.size(), std::string("2024-05-06T07:08:09Z").size());
  EXPECT_EQ(store.rows()[0].session, 1);
  EXPECT_EQ(store.rows()[1].session, 2);
}

TEST(Store, RowsOfTwoSessionsComeInAnyOrder) {
  Scratch scratch;
  Store store = Store::open_or_create(scratch / "a");
  EXPECT_THROW(store.continue_session(1), std::logic_error);
  const std::int64_t one = store.begin_session({}), two = store.begin_session({});
  store.continue_session(one);
  store.insert(row("rk4", 4));
  store.continue_session(two);
  store.insert(row("rk4", 3));
  store.continue_session(one);
  store.insert(row("rk4", 2));
  std::vector<std::int64_t> sessions;
  for (const Row& each : store.rows()) sessions.push_back(each.session);
  EXPECT_EQ(sessions, (std::vector{one, two, one}));
}

TEST(Store, NotesAreReplacedAndKept) {
  Scratch scratch;
  {
    Store store = Store::open_or_create(scratch / "a");
    store.note("sweep", "h = [2]");
    store.note("sweep", "h = [2, 0.6]");
    store.note("empty", "");
  }
  const auto notes = Store::open_existing(scratch / "a").notes();
  EXPECT_EQ(notes, (std::map<std::string, std::string>{{"empty", ""}, {"sweep", "h = [2, 0.6]"}}));
}

TEST(Store, KeepsANameThatIsNotUtf8AsTextThatIs) {
  const Scratch scratch;
  Store store = Store::open_or_create(scratch / "a");
  store.begin_session({});
  Row odd = row("rk4", 0.1), other = row("rk4", 0.1);
  odd.key.problem = "k\xF6rper.msh";
  other.key.problem = "k\xF7rper.msh";
  store.insert(odd);
  EXPECT_TRUE(store.contains(odd.key));
  EXPECT_FALSE(store.contains(other.key));
  store.insert(other);
  const std::vector<Row> rows = store.rows();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].key.problem, "k\\xF6rper.msh");
  EXPECT_EQ(rows[1].key.problem, "k\\xF7rper.msh");
  EXPECT_TRUE(Store::open_existing(scratch / "a").contains(rows[0].key));
}

TEST(Store, MakesItsFolder) {
  Scratch scratch;
  Store::open_or_create(scratch / "results/runs/default.sqlite");
  EXPECT_TRUE(std::filesystem::exists(scratch / "results/runs/default.sqlite"));
}

TEST(Store, RefusesWhatIsNoStoreAndLeavesItUntouched) {
  Scratch scratch;
  for (const std::string& content :
       {std::string("h,error\n1,2\n"), std::string(5000, 'x'), std::string("SQLite format 3\0garbage", 23)}) {
    write_text(scratch / "notes.csv", content);
    for (const bool create : {true, false}) {
      const std::string words = error_of<InputError>([&] {
        create ? Store::open_or_create(scratch / "notes.csv") : Store::open_existing(scratch / "notes.csv");
      });
      EXPECT_TRUE(says(words, (scratch / "notes.csv").string()));
    }
    EXPECT_EQ(read_text(scratch / "notes.csv"), content);
  }
  EXPECT_TRUE(says(error_of<InputError>([&] { Store::open_or_create(scratch.folder()); }), "folder"));
  EXPECT_TRUE(says(error_of<InputError>([&] { Store::open_existing(scratch / "absent"); }), "no store"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "absent"));
  EXPECT_TRUE(says(error_of<InputError>([&] { Store::open_or_create("/dev/full"); }), "regular file"));
  write_text(scratch / "file", "x");
  EXPECT_NE(error_of<InputError>([&] { Store::open_or_create(scratch / "file/store"); }), "");
}

}  // namespace
}  // namespace hmax
