#include "analysis/dynamics/growth.hpp"

#include <cmath>
#include <complex>
#include <functional>
#include <vector>

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

TEST(ObservedLimit, TakesNoMoreStepsThanGrowthNeedsToOvertakeWhatFadesSlowly) {
  // Beyond h = 2 a motion grows as the square root of the distance, from exp(-30) beside one that loses 0.25
  // % a step: to wait until exp(-37) is left of that would take 59,000 steps.
  const auto growth = [](double h) { return h < 2 ? -1e-3 : 2 * std::sqrt(h / 2 - 1); };
  const ShowSteps run = [&](double h, std::int64_t steps, const auto& show) {
    for (std::int64_t n = 0; n <= steps; ++n) {
      const double k = static_cast<double>(n);
      show(Eigen::VectorXd::Constant(1, std::exp(growth(h) * k - 30) + std::exp(-0.0025 * k)));
    }
    return true;
  };
  const ExpectedGrowth expected{.above = growth(2.002), .close = growth(2 * 1.00008), .beside = -0.0025};
  EXPECT_LT(steps_to_see(expected), 2100);
  EXPECT_GE(steps_to_see({.above = growth(2.002), .close = 0, .beside = -0.0025}), 7000)
      << "without its slope at the limit";
  const ObservedLimit limit = observe_limit(run, size, 2, expected);
  EXPECT_TRUE(limit.below_decays && limit.above_grows);
  EXPECT_LT(limit.steps, 2100);
  EXPECT_NEAR(limit.h, 2, 2e-4);
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

TEST(ObservedGrowth, DoesNotCountTheJumpOfAFirstStep) {
  const ShowSteps jumps = [](double, std::int64_t steps, const auto& show) {
    show(Eigen::VectorXd::Constant(1, 1e-9));
    for (std::int64_t n = 1; n <= steps; ++n)
      show(Eigen::VectorXd::Constant(1, std::pow(0.99, static_cast<double>(n))));
    return true;
  };
  EXPECT_LT(observed_growth(jumps, size, 1, 512), 0);
}

TEST(GrowsAt, DoesNotCountWhatGrowsInProportionToTime) {
  const ShowSteps line = [](double, std::int64_t steps, const auto& show) {
    for (std::int64_t n = 0; n <= steps; ++n) show(Eigen::VectorXd::Constant(1, static_cast<double>(n + 1)));
    return true;
  };
  EXPECT_FALSE(grows_at(line, size, 1));
  EXPECT_TRUE(grows_at(powers([](double) { return 1.001; }), size, 1));
}

TEST(ObservedLimit, IsSeenBehindAMotionThatFadesSlowly) {
  const ShowSteps run = [](double h, std::int64_t steps, const auto& show) {
    for (std::int64_t n = 0; n <= steps; ++n) {
      const auto k = static_cast<double>(n);
      show(Eigen::VectorXd::Constant(1, std::pow(0.996, k) + 1e-3 * std::pow(1 + 2.5 * (h - 2), k)));
    }
    return true;
  };
  const ObservedLimit limit = observe_limit(run, size, 2, {.above = 5e-3, .beside = -1});
  EXPECT_TRUE(limit.below_decays && limit.above_grows);
  EXPECT_NEAR(limit.h, 2, 1e-3);
  EXPECT_GT(limit.steps, 512);
}

TEST(WithoutRoots, LeavesWhatStepsMultiplyByAnotherRoot) {
  const std::complex<double> root = std::polar(0.98, 0.4);
  const auto three_motions = [&](double, std::int64_t steps, const auto& show) {
    Eigen::VectorXd y(1);
    for (std::int64_t n = 0; n <= steps; ++n) {
      y[0] = 7 + std::pow(root, n).real() + 50 * std::pow(0.9999, n) + 1e-6 * std::pow(-1.01, n);
      show(y);
    }
    return true;
  };
  std::vector<double> left;
  const ShowSteps filtered = without_roots(three_motions, Eigen::VectorXd::Constant(1, 7), [&](double) {
    return std::vector<std::complex<double>>{root, std::conj(root), 0.9999};
  });
  EXPECT_TRUE(
      filtered(0.1, 100, [&](const Eigen::Ref<const Eigen::VectorXd>& y) { left.push_back(y[0] - 7); }));
  ASSERT_EQ(left.size(), 101U);
  for (std::size_t n = 1; n < left.size(); ++n) EXPECT_NEAR(left[n] / left[n - 1], -1.01, 1e-7) << n;
}

/// What symplectic Euler makes of q'' = -q and, as little of it as rounding leaves, of q'' = -9 q.
bool symplectic_steps(double h, std::int64_t steps,
                      const std::function<void(const Eigen::Ref<const Eigen::VectorXd>&)>& show) {
  Eigen::VectorXd y(4);
  y << 1, 1e-14, 0.3, 1e-14;
  for (std::int64_t n = 0; n <= steps; ++n) {
    show(y);
    y.tail(2) -= h * Eigen::Vector2d(1, 9).cwiseProduct(y.head(2));
    y.head(2) += h * y.tail(2);
  }
  return true;
}
const MotionOf first_of_two = [](const Eigen::Ref<const Eigen::VectorXd>& y) {
  return Eigen::Vector2d(y[0], y[2]);
};

TEST(GrowthOfRecurrence, TellsBothSidesOfALimitInADozenSteps) {
  // zeta^2 - (2 - h^2) zeta + 1.
  for (const double h : {0.5, 1.99, 1.9999}) {
    const auto growth = growth_of_recurrence(symplectic_steps, first_of_two, 2, h, 12);
    ASSERT_TRUE(growth) << h;
    EXPECT_NEAR(*growth, 0, 1e-9) << h;
  }
  for (const double h : {2.0001, 2.01, 2.5}) {
    const auto growth = growth_of_recurrence(symplectic_steps, first_of_two, 2, h, 12);
    ASSERT_TRUE(growth) << h;
    EXPECT_NEAR(*growth, 2 * std::acosh(h / 2), 1e-6) << h;
  }
  // A degree too many leaves a root that nothing is seen of.
  EXPECT_NEAR(growth_of_recurrence(symplectic_steps, first_of_two, 3, 2.01, 18).value(),
              2 * std::acosh(1.005), 1e-6);
}

TEST(GrowthOfRecurrence, SaysNothingOfWhatObeysNone) {
  const MotionOf both = [](const Eigen::Ref<const Eigen::VectorXd>& y) {
    return Eigen::Vector2d(y[0] + 1e13 * y[1], y[2]);
  };
  EXPECT_FALSE(growth_of_recurrence(symplectic_steps, both, 2, 0.5, 12));
  const ShowSteps stops = [](double h, std::int64_t, const auto& show) {
    symplectic_steps(h, 5, show);
    return false;
  };
  EXPECT_TRUE(std::isinf(growth_of_recurrence(stops, first_of_two, 2, 0.5, 12).value()));
}

TEST(ObservedLimit, IsFoundWhereGrowthIsSlowAndAlone) {
  int runs = 0;
  const ShowSteps slow = [&](double h, std::int64_t steps, const auto& show) {
    ++runs;
    return powers([](double step) { return 1 + 5e-5 * (step - 2); })(h, steps, show);
  };
  const ObservedLimit limit =
      observe_limit(slow, size, 2, {.above = 1e-7, .beside = -1, .visible = 1e-5, .fall = 20});
  EXPECT_TRUE(limit.below_decays && limit.above_grows);
  EXPECT_NEAR(limit.h, 2, 3e-4);
  EXPECT_LE(limit.steps, 3000);
  // Halving two thousandths down to a millionth would take eleven.
  EXPECT_LE(runs, 6);
}

TEST(ObservedGrowth, IsThatOfHalfARunWhateverTheUnit) {
  constexpr std::int64_t steps = 512;
  for (const double unit : {1e-12, 1.0, 1e12})
    for (const double r : {0.99, 1.0, 1.01}) {
      const ShowSteps run = [=](double, std::int64_t n, const auto& show) {
        for (std::int64_t k = 0; k <= n; ++k)
          show(Eigen::VectorXd::Constant(1, unit * std::pow(r, static_cast<double>(k))));
        return true;
      };
      EXPECT_NEAR(observed_growth(run, size, 1, steps), steps / 2 * std::log(r), 1e-10) << unit << " " << r;
    }
}

TEST(ObservedGrowth, CountsWhatIsFarOutFromTheFirstQuarterOn) {
  for (const double unit : {1e-12, 1.0, 1e12})
    for (const double far : {1e2, 1e6}) {
      const ShowSteps run = [=](double, std::int64_t n, const auto& show) {
        for (std::int64_t k = 0; k <= n; ++k) show(Eigen::VectorXd::Constant(1, k <= 1 ? unit : far * unit));
        return true;
      };
      EXPECT_NEAR(observed_growth(run, size, 1, 512), far > 1e4 ? std::log(far) : 0, 1e-12)
          << unit << " " << far;
    }
}

TEST(ObservedGrowth, OfLessThanTheNoiseIsNone) {
  // From 1 to 1e-12 at once, then 1.1 times a step: what is below the noise of 1e-6 has not grown.
  const ShowSteps run = [](double, std::int64_t n, const auto& show) {
    for (std::int64_t k = 0; k <= n; ++k)
      show(Eigen::VectorXd::Constant(1, k <= 1 ? 1 : 1e-12 * std::pow(1.1, static_cast<double>(k))));
    return true;
  };
  EXPECT_NEAR(observed_growth(run, size, 1, 100), 50 * std::log(1.1), 1e-10);
  EXPECT_NEAR(observed_growth(run, size, 1, 100, 1e-6), std::log(1e-6 * std::pow(1.1, 100)), 1e-10);
}

}  // namespace
}  // namespace hmax
