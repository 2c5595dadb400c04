#include "catalogue/input/suggest.hpp"

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

constexpr std::array<std::string_view, 5> names{"explicit_euler", "rk4", "rk4_38", "dormand_prince_54",
                                                "step"};

TEST(EditDistance, CountsInsertionsDeletionsSubstitutionsAndSwaps) {
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("stpe", "step"), 1u);
  EXPECT_EQ(edit_distance("rk4", "rk4"), 0u);
}

TEST(DidYouMean, FindsTheNearestName) {
  EXPECT_EQ(did_you_mean("stpe", names), "step");
  EXPECT_EQ(did_you_mean("explict_euler", names), "explicit_euler");
  EXPECT_EQ(did_you_mean("Explicit-Euler", names), "explicit_euler");
  EXPECT_EQ(did_you_mean("rk5", std::vector<std::string>{"rk4", "leapfrog"}), "rk4");
}

TEST(DidYouMean, CompletesABeginning) {
  EXPECT_EQ(did_you_mean("dormand", names), "dormand_prince_54");
  EXPECT_EQ(did_you_mean("rkc", std::vector<std::string>{"rk4", "rkc_2_adaptive", "rkc_2"}), "rkc_2");
  EXPECT_EQ(did_you_mean("RK4", std::vector<std::string>{"rk4_38", "rk4"}), "rk4");
}

TEST(DidYouMean, IsSilentWhenNothingIsNear) {
  EXPECT_EQ(did_you_mean("", names), "");
  EXPECT_EQ(did_you_mean("x", names), "");
  EXPECT_EQ(did_you_mean("leapfrog", names), "");
  EXPECT_EQ(did_you_mean(std::string(100000, 'a'), names), "");
}

TEST(Suggestion, OffersTheNearestNameOrElseTheNamesOrAnotherRemedy) {
  EXPECT_EQ(suggestion("rk5", std::vector<std::string>{"rk4", "leapfrog"}), "did you mean 'rk4'?");
  EXPECT_EQ(suggestion("euler", std::vector<std::string>{"rk4", "leapfrog"}), "known are rk4, leapfrog");
  EXPECT_EQ(suggestion("euler", std::vector<std::string>{}), "there are none");
  EXPECT_EQ(suggestion("euler", names, "see the list"), "see the list");
  EXPECT_EQ(suggestion("stpe", names, "see the list"), "did you mean 'step'?");
  EXPECT_EQ(suggestion("tpu", std::vector<std::string>{"cpu", "gpu"}), "did you mean 'cpu' or 'gpu'?");
}

}  // namespace
}  // namespace hmax
