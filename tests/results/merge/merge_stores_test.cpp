#include "results/merge/merge_stores.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

Fingerprint machine(const std::string& cpu) {
  Fingerprint f;
  f.cpu = cpu;
  return f;
}

Row numbered(int number, double seconds = 1e-3) {
  Row r;
  r.key.problem = "dahlquist";
  r.key.method = "rk4";
  r.key.mode = "fixed";
  r.key.h = number + 1;
  r.outcome = "reached_end";
  r.steps = 10 * number;
  r.error_end = -0.0;
  r.error_global = std::numeric_limits<double>::quiet_NaN();
  r.cpu_s = {seconds, 2 * seconds};
  return r;
}

/// A store of the rows [from, to).
std::filesystem::path made(const std::filesystem::path& file, int from, int to, const std::string& cpu) {
  Store store = Store::open_or_create(file);
  store.note("sweep", "one");
  store.begin_session(machine(cpu), "2024-05-06T07:08:09Z");
  for (int i = from; i < to; ++i) store.insert(numbered(i));
  return file;
}

LimitRow limit(const std::string& method, double h_max) {
  LimitRow row;
  row.method = method;
  row.bound = "stability";
  row.h_max = h_max;
  return row;
}

AdviceRecord recommended(const std::string& method) {
  AdviceRecord record;
  record.method = method;
  record.verdict = "recommended";
  return record;
}

TEST(Merge, HasEveryRowWithItsMachineAndTheTimeOfItsSession) {
  const Scratch scratch;
  Store out = Store::open_or_create(scratch / "out.sqlite");
  Merger merger(out);
  merger.add(made(scratch / "a.sqlite", 0, 3, "first"));
  merger.add(made(scratch / "b.sqlite", 3, 5, "second"));
  EXPECT_EQ(merger.summary().added, 5);
  EXPECT_EQ(merger.summary().doubled, 0);
  EXPECT_TRUE(merger.summary().conflicts.empty());
  const std::vector<Row> rows = out.rows();
  ASSERT_EQ(rows.size(), 5U);
  const std::vector<Session> sessions = out.sessions();
  ASSERT_EQ(sessions.size(), 2U);
  EXPECT_EQ(sessions[0].started, "2024-05-06T07:08:09Z");
  for (const Row& row : rows) {  // from large h to small
    const int number = static_cast<int>(row.key.h) - 1;
    EXPECT_EQ(row.steps, 10 * number);
    EXPECT_TRUE(row.error_end == 0 && std::signbit(row.error_end));
    EXPECT_TRUE(std::isnan(row.error_global));
    EXPECT_EQ(row.cpu_s, (std::vector<double>{1e-3, 2e-3}));
    EXPECT_EQ(sessions.at(static_cast<std::size_t>(row.session) - 1).fingerprint.cpu,
              number < 3 ? "first" : "second");
  }
  EXPECT_EQ(out.notes().at("sweep"), "one");
}

TEST(Merge, CountsWhatIsDoubledAndNamesWhatDiffers) {
  const Scratch scratch;
  const auto a = made(scratch / "a.sqlite", 0, 3, "first");
  {
    Store b = Store::open_or_create(scratch / "b.sqlite");
    b.begin_session(machine("second"));
    b.insert(numbered(1, 7e-3));  // another time is no difference
    Row other = numbered(2);
    other.steps = 21;
    b.insert(other);
    b.insert(numbered(3));
  }
  Store out = Store::open_or_create(scratch / "out.sqlite");
  Merger merger(out);
  merger.add(a);
  merger.add(scratch / "b.sqlite");
  const MergeSummary& summary = merger.summary();
  EXPECT_EQ(summary.added, 4);
  EXPECT_EQ(summary.doubled, 1);
  ASSERT_EQ(summary.conflicts.size(), 1U);
  EXPECT_EQ(summary.conflicts[0].file.filename(), "b.sqlite");
  EXPECT_EQ(summary.conflicts[0].changes, (std::vector<std::string>{"steps: 20 -> 21"}));
  ASSERT_EQ(out.size(), 4);
  for (const Row& row : out.rows())
    EXPECT_EQ(row.steps, 10 * (static_cast<int>(row.key.h) - 1)) << "the first one counts";
  EXPECT_FALSE(out.notes().contains("sweep")) << "one of the stores is of no sweep";
}

TEST(Merge, PutsMeasuredRowsInPlaceOfExploredOnesWithTheSameResults) {
  const Scratch scratch;
  const auto a = scratch / "a.sqlite", b = scratch / "b.sqlite";
  const auto store = [](const std::filesystem::path& file, std::vector<Row> rows, bool explored) {
    Store made = Store::open_or_create(file);
    made.begin_session(machine("any"));
    for (Row& row : rows) row.explored = explored;
    made.insert(rows);
  };
  Row other = numbered(2);
  other.steps = 21;
  store(a, {numbered(1, 5e-3), other, numbered(3)}, true);
  store(b, {numbered(1), numbered(2)}, false);
  for (const bool explored_first : {true, false}) {
    Store out = Store::open_or_create(scratch / (explored_first ? "out_1.sqlite" : "out_2.sqlite"));
    Merger merger(out);
    merger.add(explored_first ? a : b);
    merger.add(explored_first ? b : a);
    EXPECT_EQ(merger.summary().conflicts.size(), 1U) << "other steps are no matter of time";
    EXPECT_EQ(merger.summary().added, 3) << "the rows of the output";
    EXPECT_EQ(merger.summary().doubled, 1);
    const std::vector<Row> rows = out.rows();  // from large h to small
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_TRUE(rows[0].explored);
    EXPECT_EQ(rows[1].explored, explored_first) << "the first of a conflict counts";
    EXPECT_FALSE(rows[2].explored);
    EXPECT_EQ(rows[2].cpu_s, (std::vector<double>{1e-3, 2e-3}));
  }
}

TEST(Merge, MadeAgainAddsNothingAndTakesWhatIsNew) {
  const Scratch scratch;
  const auto a = made(scratch / "a.sqlite", 0, 3, "first");
  const auto merged = [&] {
    Store out = Store::open_or_create(scratch / "out.sqlite");
    Merger merger(out);
    merger.add(a);
    return merger.summary();
  };
  EXPECT_EQ(merged().added, 3);
  EXPECT_EQ(merged().added, 0);
  EXPECT_EQ(Store::open_existing(scratch / "out.sqlite").sessions().size(), 1U);
  made(scratch / "a.sqlite", 3, 4, "first");
  const MergeSummary last = merged();
  EXPECT_EQ(last.added, 1);
  EXPECT_EQ(last.doubled, 3);
}

TEST(Merge, TakesLimitsAndAnswersWithTheirBodies) {
  const Scratch scratch;
  OperatingPointRow point;
  point.key.problem = "liver";
  point.key.model = "d1";
  point.key.t_end = 2;
  point.document = "{}";
  AdviceKey question;
  question.problem = "liver";
  question.rate = 100;
  {
    Store a = Store::open_or_create(scratch / "a.sqlite");
    a.begin_session(machine("first"));
    a.insert_limits(point, std::vector<LimitRow>{limit("rk4", 0.1)});
    a.insert_advice(question, std::vector<AdviceRecord>{recommended("rk4")}, "{}", "{\"words\": 1}");
  }
  {
    Store b = Store::open_or_create(scratch / "b.sqlite");
    b.begin_session(machine("second"));
    b.insert_limits(point, std::vector<LimitRow>{limit("rk4", 0.2), limit("newmark", 0.3)});
    b.insert_advice(question, std::vector<AdviceRecord>{recommended("newmark")});
  }
  Store out = Store::open_or_create(scratch / "out.sqlite");
  Merger merger(out);
  merger.add(scratch / "a.sqlite");
  merger.add(scratch / "b.sqlite");
  ASSERT_EQ(merger.summary().conflicts.size(), 1U);
  EXPECT_EQ(merger.summary().conflicts[0].changes, (std::vector<std::string>{"h_max: 0.1 -> 0.2"}));
  const std::vector<LimitRow> limits = out.limits_at(point.key);
  ASSERT_EQ(limits.size(), 2U);
  EXPECT_EQ(limits[0].h_max, 0.1);
  EXPECT_EQ(limits[1].method, "newmark");
  EXPECT_EQ(out.operating_point(point.key).value().document, point.document);
  ASSERT_EQ(out.advice().size(), 1U) << "an answer is not mixed from two";
  EXPECT_EQ(out.advice()[0].method, "rk4");
  ASSERT_EQ(out.scenes().size(), 1U);
  ASSERT_EQ(out.advice_words().size(), 1U);
  EXPECT_EQ(out.advice_words()[0].words, "{\"words\": 1}");
}

TEST(Merge, RefusesTheOutputAsInputAndWhatIsNoStore) {
  const Scratch scratch;
  const auto a = made(scratch / "a.sqlite", 0, 3, "first");
  Store out = Store::open_existing(a);
  Merger merger(out);
  EXPECT_THROW(merger.add(a), InputError);
  EXPECT_THROW(merger.add(scratch / "absent.sqlite"), InputError);
  write_text(scratch / "text.sqlite", std::string(200, 'x'));
  EXPECT_THROW(merger.add(scratch / "text.sqlite"), InputError);
  EXPECT_EQ(out.size(), 3);
}

}  // namespace
}  // namespace hmax
