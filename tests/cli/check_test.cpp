#include <set>
#include <string>

#include "results/baseline.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

/// The committed baseline, whatever folder the command runs in.
const std::filesystem::path committed =
    std::filesystem::path(HMAX_SOURCE_DIR) / "results/baseline/accuracy.csv";

TEST(CheckCommand, TheCommittedBaselineHolds) {
  const Shell shell;
  const auto document = shell.json("check");
  EXPECT_TRUE(document.at("changed").empty() && document.at("missing").empty() &&
              document.at("added").empty());
  EXPECT_EQ(document.at("compared"), read_baseline(committed).size());
}

TEST(CheckCommand, FailsWhenAnErrorOrACountIsNotWhatItWas) {
  const Shell shell;
  std::vector<AccuracyRow> rows = read_baseline(committed);
  std::erase_if(rows, [](const AccuracyRow& row) { return row.method != "rk4"; });
  ASSERT_GE(rows.size(), 2U);
  rows[0].error_end *= 1.001;
  ++rows[1].rhs;
  write_baseline(shell / "moved.csv", rows);
  const Told told = shell.hmax("check --methods rk4 --baseline moved.csv --json");
  EXPECT_EQ(told.exit_code, 1);
  const auto changed = told.json().at("changed");
  ASSERT_EQ(changed.size(), 2U);
  EXPECT_EQ(changed[0].at("row"), rows[0].name());
  EXPECT_EQ(changed[0].at("what"), "error_end");
  EXPECT_EQ(changed[1].at("what"), "rhs");
}

TEST(CheckCommand, UpdateWritesTheBaselineAndShowsWhatMoved) {
  const Shell shell;
  std::vector<AccuracyRow> rows = read_baseline(committed);
  const std::string wrong = rows.back().name();
  ++rows.back().steps;
  write_baseline(shell / "mine.csv", rows);
  const std::string told = shell.text("check --update --baseline mine.csv");
  EXPECT_TRUE(says(told, wrong));
  EXPECT_TRUE(compare(read_baseline(committed), read_baseline(shell / "mine.csv")).equal());
}

TEST(CheckCommand, BadInputIsRefusedInOneSentence) {
  const Shell shell;
  expect_refused(shell.hmax("check --baseline nowhere.csv"), "nowhere.csv");
  expect_refused(shell.hmax("check --methods rk5"), "rk5");
  expect_refused(shell.hmax("check --update --methods rk4"), "--methods");
}

TEST(CheckCommand, TakesAMethodThatIsNamedTwiceOnce) {
  EXPECT_TRUE(Shell().json("check --methods rk4,explicit_runge_kutta,rk4").at("added").empty());
}

TEST(CheckCommand, GuardsAMethodOfOnesOwn) {
  const Shell shell;
  write_text(shell / "mine.toml", "a = [[], [1]]\nb = [\"1/2\", \"1/2\"]\n");
  // Nothing knows it yet.
  expect_refused(shell.hmax("check --tableau mine.toml"), "no rows of mine");
  expect_refused(shell.hmax("check --tableau mine.toml --update"), "--baseline");
  ASSERT_EQ(shell.hmax("check --tableau mine.toml --baseline mine.csv --update").exit_code, 0);
  const Told same = shell.hmax("check --tableau mine.toml --baseline mine.csv --json");
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
  EXPECT_GT(same.json().at("compared"), 0);
  EXPECT_EQ(same.json().at("compared"), read_baseline(shell / "mine.csv").size());
  // Another method of the same order.
  write_text(shell / "mine.toml", "a = [[], [\"2/3\"]]\nb = [\"1/4\", \"3/4\"]\n");
  const Told other = shell.hmax("check --tableau mine.toml --baseline mine.csv");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_TRUE(says(other.out, "hmax check --update --tableau mine.toml --baseline mine.csv")) << other.out;
  // Rows of others stay.
  write_text(shell / "other.toml", "a = [[], [\"1/2\"]]\nb = [0, 1]\n");
  ASSERT_EQ(shell.hmax("check --tableau other.toml --baseline mine.csv --update").exit_code, 0);
  std::set<std::string> ids;
  for (const AccuracyRow& row : read_baseline(shell / "mine.csv")) ids.insert(row.method);
  EXPECT_EQ(ids, (std::set<std::string>{"mine", "other"}));
}

TEST(CheckCommand, NamesMethodsThatItDoesNotRun) {
  const Shell shell;
  for (const nlohmann::json& method : shell.json("list methods")) {
    if (method.at("engine") == "hmax") continue;
    const std::string id = method.at("id");
    expect_refused(shell.hmax("check --methods " + id), id);
    const Told beside = shell.hmax("check --methods rk4," + id);
    EXPECT_EQ(beside.exit_code, 0);
    EXPECT_TRUE(says(beside.err, id));
    return;
  }
}

}  // namespace
}  // namespace hmax
