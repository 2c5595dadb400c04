#include <cmath>

#include <gtest/gtest.h>

#include "results/row.hpp"

namespace hmax {
namespace {

// Positions by hand: with n = 9 samples, type 7 puts quantile p at index 8 p, counted from 0.
TEST(Summarise, QuantilesOfNineSamplesAreOrderStatistics) {
  const auto s = summarise({9, 1, 8, 2, 7, 3, 6, 4, 5});
  EXPECT_DOUBLE_EQ(s.median, 5);
  EXPECT_DOUBLE_EQ(s.q1, 3);
  EXPECT_DOUBLE_EQ(s.q3, 7);
  EXPECT_DOUBLE_EQ(s.p99, 8 + 0.92);
}

TEST(Summarise, InterpolatesBetweenOrderStatistics) {
  const auto s = summarise({10, 40, 20, 30});
  EXPECT_DOUBLE_EQ(s.median, 25);
  EXPECT_DOUBLE_EQ(s.q1, 17.5);
  EXPECT_DOUBLE_EQ(s.q3, 32.5);
  EXPECT_DOUBLE_EQ(s.p99, 39.7);
}

TEST(Summarise, OneSampleIsEveryQuantileAndNoneIsNaN) {
  const auto one = summarise({3});
  EXPECT_EQ(one.median, 3);
  EXPECT_EQ(one.p99, 3);
  EXPECT_TRUE(std::isnan(summarise({}).median));
  EXPECT_TRUE(std::isnan(summarise({1, std::nan(""), 2}).q1));
}

}  // namespace
}  // namespace hmax
