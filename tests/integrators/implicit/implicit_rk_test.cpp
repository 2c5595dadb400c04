/// Diagonally implicit methods and Radau IIA: order, stability, error estimate, continuous output, counts.
#include <cmath>
#include <random>
#include <vector>

#include "integrators/stats.hpp"
#include "problems/oscillator/oscillator.hpp"
#include "tests/integrators/implicit_methods.hpp"
#include "tests/integrators/rejected_attempts.hpp"
#include "tests/integrators/stability_function.hpp"

namespace hmax {
namespace {

using State = Eigen::Vector2d;

template <class Method>
struct ImplicitRk : testing::Test {};
TYPED_TEST_SUITE(ImplicitRk, EveryImplicitMethod, MethodId);
template <class Method>
struct AdaptiveImplicitRk : testing::Test {};
TYPED_TEST_SUITE(AdaptiveImplicitRk, EveryAdaptiveImplicitMethod, MethodId);

TYPED_TEST(ImplicitRk, IsExactForQuadratureUpToItsOrder) {
  const ErasedSystem system(system_of<State>([](double t, const State&, State& dydt) {
    dydt << TypeParam::order * std::pow(t, TypeParam::order - 1), 1;
  }));
  State y(0, 0);
  integrate(typename TypeParam::template Stepper<State>{}, system, Span<double>{0, 2}, y,
            FixedStep<double>(0.5));
  EXPECT_NEAR(y[0], std::pow(2, TypeParam::order), 1e-6);  // differences for J, which is zero
  EXPECT_NEAR(y[1], 2, 1e-13);
}

TYPED_TEST(ImplicitRk, StepsAsItsStabilityFunctionSays) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(-3, 3), size(-2, 2);
  for (int sample = 0; sample < 200; ++sample) {
    std::complex<double> z(part(random), part(random));
    z *= std::pow(10, size(random));
    if (z.real() > 0) z = -z;
    const ErasedSystem system(RotatingDecay{z});
    const auto step = first_step<typename TypeParam::template Stepper<State>>(system, 0, State(1, 0), 1);
    ASSERT_EQ(step.status, StepStatus::ok);
    const std::complex<double> R(stability_function(TypeParam::tableau, z));
    EXPECT_LT(std::abs(R - std::complex<double>(step.y_new[0], step.y_new[1])), 1e-13) << z;
  }
}

/// The full liver model at t = 10; digits of a Taylor series in 128 bits.
const State reference(-3.3690941329057441755e-01, 1.5203434594206605961e-01);

TYPED_TEST(ImplicitRk, HasItsOrder) {
  const auto error = [](double h) {
    State y(0.5, 1);
    const auto end = integrate(typename TypeParam::template Stepper<State>{}, ErasedSystem(Oscillator()),
                               Span<double>{0, 10}, y, FixedStep<double>(h));
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    return (y - reference).norm();
  };
  EXPECT_NEAR(std::log2(error(0.1) / error(0.05)), TypeParam::order, 0.1);
}

/// Norm of the error estimate of the second step of size h; the first is one of size h too.
template <class Method>
double second_estimate(double h) {
  const ErasedSystem system(Oscillator{});
  typename Method::template Stepper<State> stepper;
  State y(0.5, 1), y_new;
  stepper.init(system, 0, y);
  stepper.attempt(system, 0, y, h, y_new);
  stepper.accept(y_new);
  y = y_new;
  stepper.attempt(system, h, y, h, y_new);
  return std::sqrt(stepper.error_squared(h, y, y_new, Component{0}) +
                   stepper.error_squared(h, y, y_new, Component{1}));
}
template <class Method>
double first_estimate(double h) {
  const ErasedSystem system(Oscillator{});
  const auto step = first_step<typename Method::template Stepper<State>>(system, 0, State(0.5, 1), h);
  return std::hypot(step.error(Component{0}), step.error(Component{1}));
}

TYPED_TEST(AdaptiveImplicitRk, ErrorEstimateHasItsOrderFromTheFirstStepOn) {
  for (auto* estimate : {first_estimate<TypeParam>, second_estimate<TypeParam>})
    EXPECT_NEAR(std::log2(estimate(0.01) / estimate(0.005)), TypeParam::error_order, 0.1);
}

TEST(Trapezoidal, EstimatesItsLocalError) {
  // On a cubic quadrature the third derivative is constant: the estimate is h^3 y''' / 12, which is the
  // error.
  const ErasedSystem system(
      system_of<State>([](double t, const State&, State& dydt) { dydt << 3 * t * t, 0; }));
  Trapezoidal::Stepper<State> stepper;
  State y(0, 0), y_new;
  stepper.init(system, 0, y);
  double t = 0;
  for (const double h : {0.5, 0.2, 0.4}) {
    stepper.attempt(system, t, y, h, y_new);
    const double error = y_new[0] - y[0] - (std::pow(t + h, 3) - std::pow(t, 3));
    EXPECT_NEAR(error, h * h * h / 2, 1e-13);
    EXPECT_NEAR(std::sqrt(stepper.error_squared(h, y, y_new, Component{0})), std::abs(error), 1e-13);
    stepper.accept(y_new);
    y = y_new;
    t += h;
  }
}

TYPED_TEST(ImplicitRk, RejectedAttemptsLeaveNoTrace) {
  // Some of them fail, with a fresh Jacobian too.
  expect_no_trace_of_rejected_attempts(typename TypeParam::template Stepper<State>{},
                                       ErasedSystem(Oscillator({.k1 = 20, .k3 = 30})), State(0.5, 1),
                                       {0.03, 0.7, 30, 3e4});
}

TYPED_TEST(ImplicitRk, InterpolantMeetsBothEndsAndTheSolutionBetween) {
  const ErasedSystem system(Oscillator{});
  const auto defect = [&](double h) {
    auto step = first_step<typename TypeParam::template Stepper<State>>(system, 0, State(0.5, 1), h);
    EXPECT_LT((step.at(0) - step.y).norm(), 1e-15);
    EXPECT_LT((step.at(1) - step.y_new).norm(), 1e-15);
    double worst = 0;
    for (const double theta : {0.2, 0.5, 0.9}) {
      State exact = step.y;
      integrate(RadauIIA5<State>{}, system, Span<double>{0, theta * h}, exact,
                FixedStep<double>(theta * h / 16));
      worst = std::max(worst, (step.at(theta) - exact).norm());
    }
    return worst;
  };
  // Local: one power more than the global order, which beyond order 3 is that of the interpolant.
  EXPECT_NEAR(std::log2(defect(0.04) / defect(0.02)), std::min(TypeParam::order, 3) + 1, 0.15);
}

TEST(TrBdf2, InterpolantHasNoKinkAtItsInnerPoint) {
  const ErasedSystem system(Oscillator{});
  auto step = first_step<TrBdf2::Stepper<State>>(system, 0, State(0.5, 1), 0.5);
  const double c = static_cast<double>(tableaux::TrBdf2::tableau.c[1]), d = 1e-5;
  EXPECT_LT((step.at(c + d) - 2 * step.at(c) + step.at(c - d)).norm() / d, 1e-4);
}

TEST(Midpoint, StartsItsIterationOnTheLineThroughTheLastMeanSlopes) {
  // y' = 2 t has the mean slope 2 (t + h / 2) over every step: a line, on which the next one lies too.
  double middle = 0;
  std::vector<double> seen;
  const auto system = system_of<State>([&](double t, const State& y, State& dydt) {
    if (t == middle) seen.push_back(y[0]);
    dydt << 2 * t, 1;
  });
  ImplicitMidpoint::Stepper<State> stepper;
  State y(0.25, 0), y_new;
  stepper.init(system, 0.5, y);
  double t = 0.5;
  for (const double h : {0.5, 0.25, 0.5, 0.125}) {
    middle = t + h / 2;
    seen.clear();
    ASSERT_EQ(stepper.attempt(system, t, y, h, y_new), StepStatus::ok);
    if (t > 1) {
      EXPECT_NEAR(seen.at(0), y[0] + h * middle, 1e-12) << t;
    }
    stepper.accept(y_new);
    y = y_new;
    t += h;
  }
}

TYPED_TEST(ImplicitRk, TakesOneJacobianAndOneMatrixOfALinearSystem) {
  Stats stats;
  const Counted<Oscillator> system(Oscillator({.k3 = 0}), stats);
  State y(0.5, 1);
  const auto end = integrate(typename TypeParam::template Stepper<State>{}, system, Span<double>{0, 100}, y,
                             FixedStep<double>(0.1));
  constexpr bool radau = TypeParam::order == 5;
  constexpr std::int64_t implicit_stages =
      radau ? 1 : static_cast<std::int64_t>(TypeParam::tableau.stages) - (TypeParam::tableau.a[0][0] == 0);
  EXPECT_EQ(stats.jacobian, 1);
  EXPECT_EQ(end.stats.factorisations, radau ? 2 : 1);
  EXPECT_LE(end.stats.newton, 2 * implicit_stages * end.stats.steps);
  EXPECT_GE(end.stats.newton, implicit_stages * end.stats.steps);
  // Besides the iterations only slopes at the start of the run are evaluated, if any.
  EXPECT_LE(stats.rhs - (radau ? 3 : 1) * end.stats.newton, 2);
}

TYPED_TEST(ImplicitRk, TakesJacobiansAsTheUserDecides) {
  const auto jacobians = [](int every) {
    Stats stats;
    const Counted<Oscillator> system(Oscillator(), stats);
    State y(0.5, 1);
    typename TypeParam::template Stepper<State> stepper;
    stepper.set_jacobian_update({every});
    const auto end = integrate(stepper, system, Span<double>{0, 1}, y, FixedStep<double>(0.1));
    EXPECT_EQ(end.outcome, Outcome::reached_end);
    return stats.jacobian;
  };
  EXPECT_EQ(jacobians(1), 10);
  EXPECT_EQ(jacobians(4), 3);
  EXPECT_EQ(jacobians(JacobianUpdate::frozen), 1);
}

template <class Method>
void expect_alike_in_every_state() {
  State two(0.5, 1);
  Eigen::VectorXd any = two;
  Eigen::Vector<long double, Eigen::Dynamic> wide = two.cast<long double>();
  const auto oscillator = [](auto t, const auto& y, auto& dydt) {
    dydt[0] = y[1];
    dydt[1] = std::cos(t) - y[0] - y[0] * y[0] * y[0];
  };
  const auto go = [&](auto& y) {
    using Any = std::remove_cvref_t<decltype(y)>;
    using Real = real_of<Any>;
    integrate(typename Method::template Stepper<Any>{}, ErasedSystem(system_of<Any>(oscillator, 2)),
              Span<Real>{0, 1}, y, FixedStep<Real>(Real(1) / 16));
  };
  go(two);
  go(any);
  go(wide);
  EXPECT_LT((any - two).norm(), 1e-13);
  EXPECT_LT((wide - two.cast<long double>()).norm(), 1e-13L);
}

TEST(ImplicitRk, ComputesWithStatesOfEveryKindAlike) {
  expect_alike_in_every_state<TrBdf2>();
  expect_alike_in_every_state<RadauMethod>();
}

TEST(LinearOscillator, KeepsItsEnergyToRoundingOverAMillionSteps) {
  const Oscillator system({.m = 1, .c = 0, .k1 = 4, .k3 = 0, .P = 0, .w = 1});
  const auto drift = [&](auto stepper) {
    State y(1, 0);
    const auto end = integrate(stepper, system, Span<double>{0, 1e5}, y, FixedStep<double>(0.1));
    EXPECT_EQ(end.stats.steps, 1'000'000);
    return std::abs((4 * y[0] * y[0] + y[1] * y[1]) / 4 - 1);
  };
  EXPECT_LT(drift(Trapezoidal::Stepper<State>{}), 2e-11);
  EXPECT_LT(drift(ImplicitMidpoint::Stepper<State>{}), 2e-11);
}

}  // namespace
}  // namespace hmax
