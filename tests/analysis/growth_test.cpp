#include "analysis/growth.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// y_n = r(h)^n
ShowSteps powers(double (*r)(double h)) {
  return [r](double h, std::int64_t steps, const auto& show) {
    Eigen::VectorXd y = Eigen::VectorXd::Ones(1);
    for (std::int64_t n = 0; n <= steps; ++n) {
      show(y);
      y *= r(h);
    }
    return true;
  };
}
const Distance size = [](const Eigen::Ref<const Eigen::VectorXd>& y) { return y.norm(); };
const ExpectedGrowth some{.above = 1e-3, .beside = -1, .linear = false};

TEST(ObservedLimit, IsWhereTheFactorPassesOneWhateverWasPredicted) {
  const ShowSteps run = powers([](double h) { return 1 + 0.1 * (h - 2); });
  for (const double predicted : {2.0, 1.2, 3.5}) {
    const ObservedLimit limit = observe_limit(run, size, predicted, some);
    EXPECT_NEAR(limit.h, 2, 1e-3) << predicted;
    EXPECT_EQ(limit.below_decays && limit.above_grows, predicted == 2) << predicted;
  }
}

TEST(ObservedLimit, SaysThatNothingEverGrowsOrEverythingDoes) {
  EXPECT_TRUE(std::isinf(observe_limit(powers([](double) { return 0.99; }), size, 2, some).h));
  EXPECT_EQ(observe_limit(powers([](double) { return 1.01; }), size, 2, some).h, 0);
}

TEST(ObservedGrowth, CountsARunThatBreaksDownAsGrowth) {
  const ShowSteps stops = [](double, std::int64_t, const auto& show) {
    show(Eigen::VectorXd::Ones(1));
    return true;
  };
  EXPECT_TRUE(std::isinf(observed_growth(stops, size, 1, 100)));
  const ShowSteps not_a_number = powers([](double) { return std::nan(""); });
  EXPECT_TRUE(std::isinf(observed_growth(not_a_number, size, 1, 100)));
}

TEST(GrowsAt, DoesNotCountWhatGrowsInProportionToTime) {
  const ShowSteps line = [](double, std::int64_t steps, const auto& show) {
    for (std::int64_t n = 0; n <= steps; ++n) show(Eigen::VectorXd::Constant(1, static_cast<double>(n + 1)));
    return true;
  };
  EXPECT_FALSE(grows_at(line, size, 1));
  EXPECT_TRUE(grows_at(powers([](double) { return 1.001; }), size, 1));
}

}  // namespace
}  // namespace hmax
