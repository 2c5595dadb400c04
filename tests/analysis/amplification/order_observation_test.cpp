#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "analysis/amplification/order.hpp"

namespace hmax {
namespace {

constexpr std::array end_times{1.0, 2.0, 5.0};

TEST(ObservedOrder, IsTheExponentOfAPowerLaw) {
  const auto seen = observe_order([](double, double h) { return 3 * std::pow(h, 2.5); }, end_times, 1e-16);
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 2.5, 1e-9);
}

TEST(ObservedOrder, KeepsAwayFromRounding) {
  const auto seen = observe_order([](double, double h) { return std::pow(h, 8) + 1e-17; }, end_times, 1e-14);
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 8, 0.01);
  for (const double error : seen.error) EXPECT_GT(error, 1e-14);
}

TEST(ObservedOrder, AvoidsATimeAtWhichTheLeadingTermVanishes) {
  const auto error = [](double t, double h) {
    return t == 2 ? std::abs(std::pow(h, 4) - 300 * std::pow(h, 5)) : std::pow(h, 4);
  };
  const auto seen = observe_order(error, end_times, 1e-16);
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 4, 1e-6);
  EXPECT_NE(seen.t_end, 2);
}

TEST(ObservedOrder, IsAbsentWithoutErrorsOrWithRunsThatFailed) {
  EXPECT_FALSE(observe_order([](double, double) { return 0.0; }, end_times, 1e-16).observed);
  EXPECT_FALSE(observe_order([](double, double) { return std::nan(""); }, end_times, 1e-16).observed);
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(observe_order([=](double, double) { return infinite; }, end_times, 1e-16).observed);
}

// An order that is lost must be seen: this is what makes the check of `hmax order` able to fail.
TEST(ObservedOrder, SeesAMethodThatLostItsOrder) {
  const auto seen = observe_order([](double, double h) { return std::pow(h, 4) + 1e-3 * std::pow(h, 3); },
                                  end_times, 1e-17);
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 3, 0.2);
}

}  // namespace
}  // namespace hmax
