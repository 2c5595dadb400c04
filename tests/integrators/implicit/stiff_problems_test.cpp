/// Stiff problems with published end points by the adaptive implicit methods, and what they do when equations
/// cannot be solved.
#include <cmath>
#include <limits>

#include "integrators/stats.hpp"
#include "problems/test_set/hires.hpp"
#include "problems/test_set/oregonator.hpp"
#include "problems/test_set/robertson.hpp"
#include "problems/test_set/van_der_pol.hpp"
#include "tests/integrators/implicit_methods.hpp"

namespace hmax {
namespace {

template <class Method>
struct Stiff : testing::Test {};
TYPED_TEST_SUITE(Stiff, EveryAdaptiveImplicitMethod, MethodId);

/// The error at the end of the problem, max_i |y_i - exact_i| / (atol / rtol + |exact_i|).
template <class Method, class Problem>
double relative_error(double rtol, double atol) {
  using State = typename Problem::State;
  State y = Problem::y0();
  const auto end = integrate(
      typename Method::template Stepper<State>{}, ErasedSystem(Problem()), Span<double>{0, Problem::t_end}, y,
      Adaptive<double, DeadbandController>({rtol, atol}, Method::error_order), ObserveNothing{}, 1'000'000);
  EXPECT_EQ(end.outcome, Outcome::reached_end) << "t = " << end.t;
  double worst = 0;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const auto exact = static_cast<double>(Problem::end_point[static_cast<std::size_t>(i)]);
    worst = std::max(worst, std::abs(y[i] - exact) / (atol / rtol + std::abs(exact)));
  }
  return worst;
}

// Local errors are controlled; the bounds are what the problems make of them. Jumps and pulses shift in time,
// and the lower the order, the more errors add up. Methods of low order are asked for less.
template <class Method>
constexpr double rtol_of = Method::order == 1   ? 1e-4
                           : Method::order == 2 ? 1e-5
                                                : 1e-7;
template <class Method>
constexpr double bound_of = Method::order == 1   ? 5e-2
                            : Method::order == 2 ? 1e-2
                                                 : 3e-5;

TYPED_TEST(Stiff, VanDerPol) {
  constexpr double rtol = rtol_of<TypeParam>;
  EXPECT_LT((relative_error<TypeParam, VanDerPol<double>>(rtol, 1e-3 * rtol)), bound_of<TypeParam>);
}
TYPED_TEST(Stiff, Robertson) {
  constexpr double rtol = rtol_of<TypeParam>;
  if constexpr (!TypeParam::l_stable) {
    // What is tiny and stiff rings on undamped and stops the steps from growing: the end at 1e11 s is out of
    // reach.
    Eigen::Vector3d y = Robertson<double>::y0();
    const auto end =
        integrate(typename TypeParam::template Stepper<Eigen::Vector3d>{}, ErasedSystem(Robertson<double>()),
                  Span<double>{0, 40}, y,
                  Adaptive<double, DeadbandController>({rtol, 1e-9 * rtol}, TypeParam::error_order),
                  ObserveNothing{}, 100'000);
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    // [hairer1996solving, IV.10] prints the end point at t = 40.
    EXPECT_NEAR(y[0], 0.7158271, 1e-4);
    return;
  }
  EXPECT_LT((relative_error<TypeParam, Robertson<double>>(rtol, 1e-9 * rtol)), bound_of<TypeParam>);
}
TYPED_TEST(Stiff, Hires) {
  constexpr double rtol = rtol_of<TypeParam>;
  EXPECT_LT((relative_error<TypeParam, Hires<double>>(rtol, 1e-3 * rtol)), bound_of<TypeParam>);
}
TYPED_TEST(Stiff, Oregonator) {
  // At 1e-4 implicit Euler's pulse comes so late that a third of the end value is missing.
  constexpr double rtol = TypeParam::order == 1 ? 1e-6 : rtol_of<TypeParam>;
  EXPECT_LT((relative_error<TypeParam, Oregonator<double>>(rtol, 1e-3 * rtol)), bound_of<TypeParam>);
}

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
                               ErasedSystem(WrongJacobian{factor}), Span<double>{0, 1}, y,
                               Adaptive<double, DeadbandController>({1e-5, 1e-5}, TypeParam::error_order),
                               ObserveNothing{}, 100'000);
    if (end.outcome == Outcome::reached_end) {
      EXPECT_NEAR(y[0], std::cos(1.0), 2e-3);
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
