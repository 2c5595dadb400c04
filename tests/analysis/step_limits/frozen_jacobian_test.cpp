#include "analysis/step_limits/frozen_jacobian.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "integrators/implicit/rosenbrock.hpp"
#include "integrators/implicit/rosenbrock_tableaux.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

template <class T>
LinearlyImplicitMethod method_of() {
  return linearly_implicit(T::tableau);
}
template <class T>
ToleratedRatios decay_of() {
  return tolerated_decay(rosenbrock_amplification(T::tableau, T::order));
}

TEST(FrozenJacobian, OfOneNumberIsTheFunctionOfTwoArguments) {
  const LinearlyImplicitMethod euler = method_of<tableaux::LinearlyImplicitEuler>();
  for (const double z : {-0.5, -3.0})
    for (const double z0 : {-0.2, -7.0})
      EXPECT_NEAR(step_matrix(euler, MatrixXd::Constant(1, 1, z), MatrixXd::Constant(1, 1, z0))(0, 0),
                  1 + z / (1 - z0), 1e-15);
}

/// y' = A y whose Jacobian is told to be A0.
struct Misled {
  using State = Vector2d;
  using Jacobian = Matrix2d;
  static constexpr bool autonomous = true;
  Matrix2d A, A0;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const { dydt = A * y; }
  void jacobian(double, const State&, Jacobian& J) const { J = A0; }
};

TEST(FrozenJacobian, StepsAsTheCodeDoesOnAnyPairOfMatrices) {
  const auto expect_same = [&]<class T>(std::type_identity<T>) {
    Misled system;
    system.A << -1, 2, -3, 0.5;
    system.A0 << 0.3, 1, -2, -4;
    const double h = 0.7;
    const Matrix2d S = step_matrix(method_of<T>(), h * system.A, h * system.A0);
    for (const Vector2d& y : {Vector2d(1, 0), Vector2d(0, 1)}) {
      Rosenbrock<T, Vector2d, Matrix2d> stepper;
      stepper.init(system, 0, y);
      Vector2d y_new;
      stepper.attempt(system, 0, y, h, y_new);
      EXPECT_LT((y_new - S * y).norm(), 1e-13 * S.norm()) << T::id;
    }
  };
  expect_same(std::type_identity<tableaux::LinearlyImplicitEuler>{});
  expect_same(std::type_identity<tableaux::Rosenbrock23>{});
  expect_same(std::type_identity<tableaux::Rodas4>{});
  expect_same(std::type_identity<tableaux::Rodas5P>{});
}

TEST(FrozenJacobian, ToleratesTheRatiosOfTheFacts) {
  // docs/reference/facts.md: 2 for linearly implicit Euler, 4 / (2 + sqrt 2) for ode23s, decay and spring
  // alike.
  const double of_pair = 4 / (2 + std::sqrt(2.0));
  EXPECT_NEAR(decay_of<tableaux::LinearlyImplicitEuler>().most, 2, 1e-9);
  EXPECT_NEAR(decay_of<tableaux::Rosenbrock23>().most, of_pair, 1e-9);
  EXPECT_NEAR(tolerated_stiffness(method_of<tableaux::LinearlyImplicitEuler>()).most, 2, 1e-9);
  EXPECT_NEAR(tolerated_stiffness(method_of<tableaux::Rosenbrock23>()).most, of_pair, 1e-9);
  EXPECT_EQ(decay_of<tableaux::LinearlyImplicitEuler>().least, 0);
  EXPECT_GT(decay_of<tableaux::Rodas4>().least, 0.4);
}

TEST(FrozenJacobian, LimitsTheStepOfASpringBeyondThoseRatios) {
  const LinearlyImplicitMethod euler = method_of<tableaux::LinearlyImplicitEuler>();
  for (const double ratio : {0.1, 1.0, 1.9, 2.0})
    EXPECT_TRUE(std::isinf(frozen_spring_exit(euler, ratio))) << ratio;
  // h^2 <= 4 m / (k - 2 k0)
  for (const double ratio : {2.1, 2.5, 4.0, 50.0})
    EXPECT_NEAR(frozen_spring_exit(euler, ratio) * std::sqrt(ratio - 2), 2, 1e-9) << ratio;
}

TEST(FrozenJacobian, ToleratesMoreStiffeningTheShorterTheStep) {
  const LinearlyImplicitMethod euler = method_of<tableaux::LinearlyImplicitEuler>();
  // k / k0 <= 2 + 4 / (omega0 h)^2, the same bound solved for k.
  for (const double x : {0.1, 0.5, 2.0, 10.0})
    EXPECT_NEAR(tolerated_stiffness(euler, x).most / (2 + 4 / (x * x)), 1, 1e-9) << x;
}

/// Whether a small motion about the place of rest of a loaded cubic spring grows when the Jacobian is that of
/// the unloaded one.
template <class T>
bool grows_with_jacobian_of_the_unloaded_spring(double ratio, double h, int steps) {
  // x'' = P - x - x^3 rests where 1 + 3 x^2 = ratio.
  const double rest = std::sqrt((ratio - 1) / 3);
  const Oscillator system({.m = 1, .c = 0, .k1 = 1, .k3 = 1, .P = rest + rest * rest * rest, .w = 0});
  Rosenbrock<T, Vector2d, Matrix2d> stepper;
  stepper.set_jacobian_update({JacobianUpdate::frozen});
  Vector2d y(0, 0), y_new;
  stepper.init(system, 0, y);
  stepper.attempt(system, 0, y, h, y_new);
  stepper.accept(y_new);
  y = {rest + 1e-6, 0};
  double early = 0, late = 0;
  for (int n = 0; n < steps; ++n) {
    stepper.attempt(system, 0, y, h, y_new);
    stepper.accept(y_new);
    y = y_new;
    const double distance = std::hypot(y(0) - rest, y(1));
    if (n < steps / 4) early = std::max(early, distance);
    if (n >= 3 * steps / 4) late = std::max(late, distance);
  }
  return !(late <= early);
}

TEST(FrozenJacobian, LimitsTheStepOfTheCodeOnACubicSpringWhereItIsPredicted) {
  for (const double ratio : {2.5, 4.0}) {
    using T = tableaux::LinearlyImplicitEuler;
    const double exit = frozen_spring_exit(method_of<T>(), ratio);
    EXPECT_FALSE(grows_with_jacobian_of_the_unloaded_spring<T>(ratio, 0.999 * exit, 4000)) << ratio;
    EXPECT_TRUE(grows_with_jacobian_of_the_unloaded_spring<T>(ratio, 1.001 * exit, 4000)) << ratio;
  }
  for (const double ratio : {4.0, 8.0}) {
    using T = tableaux::Rodas5P;
    const double exit = frozen_spring_exit(method_of<T>(), ratio);
    EXPECT_FALSE(grows_with_jacobian_of_the_unloaded_spring<T>(ratio, 0.999 * exit, 4000)) << ratio;
    EXPECT_TRUE(grows_with_jacobian_of_the_unloaded_spring<T>(ratio, 1.001 * exit, 4000)) << ratio;
  }
}

TEST(FrozenJacobian, OfRodasStandsNoStiffeningAtAll) {
  const LinearlyImplicitMethod rodas = method_of<tableaux::Rodas4>();
  EXPECT_EQ(frozen_spring_exit(rodas, 1.25), 0);
  EXPECT_EQ(tolerated_stiffness(rodas).most, 1);
  EXPECT_TRUE(std::isinf(frozen_spring_exit(rodas, 1)));
  EXPECT_TRUE(std::isinf(frozen_spring_exit(rodas, 0.9)));
  for (const double h : {0.05, 0.5})
    EXPECT_TRUE(grows_with_jacobian_of_the_unloaded_spring<tableaux::Rodas4>(1.25, h, 20000)) << h;
}

TEST(FrozenJacobian, OfARunIsThatOfItsStart) {
  // From rest without load the spring creeps to its loaded place at 2.2 times the stiffness, or it does not.
  const double ratio = 2.2, rest = std::sqrt((ratio - 1) / 3);
  const Problem problem = make_problem(
      "liver_cubic",
      {.parameters = {{"m", 1}, {"c", 0}, {"k1", 1}, {"k3", 1}, {"P", rest + rest * rest * rest}, {"w", 0}},
       .y0 = {0, 0}});
  const Runner runner = find_method("linearly_implicit_euler").bind(problem);
  const double exit = frozen_spring_exit(method_of<tableaux::LinearlyImplicitEuler>(), ratio);
  const auto ends = [&](double h, JacobianUpdate update) {
    RunSpec spec{.t_end = 3000 * h, .h = h};
    spec.jacobian = update;
    return std::abs(runner.run(spec, {}).y(0) - rest);
  };
  EXPECT_LT(ends(0.9 * exit, {JacobianUpdate::frozen}), 1e-6);
  EXPECT_FALSE(ends(1.1 * exit, {JacobianUpdate::frozen}) < 1e-2);
  EXPECT_LT(ends(1.1 * exit, {1}), 1e-6);
}

TEST(FrozenJacobian, TakenAnewEveryFewStepsStandsMore) {
  const LinearlyImplicitMethod euler = method_of<tableaux::LinearlyImplicitEuler>();
  // With a new one every step there is no old one.
  EXPECT_TRUE(std::isinf(stiffening_exit(euler, 6, 1)));
  EXPECT_GT(stiffening_exit(euler, 6, 10), frozen_spring_exit(euler, 6));
  EXPECT_TRUE(std::isinf(stiffening_exit(euler, 2, 10)));
}

}  // namespace
}  // namespace hmax
