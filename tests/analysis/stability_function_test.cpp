#include "analysis/stability_function.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "bench/catalogue.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;

double limit(const char* method, Complex direction) {
  return largest_stable_step(find_method(method).stability_function, direction);
}

/// First exits from the origin in 128-bit arithmetic, docs/facts.md section 4.
TEST(LargestStableStep, MeetsThePublishedLimitsOnTheRealAxis) {
  EXPECT_NEAR(limit("explicit_euler", -1), 2, 1e-9);
  EXPECT_NEAR(limit("rk2_heun", -1), 2, 1e-9);
  EXPECT_NEAR(limit("bogacki_shampine_32", -1), 2.512745326618, 1e-9);
  EXPECT_NEAR(limit("rk4", -1), 2.785293563405, 1e-9);
  EXPECT_NEAR(limit("dormand_prince_54", -1), 3.306567892635, 1e-9);
}

TEST(LargestStableStep, MeetsThePublishedLimitsOnTheImaginaryAxis) {
  EXPECT_NEAR(limit("rk3_kutta", Complex(0, 1)), 1.732050807569, 1e-6);
  EXPECT_NEAR(limit("rk4", Complex(0, 1)), 2.828427124746, 1e-6);
  EXPECT_NEAR(limit("dormand_prince_54", Complex(0, 1)), 0.997189008633, 1e-6);
  EXPECT_LT(limit("explicit_euler", Complex(0, 1)), 1e-4);
}

TEST(LargestStableStep, ScalesWithTheEigenvalueAndTakesTheWorstOfASpectrum) {
  const StabilityFunction& R = find_method("rk4").stability_function;
  EXPECT_NEAR(largest_stable_step(R, -100), limit("rk4", -1) / 100, 1e-12);
  const std::vector<Complex> spectrum{-1, Complex(-2, 3), -50, 7};
  EXPECT_EQ(largest_stable_step(R, spectrum), largest_stable_step(R, -50));
  EXPECT_TRUE(std::isinf(largest_stable_step(R, 1)));
}

TEST(StabilityFunction, IsWhatOneStepDoesToTheLinearOscillator) {
  // x'' + c x' + k x = 0 as a pair of complex eigenvalues: one step from an eigenvector's real part.
  const Problem problem = make_problem(
      "liver_linear", {.material = {}, .parameters = {{"m", 1}, {"c", 0.6}, {"k1", 2}}, .y0 = {}});
  const Complex lambda(-0.3, std::sqrt(2 - 0.09));
  for (const Method& method : methods()) {
    if (!method.stability_function || !method.fixed_step) continue;
    const double h = 0.7;
    // y0 = Re (1, lambda) and its step Re R (1, lambda).
    Problem started = problem;
    started.y0 = Eigen::Vector2d(1, lambda.real());
    const RunRecord record = method.bind(started).run({.t_end = h, .h = h}, {});
    const Complex R = method.stability_function(h * lambda);
    EXPECT_NEAR(record.y[0], R.real(), 1e-13) << method.id;
    EXPECT_NEAR(record.y[1], (R * lambda).real(), 1e-13) << method.id;
  }
}

}  // namespace
}  // namespace hmax
