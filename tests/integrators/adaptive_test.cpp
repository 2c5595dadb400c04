/// Steps steered by the error: tolerance proportionality, and clear ends of runs that cannot go on.
#include <algorithm>
#include <cmath>
#include <limits>

#include "integrators/integrate.hpp"
#include "problems/oscillator/oscillator_reference.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using One = Eigen::Matrix<double, 1, 1>;
using tableaux::BogackiShampine32;
using tableaux::Dop853;
using tableaux::DormandPrince54;
using tableaux::Fehlberg78;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class Real>
using RmsDeadband = Adaptive<Real, DeadbandController>;
template <class Real>
using RmsIntegral = Adaptive<Real, IntegralController>;
template <class Real>
using RmsPi = Adaptive<Real, PiController>;
template <class Real>
using Matlab = Adaptive<Real, MatlabController, MatlabNorm>;

template <class Control>
struct EveryControl : testing::Test {};
using Controls = testing::Types<RmsDeadband<double>, RmsIntegral<double>, RmsPi<double>, Matlab<double>>;
TYPED_TEST_SUITE(EveryControl, Controls);

/// A run of Dormand-Prince under the given control, with a budget no sound run needs.
template <class Control, class State, class System>
RunEnd<double> run(const System& system, Span<double> span, State& y, Tolerances<double> tolerances) {
  return integrate(Rk<DormandPrince54, State>{}, system, span, y, Control(tolerances, 5), ObserveNothing{},
                   100'000);
}

TYPED_TEST(EveryControl, KeepsTheErrorInProportionToTheTolerance) {
  const OscillatorReference reference({}, {0.5, 1}, 20);
  const Eigen::Vector2d exact = reference.at(20);
  double before = 1;
  for (double tolerance = 1e-3; tolerance > 1e-12; tolerance /= 10) {
    Eigen::Vector2d y(0.5, 1);
    const auto end = run<TypeParam>(Oscillator(), {0, 20}, y, {tolerance, tolerance});
    const double error = (y - exact).norm();
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_EQ(end.t, 20);
    EXPECT_LT(error, 10 * tolerance);
    EXPECT_GT(error, 1e-4 * tolerance) << "far more accurate than asked for";
    EXPECT_LT(error, before) << tolerance;
    EXPECT_LT(end.stats.rejected, end.stats.steps / 2 + 2);
    before = error;
  }
}

TYPED_TEST(EveryControl, WeighsTheErrorRelativeToTheState) {
  // y' = y / 2 over 40 time units grows by e^20: with atol = 0 the relative error counts, at every scale.
  const auto growth = system_of<One>([](double, const One& y, One& dydt) { dydt[0] = y[0] / 2; });
  for (const double start : {1e-30, 1.0, 1e30}) {
    One y(start);
    EXPECT_EQ(run<TypeParam>(growth, {0, 40}, y, {1e-8, 1e-300}).outcome, Outcome::reached_end);
    EXPECT_NEAR(y[0] / start / std::exp(20.0), 1, 1e-6) << start;
  }
}

TYPED_TEST(EveryControl, EndsWhereTheRightHandSideIsNotANumber) {
  const auto wall = system_of<One>([](double t, const One&, One& dydt) { dydt[0] = t < 1 ? 1 : nan; });
  One y(0.0);
  const auto end = run<TypeParam>(wall, {0, 2}, y, {1e-6, 1e-6});
  EXPECT_EQ(end.outcome, Outcome::step_too_small);
  EXPECT_NEAR(end.t, 1, 1e-12);
  EXPECT_LE(end.t, 1);
  EXPECT_NEAR(y[0], end.t, 1e-12) << "the last good state";
}

TYPED_TEST(EveryControl, EndsAtOnceWhereNothingIsANumber) {
  const auto broken = system_of<One>([](double, const One&, One& dydt) { dydt[0] = nan; });
  for (const double t0 : {0.0, 1.0}) {
    One y(7.0);
    const auto end = run<TypeParam>(broken, {t0, t0 + 2}, y, {1e-6, 1e-6});
    EXPECT_EQ(end.outcome, Outcome::step_too_small);
    EXPECT_EQ(end.t, t0);
    EXPECT_EQ(y[0], 7);
    EXPECT_LT(end.stats.rejected, 2000);
  }
}

TYPED_TEST(EveryControl, PassesAJump) {
  // y' = 1 before t = 1 / 3, then -2: the end value is 1 / 3 - 4 / 3.
  const auto jump = system_of<One>([](double t, const One&, One& dydt) { dydt[0] = 3 * t < 1 ? 1 : -2; });
  One y(0.0);
  const auto end = run<TypeParam>(jump, {0, 1}, y, {1e-6, 1e-6});
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  EXPECT_NEAR(y[0], -1, 1e-4);
  EXPECT_LT(end.stats.steps + end.stats.rejected, 300);
}

TYPED_TEST(EveryControl, EndsAtABlowUp) {
  // y' = y^2, y(t0) = 1: y = 1 / (1 - (t - t0)).
  const auto blow_up = system_of<One>([](double, const One& y, One& dydt) { dydt[0] = y[0] * y[0]; });
  for (const double t0 : {-1.0, 0.0, 1000.0}) {
    One y(1.0);
    const auto end = run<TypeParam>(blow_up, {t0, t0 + 2}, y, {1e-6, 1e-6});
    EXPECT_TRUE(end.outcome == Outcome::step_too_small || end.outcome == Outcome::diverged)
        << t0 << ' ' << to_string(end.outcome);
    EXPECT_NEAR(end.t, t0 + 1, 1e-4) << t0;
    EXPECT_TRUE(std::isfinite(y[0]));
  }
}

TYPED_TEST(EveryControl, TakesOneStepOverOneUlp) {
  for (const double t0 : {1.0, 1e6}) {
    const double t_end = std::nextafter(t0, 1e9);
    One y(1.0);
    const auto decay = system_of<One>([](double, const One& state, One& dydt) { dydt[0] = -state[0]; });
    const auto end = run<TypeParam>(decay, {t0, t_end}, y, {1e-6, 1e-6});
    EXPECT_EQ(end.outcome, Outcome::reached_end) << t0;
    EXPECT_EQ(end.t, t_end);
    EXPECT_EQ(end.stats.steps, 1);
  }
}

TYPED_TEST(EveryControl, SaysWhenStepsNoLongerChangeTheTime) {
  // An oscillation of angular frequency 1e18 at t = 1 asks for steps below the resolution of time.
  const auto fast = system_of<Eigen::Vector2d>([](double, const Eigen::Vector2d& y, Eigen::Vector2d& dydt) {
    dydt[0] = 1e18 * y[1];
    dydt[1] = -1e18 * y[0];
  });
  Eigen::Vector2d y(1, 0);
  EXPECT_EQ(run<TypeParam>(fast, {1, 2}, y, {1e-6, 1e-6}).outcome, Outcome::step_too_small);
}

TYPED_TEST(EveryControl, LivesWithExtremeTolerances) {
  for (const double tolerance : {1.0, 1e-15}) {
    Eigen::Vector2d y(0.5, 1);
    const auto end = run<TypeParam>(Oscillator(), {0, 10}, y, {tolerance, tolerance});
    EXPECT_EQ(end.outcome, Outcome::reached_end) << tolerance;
    EXPECT_LT((y - OscillatorReference({}, {0.5, 1}, 10).at(10)).norm(), std::max(5e-13, 10 * tolerance));
  }
}

TYPED_TEST(EveryControl, KeepsToTheLargestStepAllowed) {
  const auto still = system_of<One>([](double, const One&, One& dydt) { dydt[0] = 0; });
  One y(1.0);
  Tolerances<double> tolerances{1e-6, 1e-6};
  tolerances.h_max = 0.25;
  tolerances.h_first = 10;
  const auto end = run<TypeParam>(still, {0, 10}, y, tolerances);
  EXPECT_EQ(end.stats.steps, 40);
}

TYPED_TEST(EveryControl, RunsTwiceToTheSameBits) {
  Eigen::Vector2d first(0.5, 1), second(0.5, 1);
  const auto one = run<TypeParam>(Oscillator(), {0, 10}, first, {1e-7, 1e-7});
  const auto two = run<TypeParam>(Oscillator(), {0, 10}, second, {1e-7, 1e-7});
  EXPECT_EQ(first, second);
  EXPECT_EQ(one.stats.steps, two.stats.steps);
}

template <class Method>
struct EveryPair : testing::Test {};
using Pairs = testing::Types<BogackiShampine32, DormandPrince54, tableaux::Tsitouras54, Fehlberg78, Dop853>;
TYPED_TEST_SUITE(EveryPair, Pairs, MethodId);

TYPED_TEST(EveryPair, ReachesItsTolerance) {
  const Eigen::Vector2d exact = OscillatorReference({}, {0.5, 1}, 20).at(20);
  for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
    Eigen::Vector2d y(0.5, 1);
    const auto end = integrate(Rk<TypeParam, Eigen::Vector2d>{}, Oscillator(), Span<double>{0, 20}, y,
                               RmsPi<double>({tolerance, tolerance}, TypeParam::error_order));
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    EXPECT_LT((y - exact).norm(), 10 * tolerance);
  }
}

TEST(Dop853, AgreesWithThePublishedEndStateToTheLastDigits) {
  Eigen::Vector2d y(0.5, 1);
  integrate(Rk<Dop853, Eigen::Vector2d>{}, Oscillator(), Span<double>{0, 10}, y,
            RmsPi<double>({1e-13, 1e-13}, Dop853::error_order));
  // By a Taylor series in 128 bits.
  EXPECT_NEAR(y[0], -3.3690941329057441755e-01, 1e-11);
  EXPECT_NEAR(y[1], 1.5203434594206605961e-01, 1e-11);
}

}  // namespace
}  // namespace hmax
