/// Rosenbrock and W-methods: what one step is, and what it costs.
#include "integrators/implicit/rosenbrock.hpp"

#include <random>

#include <Eigen/LU>

#include "integrators/integrate.hpp"
#include "problems/any_system.hpp"
#include "problems/oscillator/oscillator.hpp"
#include "problems/test_set/van_der_pol.hpp"
#include "tests/integrators/implicit/rosenbrock_systems.hpp"
#include "tests/integrators/rejected_attempts.hpp"
#include "tests/integrators/stability_function.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Plane = Eigen::Vector2d;
using LongPlane = Eigen::Matrix<long double, 2, 1>;

template <class Method>
struct RosenbrockMethod : testing::Test {};
TYPED_TEST_SUITE(RosenbrockMethod, EveryRosenbrock, MethodId);

/// R(z) with the exact Jacobian. [hairer1996solving, IV.7 (7.14)]
template <class Method>
std::complex<long double> rosenbrock_stability(std::complex<long double> z) {
  constexpr auto form = original(Method::tableau);
  return stability_function(
      form.b.size(), [&](std::size_t i, std::size_t j) { return z * (form.alpha[i][j] + form.gamma[i][j]); },
      [&](std::size_t i) { return z * form.b[i]; });
}

/// The largest |y_new - R(z)| / max(1, |R(z)|) over random z = h lambda.
template <class Method, class State>
double worst_defect(State y) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(0, 6.283), size(-2, 2), exponent(-3, 3);
  DecayWithJacobian<State> system{{y}};
  Rosenbrock<Method, State> stepper;
  State y_new = y;
  double worst = 0;
  for (int repeat = 0; repeat < 1000; ++repeat) {
    const double h = std::pow(10, exponent(random));
    const Complex z = std::polar(std::pow(10, size(random)), angle(random));
    if (std::abs(1.0 - z * static_cast<double>(Method::tableau.gamma)) < 0.1) continue;  // near the pole
    system.lambda.fill(z / h);
    y.fill(1);
    stepper.init(system, 0, y);
    EXPECT_EQ(stepper.attempt(system, 0, y, h, y_new), StepStatus::ok);
    const Complex R(rosenbrock_stability<Method>(z));
    for (const Complex component : y_new)
      worst = std::max(worst, std::abs(component - R) / std::max(1.0, std::abs(R)));
  }
  return worst;
}

TYPED_TEST(RosenbrockMethod, MultipliesByItsStabilityFunction) {
  using One = Eigen::Matrix<Complex, 1, 1>;
  // Stages of the RODAS methods are up to a thousand times the step they add up to.
  const double tolerance = TypeParam::tableau.stages > 3 ? 1e-12 : 1e-13;
  EXPECT_LT((worst_defect<TypeParam, One>(One(1.0))), tolerance);
}
TEST(Rodas4, MultipliesDynamicStatesByItsStabilityFunction) {
  EXPECT_LT((worst_defect<tableaux::Rodas4, Eigen::VectorXcd>(Eigen::VectorXcd::Ones(3))), 1e-12);
}

TEST(Rosenbrock23, HasThePublishedStabilityFunction) {
  const long double d = 1 / (2 + std::sqrt(2.0L));
  for (const std::complex<long double> z : {std::complex<long double>(-3, 1), {0, 2}, {-50, 0}}) {
    const auto R = rosenbrock_stability<tableaux::Rosenbrock23>(z);
    EXPECT_LT(std::abs(R - (1.0L + (1 - 2 * d) * z) / ((1.0L - d * z) * (1.0L - d * z))), 1e-17L);
  }
}

TEST(Rosenbrock23, SolvesTheEquationsOfOde23s) {
  // [shampine1997matlab, section 3] with W = I - h d J: residuals of the published equations.
  const ToldPendulum<Plane> system;
  const double t = 0.4, h = 0.3, d = 1 / (2 + std::sqrt(2.0)), e32 = 6 + std::sqrt(2.0);
  const Plane y(0.3, 0.5);
  Eigen::Matrix2d J;
  Plane f0, f1, f2, T, y_new, out;
  system.jacobian(t, y, J);
  system.time_derivative(t, y, T);
  const Eigen::Matrix2d W = Eigen::Matrix2d::Identity() - h * d * J, inverse = W.inverse();
  system.rhs(t, y, f0);
  const Plane k1 = inverse * (f0 + h * d * T);
  system.rhs(t + h / 2, y + h / 2 * k1, f1);
  const Plane k2 = inverse * (f1 - k1) + k1, end = y + h * k2;
  system.rhs(t + h, end, f2);
  const Plane k3 = inverse * (f2 - e32 * (k2 - f1) - 2 * (k1 - f0) + h * d * T);
  const Plane err = h / 6 * (k1 - 2 * k2 + k3);

  Rosenbrock<tableaux::Rosenbrock23, Plane> stepper;
  stepper.init(system, t, y);
  ASSERT_EQ(stepper.attempt(system, t, y, h, y_new), StepStatus::ok);
  EXPECT_LT((y_new - end).norm(), 1e-15);
  for (const Eigen::Index i : {0, 1})
    EXPECT_NEAR(stepper.error_squared(h, y, y_new, Component{i}), err[i] * err[i], 1e-17);
  const double s = 0.3;
  stepper.interpolate(system, t, h, y, y_new, s, out);
  const Plane between = y + h * (s * (1 - s) / (1 - 2 * d) * k1 + s * (s - 2 * d) / (1 - 2 * d) * k2);
  EXPECT_LT((out - between).norm(), 1e-15);
}

/// y' = p t^(p-1) with its derivatives.
struct Power {
  using State = Eigen::Matrix<double, 1, 1>;
  int p;
  static Eigen::Index dim() { return 1; }
  void rhs(double t, const State&, State& f) const { f[0] = p * std::pow(t, p - 1); }
  void jacobian(double, const State&, Eigen::Matrix<double, 1, 1>& J) const { J.setZero(); }
  void time_derivative(double t, const State&, State& f) const {
    f[0] = p > 1 ? p * (p - 1) * std::pow(t, p - 2) : 0;
  }
};

TYPED_TEST(RosenbrockMethod, IsExactOnPolynomialsOfTimeUpToItsOrder) {
  for (int p = 1; p <= TypeParam::order; ++p) {
    const ErasedSystem system(Power{p});
    const auto step =
        first_step<Rosenbrock<TypeParam, Power::State>>(system, 0.5, Power::State(std::pow(0.5, p)), 1);
    EXPECT_NEAR(step.y_new[0], std::pow(1.5, p), 1e-13 * std::pow(1.5, p)) << p;
  }
}

/// log2 of the ratio of the errors at t = 2 with h and h / 2.
template <class Method>
long double observed_order(const ToldPendulum<LongPlane>& system, JacobianUpdate update, int steps) {
  const auto end = [&](auto stepper, int n) {
    LongPlane y(0.3L, 0.5L);
    integrate(stepper, system, Span<long double>{0, 2}, y, FixedStep<long double>(2.0L / n));
    return y;
  };
  const LongPlane exact = end(Rk<tableaux::Dop853, LongPlane>{}, 400);
  Rosenbrock<Method, LongPlane> stepper;
  stepper.set_jacobian_update(update);
  return std::log2((end(stepper, steps) - exact).norm() / (end(stepper, 2 * steps) - exact).norm());
}

TYPED_TEST(RosenbrockMethod, HasItsOrder) {
  const ToldPendulum<LongPlane> system;
  const int steps = TypeParam::order > 3 ? 100 : 200;
  EXPECT_NEAR(static_cast<double>(observed_order<TypeParam>(system, {}, steps)), TypeParam::order, 0.1);
}

TYPED_TEST(RosenbrockMethod, HasTheOrderOfAWMethodWithAWrongOrAnOldJacobian) {
  ToldPendulum<LongPlane> system;
  const auto order = [&](JacobianUpdate update) {
    return static_cast<double>(observed_order<TypeParam>(system, update, 800));
  };
  EXPECT_NEAR(order({JacobianUpdate::frozen}), TypeParam::w_order, 0.1);
  system.wrong = 1.3L;
  EXPECT_NEAR(order({}), TypeParam::w_order, 0.1);
}

TYPED_TEST(RosenbrockMethod, EstimatesItsErrorWithItsOrder) {
  if constexpr (TypeParam::error_order > 0) {
    const ToldPendulum<LongPlane> system;
    const auto estimate = [&](long double h) {
      return first_step<Rosenbrock<TypeParam, LongPlane>>(system, 0.2L, LongPlane(0.3L, 0.5L), h)
          .error(Component{1});
    };
    EXPECT_NEAR(static_cast<double>(std::log2(estimate(1e-2L) / estimate(5e-3L))), TypeParam::error_order,
                0.1);
  }
}

TYPED_TEST(RosenbrockMethod, InterpolatesBetweenBothEndsWithItsOrder) {
  const ToldPendulum<LongPlane> system;
  const auto error = [&](long double h) {
    long double worst = 0;
    auto step = first_step<Rosenbrock<TypeParam, LongPlane>>(system, 0.2L, LongPlane(0.3L, 0.5L), h);
    EXPECT_EQ(step.at(0), step.y);
    EXPECT_LT((step.at(1) - step.y_new).norm(), 1e-14L);
    for (const long double theta : {0.2L, 0.5L, 0.9L}) {
      LongPlane exact = step.y;
      integrate(Rk<tableaux::Dop853, LongPlane>{}, system, Span<long double>{0.2L, 0.2L + theta * h}, exact,
                FixedStep<long double>(h / 50));
      worst = std::max(worst, (step.at(theta) - exact).norm());
    }
    return worst;
  };
  const double observed = static_cast<double>(std::log2(error(2e-2L) / error(1e-2L)));
  EXPECT_NEAR(observed, TypeParam::interpolant_order + 1, 0.15);
}

TYPED_TEST(RosenbrockMethod, LeavesNoTraceOfARejectedAttempt) {
  const Plane start(0.3, 0.5);
  expect_no_trace_of_rejected_attempts(Rosenbrock<TypeParam, Plane>{}, ErasedSystem(ToldPendulum<Plane>{}),
                                       start, {3.7});
  expect_no_trace_of_rejected_attempts(Rosenbrock<TypeParam, Eigen::VectorXd>{},
                                       ErasedSystem(ToldPendulum<Eigen::VectorXd>{}), Eigen::VectorXd(start),
                                       {3.7});
}

/// What n fixed steps to t = 1 cost.
template <class Method, class System>
Stats cost(const System& system, int n, JacobianUpdate update = {}) {
  Stats counts;
  typename System::State y(2);
  y << 0.3, 0.5;
  Rosenbrock<Method, typename System::State, jacobian_type<System>> stepper;
  stepper.set_jacobian_update(update);
  const auto end =
      integrate(stepper, Counted(system, counts), Span<double>{0, 1}, y, FixedStep<double>(1.0 / n));
  counts.factorisations = end.stats.factorisations;
  return counts;
}

TYPED_TEST(RosenbrockMethod, CostsWhatItSays) {
  constexpr std::int64_t s = TypeParam::tableau.stages;
  constexpr bool fsal = is_fsal(TypeParam::tableau);
  const ErasedSystem told(ToldPendulum<Plane>{}), untold(Pendulum<Plane>{});
  const std::int64_t stages = fsal ? (s - 1) * 30 + 1 : s * 30;
  const Stats exact = cost<TypeParam>(told, 30);
  EXPECT_EQ(exact.rhs, stages);
  EXPECT_EQ(exact.jacobian, 30);
  EXPECT_EQ(exact.factorisations, 30);
  const Stats every = cost<TypeParam>(told, 30, {7});
  EXPECT_EQ(every.jacobian, 5);  // before steps 1, 8, 15, 22 and 29
  EXPECT_EQ(every.factorisations, 5);
  // Two columns and df/dt by differences.
  EXPECT_EQ(cost<TypeParam>(untold, 30).rhs, stages + 3 * 30);
}

TYPED_TEST(RosenbrockMethod, FactorsOnceInAWholeRunOfFixedStepsWithAFrozenJacobian) {
  const Stats frozen = cost<TypeParam>(ErasedSystem(ToldPendulum<Plane>{}), 100, {JacobianUpdate::frozen});
  EXPECT_EQ(frozen.jacobian, 1);
  EXPECT_EQ(frozen.factorisations, 1);
}
TEST(Rodas4, FactorsOnceInAWholeRunOfAnErasedSystem) {
  EXPECT_EQ(cost<tableaux::Rodas4>(AnySystem(ToldPendulum<Eigen::VectorXd>{}), 100, {0}).factorisations, 1);
}

TEST(Rosenbrock23, KeepsItsStepWhileTheJacobianIsFrozen) {
  const auto run = [](JacobianUpdate update) {
    Plane y(0.3, 0.5);
    Rosenbrock<tableaux::Rosenbrock23, Plane> stepper;
    stepper.set_jacobian_update(update);
    return integrate(stepper, ToldPendulum<Plane>{}, Span<double>{0, 20}, y,
                     Adaptive<double, IntegralController>({1e-5, 1e-5}, 3));
  };
  const auto exact = run({}), frozen = run({JacobianUpdate::frozen});
  EXPECT_EQ(exact.stats.factorisations, exact.stats.steps + exact.stats.rejected);
  EXPECT_EQ(frozen.outcome, Outcome::reached_end);
  EXPECT_LT(frozen.stats.factorisations, frozen.stats.steps / 3);
}

TEST(LinearlyImplicitEuler, IsTheStepOfMechanicalSystems) {
  // (M - h dF/dv - h^2 dF/dx) dv = h (F + h dF/dx v), v += dv, x += h v; here without a driving force.
  const Oscillator system(OscillatorParameters{.m = 1.3, .c = 0.7, .k1 = 5, .k3 = 2.1, .P = 0, .w = 1});
  const Plane y(0.6, -0.3);
  const double h = 0.2;
  const Eigen::Matrix<double, 1, 1> q(y[0]), v(y[1]);
  Eigen::Matrix<double, 1, 1> F, K, C;
  system.force(0, q, v, F);
  system.stiffness(0, q, v, K);
  system.damping(0, q, v, C);
  const double dv = h * (F[0] - h * K(0, 0) * v[0]) / (1.3 + h * C(0, 0) + h * h * K(0, 0));
  Rosenbrock<tableaux::LinearlyImplicitEuler, Plane> stepper;
  Plane y_new;
  stepper.init(system, 0, y);
  stepper.attempt(system, 0, y, h, y_new);
  EXPECT_NEAR(y_new[1], y[1] + dv, 1e-15);
  EXPECT_NEAR(y_new[0], y[0] + h * y_new[1], 1e-15);
}

TYPED_TEST(RosenbrockMethod, SaysThatItsMatrixIsSingular) {
  using One = Eigen::Matrix<double, 1, 1>;
  const double gamma = static_cast<double>(TypeParam::tableau.gamma);
  double h = 0.5;
  while (gamma * h * (1 / (gamma * h)) != 1) h *= 1.1;  // so that I - h gamma J is exactly zero
  const ErasedSystem system(DecayWithJacobian<One>{{One(1 / (gamma * h))}});
  Rosenbrock<TypeParam, One> stepper;
  const One y(1.0);
  One y_new;
  stepper.init(system, 0, y);
  EXPECT_EQ(stepper.attempt(system, 0, y, h, y_new), StepStatus::newton_failed);
  EXPECT_EQ(stepper.attempt(system, 0, y, h / 2, y_new), StepStatus::ok);
  One end = y;
  EXPECT_EQ(integrate(stepper, system, Span<double>{0, 2 * h}, end, FixedStep<double>(h)).outcome,
            Outcome::newton_failed);
}

TEST(Rosenbrock23, CutsTheStepAndGivesUpWhereItsMatrixIsNotFinite) {
  // f is defined at y = 0 alone, and its Jacobian nowhere: no step is short enough, and no difference helps.
  struct Root {
    using State = Eigen::Matrix<double, 1, 1>;
    static Eigen::Index dim() { return 1; }
    void rhs(double, const State& y, State& f) const {
      f[0] = y[0] == 0 ? -1 : std::numeric_limits<double>::quiet_NaN();
    }
    void jacobian(double, const State&, State& J) const { J[0] = std::numeric_limits<double>::infinity(); }
  };
  Root::State y(0.0);
  const auto end = integrate(Rosenbrock<tableaux::Rosenbrock23, Root::State>{}, Root{}, Span<double>{0, 1}, y,
                             Adaptive<double, IntegralController>({1e-6, 1e-6, 0.1}, 3));
  EXPECT_EQ(end.outcome, Outcome::newton_failed);
  EXPECT_GT(end.stats.rejected, 10);
}

/// Van der Pol's equation as formulas would give it: without a Jacobian.
struct UntoldVanDerPol {
  using State = Eigen::VectorXd;
  static Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& f) const {
    f[0] = y[1];
    f[1] = 1000 * (1 - y[0] * y[0]) * y[1] - y[0];
  }
};

template <class Method, class System>
double van_der_pol_error(const System& system, double tolerance) {
  typename System::State y(2);
  y << 2, 0;
  const auto end = integrate(
      Rosenbrock<Method, typename System::State, jacobian_type<System>>{}, system, Span<double>{0, 2000}, y,
      Adaptive<double, DeadbandController>({tolerance, tolerance * 1e-3}, Method::error_order));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  return std::abs(y[0] / 0.1706167732170469e1 - 1);
}

TYPED_TEST(RosenbrockMethod, FollowsVanDerPol) {
  if constexpr (TypeParam::error_order > 0) {
    const double bound = TypeParam::order > 2 ? 1e-6 : 5e-5;
    EXPECT_LT((van_der_pol_error<TypeParam>(UntoldVanDerPol{}, 1e-6)), bound);
  }
}
TEST(Rodas4, FollowsVanDerPolBehindAnyType) {
  EXPECT_LT((van_der_pol_error<tableaux::Rodas4>(AnySystem(UntoldVanDerPol{}), 1e-6)), 1e-6);
}

}  // namespace
}  // namespace hmax
