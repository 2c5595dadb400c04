#include <fstream>

#include "results/baseline.hpp"
#include "tests/cli/program.hpp"

namespace hmax {
namespace {

/// The committed baseline, whatever folder the command runs in.
const std::filesystem::path committed =
    std::filesystem::path(HMAX_SOURCE_DIR) / "results/baseline/accuracy.csv";

TEST(CheckCommand, TheCommittedBaselineHolds) {
  const Shell shell;
  const Told told = shell.hmax("check --json");
  ASSERT_EQ(told.exit_code, 0) << told.out << told.err;
  const auto document = told.json();
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
  const Told told = shell.hmax("check --update --baseline mine.csv");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_NE(told.out.find(wrong), std::string::npos) << told.out;
  EXPECT_TRUE(compare(read_baseline(committed), read_baseline(shell / "mine.csv")).equal());
}

TEST(CheckCommand, BadInputIsRefusedInOneSentence) {
  const Shell shell;
  expect_refused(shell.hmax("check --baseline nowhere.csv"), "nowhere.csv");
  expect_refused(shell.hmax("check --methods rk5"), "rk5");
  expect_refused(shell.hmax("check --update --methods rk4"), "--methods");
}

}  // namespace
}  // namespace hmax
