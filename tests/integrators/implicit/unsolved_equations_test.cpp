/// What the adaptive implicit methods do where equations cannot be solved.
/// tests/catalogue/methods/stiff_problems_test.cpp compares them with published end points.
#include <cmath>

#include "integrators/stats.hpp"
#include "tests/integrators/implicit_methods.hpp"

namespace hmax {
namespace {

template <class Method>
struct Stiff : testing::Test {};
TYPED_TEST_SUITE(Stiff, EveryAdaptiveImplicitMethod, MethodId);

/// Stiff decay towards cos t with a Jacobian that is `factor` times the true one.
struct WrongJacobian {
  using State = Eigen::Vector2d;
  double factor;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(double t, const State& y, State& dydt) const {
    dydt[0] = -1e4 * (y[0] - std::cos(t));
    dydt[1] = y[0] - y[1];
  }
  void jacobian(double, const State&, Eigen::Matrix2d& J) const { J << -1e4 * factor, 0, factor, -factor; }
};

TYPED_TEST(Stiff, AWrongJacobianIsNoticedAndNeverGivesAWrongAnswer) {
  const auto run = [](double factor) {
    Eigen::Vector2d y(0, 0);
    const auto end = integrate(typename TypeParam::template Stepper<Eigen::Vector2d>{},
                               ErasedSystem(WrongJacobian{factor}), Span<double>{0, 0.1}, y,
                               Adaptive<double, DeadbandController>({1e-5, 1e-5}, TypeParam::error_order),
                               ObserveNothing{}, 20'000);
    if (end.outcome == Outcome::reached_end) {
      EXPECT_NEAR(y[0], std::cos(0.1), 2e-3);
    }
    return end;
  };
  const auto exact = run(1);
  EXPECT_EQ(exact.outcome, Outcome::reached_end);
  // Steps are cut until the iteration converges in spite of the Jacobian: h < 1 / 1e4.
  for (const double factor : {0.0, -1.0, 1e6})
    EXPECT_GT(run(factor).stats.rejected, exact.stats.rejected) << factor;
}

TYPED_TEST(Stiff, AWrongJacobianFailsAFixedStepOrIsOvercome) {
  for (const double factor : {0.0, -1.0}) {
    Eigen::Vector2d y(0, 0);
    const auto end =
        integrate(typename TypeParam::template Stepper<Eigen::Vector2d>{},
                  ErasedSystem(WrongJacobian{factor}), Span<double>{0, 1}, y, FixedStep<double>(0.1));
    // The accelerated iteration of Radau's stages may converge in spite of the Jacobian.
    if (std::is_same_v<TypeParam, RadauMethod> && end.outcome == Outcome::reached_end) {
      EXPECT_NEAR(y[0], std::cos(1.0), 1e-3);
      EXPECT_NEAR(y[1], (std::cos(1.0) + std::sin(1.0) - std::exp(-1.0)) / 2, 1e-3);
    } else {
      EXPECT_EQ(end.outcome, Outcome::newton_failed);
      EXPECT_EQ(end.t, 0);
    }
  }
}

TYPED_TEST(Stiff, ARegionWithoutNumbersIsApproachedAndNotEntered) {
  // x' = -1 reaches zero at t = 1, where f ends: sqrt.
  const ErasedSystem system(system_of<Eigen::Vector2d>(
      [](double, const Eigen::Vector2d& y, Eigen::Vector2d& dydt) { dydt << -1, -std::sqrt(y[0]) - y[1]; }));
  Eigen::Vector2d y(1, 1);
  const auto end =
      integrate(typename TypeParam::template Stepper<Eigen::Vector2d>{}, system, Span<double>{0, 2}, y,
                Adaptive<double, DeadbandController>({1e-4, 1e-4}, TypeParam::error_order), ObserveNothing{},
                1'000'000);
  EXPECT_NE(end.outcome, Outcome::reached_end);
  EXPECT_NE(end.outcome, Outcome::too_many_steps);
  EXPECT_GT(end.t, 0.9);
  EXPECT_LT(end.t, 1 + 1e-9);
  EXPECT_TRUE(y.allFinite());
}

/// y' = y with h gamma = 1: the matrix I - h gamma J is exactly singular.
TYPED_TEST(Stiff, ASingularMatrixFailsAFixedStepAndCutsAnAdaptiveOne) {
  struct Growth {
    using State = Eigen::Vector2d;
    double rate;
    [[nodiscard]] static Eigen::Index dim() { return 2; }
    void rhs(double, const State& y, State& dydt) const { dydt = rate * y; }
    void jacobian(double, const State&, Eigen::Matrix2d& J) const { J << rate, 0, 0, rate; }
  };
  constexpr double gamma = [] {
    if constexpr (TypeParam::order == 5)
      return 0.25;  // not an eigenvalue of Radau's matrix: that step is simply made
    else
      return static_cast<double>(TypeParam::tableau.a.back().back());
  }();
  Eigen::Vector2d y(1, 1);
  const auto fixed = integrate(typename TypeParam::template Stepper<Eigen::Vector2d>{},
                               ErasedSystem(Growth{1 / gamma}), Span<double>{0, 1}, y, FixedStep<double>(1));
  EXPECT_EQ(fixed.outcome, TypeParam::order == 5 ? Outcome::reached_end : Outcome::newton_failed);
  y.setOnes();
  const auto adaptive = integrate(
      typename TypeParam::template Stepper<Eigen::Vector2d>{}, ErasedSystem(Growth{1 / gamma}),
      Span<double>{0, 1}, y, Adaptive<double, DeadbandController>({1e-5, 1e-5, 1}, TypeParam::error_order));
  EXPECT_EQ(adaptive.outcome, Outcome::reached_end);
  EXPECT_GT(adaptive.stats.rejected, 0);
  EXPECT_NEAR(y[0] / std::exp(1 / gamma), 1, 0.02);
}

}  // namespace
}  // namespace hmax
