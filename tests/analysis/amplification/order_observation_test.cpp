#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "analysis/amplification/order.hpp"

namespace hmax {
namespace {

constexpr std::array end_times{1.0, 2.0, 5.0};

TEST(ObservedOrder, IsTheExponentOfAPowerLaw) {
  const auto seen = observe_order([](double, double h) { return 3 * std::pow(h, 2.5); }, end_times, {1e-16});
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 2.5, 1e-9);
}

TEST(ObservedOrder, KeepsAwayFromRounding) {
  const auto seen =
      observe_order([](double, double h) { return std::pow(h, 8) + 1e-17; }, end_times, {1e-14});
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 8, 0.01);
  for (const double error : seen.error) EXPECT_GT(error, 1e-14);
}

TEST(ObservedOrder, AvoidsATimeAtWhichTheLeadingTermVanishes) {
  const auto error = [](double t, double h) {
    return t == 2 ? std::abs(std::pow(h, 4) - 300 * std::pow(h, 5)) : std::pow(h, 4);
  };
  const auto seen = observe_order(error, end_times, {1e-16});
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 4, 1e-6);
  EXPECT_NE(seen.t_end, 2);
}

TEST(ObservedOrder, IsAbsentWithoutErrorsOrWithRunsThatFailed) {
  EXPECT_FALSE(observe_order([](double, double) { return 0.0; }, end_times, {1e-16}).observed);
  EXPECT_FALSE(observe_order([](double, double) { return std::nan(""); }, end_times, {1e-16}).observed);
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(observe_order([=](double, double) { return infinite; }, end_times, {1e-16}).observed);
}

// An order that is lost must be seen: this is what makes the check of `hmax order` able to fail.
TEST(ObservedOrder, SeesAMethodThatLostItsOrder) {
  const auto seen = observe_order([](double, double h) { return std::pow(h, 4) + 1e-3 * std::pow(h, 3); },
                                  end_times, {1e-17});
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 3, 0.2);
}

/// |R(z)|^n of rk4 on y' = -1000 y: grows where h > 2.785e-3, and is e^-1000 below.
TEST(ObservedOrder, IsAbsentWhereRunsDivergeDownToRounding) {
  const auto error = [](double t, double h) {
    const double z = -1000 * h, R = 1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)));
    return std::abs(std::pow(R, std::round(t / h)) - std::exp(-1000 * t));
  };
  const auto seen = observe_order(error, end_times, {1e-14, 1});
  EXPECT_FALSE(seen.observed);
  EXPECT_EQ(seen.lack, OrderLack::narrow);
  ASSERT_TRUE(seen.h_diverged && seen.h_rounded);
  EXPECT_GT(*seen.h_diverged, 2.785e-3);
  EXPECT_LT(*seen.h_rounded, 2.785e-3);
}

TEST(ObservedOrder, TakesNoPartOfARoundingPlateauAboveTheFloor) {
  // Noise of 1e-9 with both signs of slope, as of equations that are solved to a tolerance.
  const auto error = [](double t, double h) {
    return std::pow(h, 2) + 1e-9 * (1.5 + std::sin(40 * std::log(h) + t));
  };
  const auto seen = observe_order(error, end_times, {1e-16, 1});
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 2, 0.1);
  // Nothing but noise.
  const auto noise =
      observe_order([&](double t, double h) { return error(t, 1e-6 * h); }, end_times, {1e-16, 1});
  EXPECT_FALSE(noise.observed);
  EXPECT_EQ(noise.lack, OrderLack::rounded);
}

TEST(ObservedOrder, IsAbsentWhereErrorsAreAsLargeAsTheSolution) {
  // A power law all the same: of a motion in phase, that misses the solution by more than its size.
  const auto seen = observe_order([](double, double h) { return 1e6 * h; }, end_times, {1e-16, 1});
  EXPECT_FALSE(seen.observed);
  EXPECT_EQ(seen.lack, OrderLack::diverged);
}

TEST(ObservedOrder, IsAbsentWhereTheErrorDoesNotFall) {
  const auto seen = observe_order([](double, double h) { return 0.01 + h * h; }, end_times, {1e-16, 1});
  EXPECT_FALSE(seen.observed);
  EXPECT_EQ(seen.lack, OrderLack::stalled);
}

TEST(ObservedOrder, IsAbsentBeforeTheAsymptoticRange) {
  // exp(-c / h) has the slope c / h, which grows from step to step, as terms do that die out.
  constexpr std::array one{1.0};
  const auto seen = observe_order([](double, double h) { return std::exp(-0.01 / h); }, one, {1e-16}, 200);
  EXPECT_FALSE(seen.observed);
  EXPECT_EQ(seen.lack, OrderLack::not_asymptotic);
}

/// Rounding of a method that neither a floor nor a plateau tells: each finer step still lowers the error.
TEST(ObservedOrder, TakesNoPartOfErrorsThatScatter) {
  const auto error = [](double t, double h) {
    const auto steps = static_cast<int>(std::round(t / h));
    const double rounding = steps == 11585 ? 1.3 : steps == 16384 ? -0.4 : 0;
    return std::pow(h / t, 4) * (1 + 1e4 * h * h) + 1e-16 * std::abs(rounding);
  };
  const auto seen = observe_order(error, std::array{1.0}, {1e-18, 1});
  ASSERT_TRUE(seen.observed);
  EXPECT_NEAR(*seen.observed, 4, 0.05);
  EXPECT_GT(seen.error.back(), 1e-15);
  ASSERT_TRUE(seen.h_rounded);
}

}  // namespace
}  // namespace hmax
