#include "analysis/foreign_steps/step_growth.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/foreign_steps/step_spectrum.hpp"
#include "analysis/spectrum/lanczos.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Blocks of 2 x 2 on the diagonal, seen in a reflected basis: their eigenvalues are those of the operator.
LinearOperator reflected(std::vector<Eigen::Matrix2d> blocks) {
  const auto n = 2 * static_cast<Index>(blocks.size());
  return [blocks = std::move(blocks),
          u = VectorXd(start_vector(n + 5).tail(n).normalized())](const VectorXd& v) {
    VectorXd w = v - 2 * u.dot(v) * u;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const auto at = static_cast<Index>(2 * i);
      w.segment<2>(at) = (blocks[i] * w.segment<2>(at)).eval();
    }
    return VectorXd(w - 2 * u.dot(w) * u);
  };
}

Eigen::Matrix2d block(double a, double b, double c, double d) {
  Eigen::Matrix2d J;
  J << a, b, c, d;
  return J;
}

Eigen::Matrix2d rotation(double angle, double modulus = 1) {
  return modulus * block(std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle));
}

/// 298 motions whose multipliers have this modulus.
std::vector<Eigen::Matrix2d> motions(double modulus) {
  std::vector<Eigen::Matrix2d> found;
  for (int i = 1; i < 299; ++i) found.push_back(rotation(std::numbers::pi * i / 300, modulus));
  return found;
}

TEST(StepGrowth, WhatAnErrorMakesOfRigidMotionsDoesNotGrow) {
  constexpr double error = 1e-9;
  for (const double modulus : {1.0, 0.99}) {
    std::vector<Eigen::Matrix2d> blocks = motions(modulus);
    // Eigenvalues 1 +- sqrt(error): larger than 1 by 3e-5.
    for (int i = 0; i < 6; ++i) blocks.push_back(block(1, 1, error, 1));
    const ProductGrowth found = growth_of_products(reflected(blocks), 608, {.error = error});
    EXPECT_FALSE(found.grows) << modulus << " " << found.multiplier;
    EXPECT_GT(found.tolerance, std::sqrt(error)) << modulus;
  }
}

TEST(StepGrowth, WhatGrowsBesideRigidMotionsIsFound) {
  std::vector<Eigen::Matrix2d> blocks = motions(1);
  for (int i = 0; i < 6; ++i) blocks.push_back(block(1, 1, 1e-9, 1));
  // Symplectic Euler at h omega = 2.001: mu^2 + (h^2 omega^2 - 2) mu + 1 = 0.
  const double square = 2.001 * 2.001;
  blocks.push_back(block(1 - square, 1, -square, 1));
  const ProductGrowth found = growth_of_products(reflected(blocks), 610, {.error = 1e-9});
  ASSERT_TRUE(found.grows);
  const double half = (square - 2) / 2;
  EXPECT_NEAR(found.multiplier.real(), -half - std::sqrt(half * half - 1), 1e-3);
}

TEST(StepGrowth, GrowthOfTwentyInAMillionBesideDecayIsFound) {
  std::vector<Eigen::Matrix2d> blocks = motions(0.99);
  blocks.push_back(block(1, 1, 1e-9, 1));
  blocks.push_back(rotation(0.5, 1 + 2e-5));
  const ProductGrowth found = growth_of_products(reflected(blocks), 600, {.error = 1e-9});
  ASSERT_TRUE(found.grows);
  EXPECT_NEAR(std::abs(found.multiplier), 1 + 2e-5, 1e-6);
  EXPECT_NEAR(std::abs(std::arg(found.multiplier)), 0.5, 1e-4);
}

TEST(StepGrowth, AMultiplierBeyondTheRangeOfNumbersGrows) {
  const ProductGrowth found =
      growth_of_products([](const VectorXd& v) { return VectorXd(1e300 * v.array() * 1e300); }, 400, {});
  EXPECT_TRUE(found.grows);
  EXPECT_TRUE(std::isinf(found.multiplier.real()));
}

TEST(StepGrowth, AMotionOfTheModelGrowsAtOneRateInTime) {
  const auto at = [](double h, std::complex<double> multiplier, bool grows = true) {
    StepSpectrum row;
    row.h = h;
    row.multiplier = multiplier;
    row.grows = grows;
    return row;
  };
  // exp(9 h), and a step that grows from its limit on.
  EXPECT_TRUE(is_growth_of_model(at(1e-3, std::exp(9e-3)), at(1.3e-3, std::exp(1.17e-2))));
  EXPECT_FALSE(is_growth_of_model(at(1e-3, 1.002), at(1.3e-3, 1.8)));
  EXPECT_FALSE(is_growth_of_model(at(1e-3, std::exp(9e-3)), at(1.3e-3, std::exp(1.17e-2), false)));
  EXPECT_FALSE(is_growth_of_model(at(1e-3, -std::exp(9e-3)), at(1.3e-3, -std::exp(1.17e-2))));
}

}  // namespace
}  // namespace hmax
