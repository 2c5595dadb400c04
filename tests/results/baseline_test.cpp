#include "results/baseline.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

const AccuracyRow accuracy_row{.problem = "liver_forced",
                               .method = "rk4",
                               .setting = "h=0.2",
                               .outcome = "reached_end",
                               .error_end = 1.25e-5,
                               .error_samples = 3e-5,
                               .steps = 50,
                               .rejected = 1,
                               .rhs = 200,
                               .jacobian = 2,
                               .factorisations = 3,
                               .newton = 4};

AccuracyRow with(auto change) {
  AccuracyRow changed = accuracy_row;
  change(changed);
  return changed;
}

TEST(Baseline, ReadsBackWhatItWrote) {
  const Scratch scratch;
  AccuracyRow lost = accuracy_row;
  lost.setting = "h=2";
  lost.outcome = "diverged";
  lost.error_end = lost.error_samples = std::numeric_limits<double>::quiet_NaN();
  write_baseline(scratch / "baseline.csv", {accuracy_row, lost});
  const AccuracyComparison comparison =
      compare(read_baseline(scratch / "baseline.csv"), {accuracy_row, lost});
  EXPECT_EQ(comparison.compared, 2);
  EXPECT_TRUE(comparison.equal());
}

TEST(Baseline, NoticesEveryNumberThatMoves) {
  const auto changes = [](const AccuracyRow& now) { return compare({accuracy_row}, {now}).changed; };
  EXPECT_TRUE(changes(accuracy_row).empty());
  for (const AccuracyRow& now :
       {with([](auto& r) { r.error_end *= 1.00001; }), with([](auto& r) { r.error_samples *= 0.99; }),
        with([](auto& r) { r.outcome = "diverged"; }), with([](auto& r) { ++r.steps; }),
        with([](auto& r) { ++r.rejected; }), with([](auto& r) { --r.rhs; }),
        with([](auto& r) { ++r.jacobian; }), with([](auto& r) { ++r.factorisations; }),
        with([](auto& r) { ++r.newton; }),
        with([](auto& r) { r.error_end = std::numeric_limits<double>::quiet_NaN(); })})
    EXPECT_EQ(changes(now).size(), 1U);
  // What rounding does is no change.
  EXPECT_TRUE(changes(with([](auto& r) { r.error_end *= 1 + 1e-8; })).empty());
}

TEST(Baseline, TellsMissingAndAddedRows) {
  const AccuracyRow other = with([](auto& r) { r.method = "rk5"; });
  const AccuracyComparison comparison = compare({accuracy_row}, {other});
  EXPECT_EQ(comparison.missing, std::vector<std::string>{"liver_forced rk4 h=0.2"});
  EXPECT_EQ(comparison.added, std::vector<std::string>{"liver_forced rk5 h=0.2"});
  EXPECT_FALSE(comparison.equal());
}

TEST(Baseline, BrokenFilesAreRefusedByLine) {
  const Scratch scratch;
  EXPECT_THROW(read_baseline(scratch / "absent.csv"), InputError);
  for (const char* line : {"liver,rk4", "a,b,c,d,x,0,1,1,1,1,1,1", "a,b,c,d,0,0,1e300,1,1,1,1,1"}) {
    write_text(scratch / "broken.csv", std::string("\n") + line + "\n");
    EXPECT_TRUE(says(error_of<InputError>([&] { read_baseline(scratch / "broken.csv"); }), "broken.csv:2"));
  }
}

}  // namespace
}  // namespace hmax
