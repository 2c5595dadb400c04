#include "bench/trajectory_limit.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "bench/predict.hpp"
#include "results/errors.hpp"

namespace hmax {
namespace {

Problem oscillator(double c, double k1, double k3, std::vector<double> y0) {
  return make_problem(
      "liver_cubic",
      {.material = {}, .parameters = {{"m", 1}, {"c", c}, {"k1", k1}, {"k3", k3}}, .y0 = std::move(y0)});
}

TEST(LimitAlongAMotion, OfALinearModelIsThatAtRestEverywhere) {
  const Problem problem = oscillator(0.4, 2, 0, {1, 0});
  for (const char* name : {"rk4", "adams_bashforth_3", "symplectic_euler"}) {
    const Method method = find_method(name);
    const auto along = limit_along(method, problem, 10);
    ASSERT_TRUE(along) << name;
    const double at_rest = predict(method, problem, linearised(problem)).h_max.value();
    for (const double h : along->h_max) EXPECT_NEAR(h, at_rest, 1e-9 * at_rest) << name;
  }
}

TEST(LimitAlongAMotion, OfAHardeningSpringIsLeastWhereItTurns) {
  // Undamped from rest at x = A: the tangent stiffness is largest at the turning points, k1 + 3 k3 A^2.
  const double A = 1.5, k1 = 0.5, k3 = 0.8;
  const auto along = limit_along(find_method("central_difference"), oscillator(0, k1, k3, {A, 0}), 20, 2000);
  ASSERT_TRUE(along);
  EXPECT_NEAR(along->least, 2 / std::sqrt(k1 + 3 * k3 * A * A), 1e-5);
  EXPECT_NEAR(std::abs(along->y_least[0]), A, 1e-3);
}

TEST(LimitAlongAMotion, SaysWhereTheTangentItselfGrows) {
  const auto along = limit_along(find_method("rk4"), oscillator(-0.2, 1, 0, {0.1, 0}), 5);
  ASSERT_TRUE(along);
  EXPECT_EQ(along->growing, 1);
  EXPECT_TRUE(std::isnan(along->least));
}

TEST(LimitAlongAMotion, IsNothingWithoutAnAmplificationOrForAProblemThatDoesNotSuit) {
  EXPECT_FALSE(limit_along(find_method("adams_pece"), oscillator(1, 1, 0, {1, 0}), 5));
  EXPECT_FALSE(limit_along(find_method("newmark"), make_problem("van_der_pol"), 5));
}

TEST(LimitFromAStart, OfALinearModelIsThatOfItsSpectrum) {
  const Problem problem = oscillator(0.6, 2, 0, {1, 0});
  for (const char* name : {"explicit_euler", "rk4", "central_difference"}) {
    const Method method = find_method(name);
    const double predicted = predict(method, problem, linearised(problem)).h_max.value();
    const auto observed = limit_from_start(method, problem, 4000, predicted);
    ASSERT_TRUE(observed) << name;
    EXPECT_NEAR(*observed / predicted, 1, 2e-3) << name;
  }
}

TEST(LimitFromAStart, OfAMethodStableAtEveryStepIsUnbounded) {
  const auto observed =
      limit_from_start(find_method("implicit_euler"), oscillator(0.6, 2, 0, {1, 0}), 200, 1);
  ASSERT_TRUE(observed);
  EXPECT_TRUE(std::isinf(*observed));
}

}  // namespace
}  // namespace hmax
