/// Which motions of a large step continue the slow ones, against the eigenvalues of steps of an
/// oscillator.
#include "analysis/foreign_steps/slow_motions.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

namespace hmax {
namespace {

using Complex = std::complex<double>;

/// The motions of (x, v) under symplectic Euler of x'' = -k x - c v.
std::vector<StepMotion> motions_of_euler(double k, double c, double h) {
  Eigen::Matrix2d A;
  A << 1 - h * h * k, h * (1 - c * h), -h * k, 1 - c * h;
  const Eigen::EigenSolver<Eigen::Matrix2d> solver(A);
  std::vector<StepMotion> motions;
  for (Eigen::Index i = 0; i < 2; ++i)
    if (const Complex value = solver.eigenvalues()[i];
        value.imag() > 0 || (value.imag() == 0 && value.real() > 0))
      motions.push_back({.rate = std::log(value) / h, .shape = solver.eigenvectors().col(i).normalized()});
  return motions;
}

const Eigen::VectorXd unit_scales = Eigen::VectorXd::Ones(2);

TEST(ContinuedMotions, OfTwoDecaysOneGoesOnWhereTheOtherTurnsAbout) {
  // z^2 - (2 - c h - k h^2) z + 1 - c h = 0: 0.843 and -0.593 of h = 0.05.
  const std::vector<StepMotion> slow = slowest_motions(motions_of_euler(100, 30, 1e-3), unit_scales, 3),
                                large = motions_of_euler(100, 30, 0.05);
  ASSERT_EQ(slow.size(), 2U);
  ASSERT_EQ(large.size(), 1U);
  const std::vector<ShownMode> modes = continued_motions(slow, large, unit_scales);
  const double z = 0.125 + std::sqrt(0.125 * 0.125 + 0.5);
  EXPECT_NEAR(modes[0].omega_shown, -std::log(z) / 0.05, 1e-9);
  EXPECT_EQ(modes[0].zeta_shown, 1);
  EXPECT_TRUE(std::isnan(modes[1].omega_shown)) << modes[1].omega_shown;
}

TEST(ContinuedMotions, OfTwoDecaysAreTwo) {
  const std::vector<StepMotion> slow = slowest_motions(motions_of_euler(100, 30, 1e-3), unit_scales, 3);
  const double h = 0.02, half = 0.68, root = std::sqrt(half * half - 0.4);  // 2 half = 2 - c h - k h^2
  const std::vector<ShownMode> modes = continued_motions(slow, motions_of_euler(100, 30, h), unit_scales);
  EXPECT_NEAR(modes[0].omega_shown, -std::log(half + root) / h, 1e-9);
  EXPECT_NEAR(modes[1].omega_shown, -std::log(half - root) / h, 1e-9);
}

TEST(ContinuedMotions, OfAnOscillationMayBeTwoDecays) {
  const double k = 1, c = 1.8, h = 0.3, half = (2 - c * h - k * h * h) / 2;
  ASSERT_GT(half * half, 1 - c * h);
  const std::vector<StepMotion> slow = slowest_motions(motions_of_euler(k, c, 1e-3), unit_scales, 3);
  ASSERT_EQ(slow.size(), 1U);
  const std::vector<ShownMode> modes = continued_motions(slow, motions_of_euler(k, c, h), unit_scales);
  const double root = std::sqrt(half * half - (1 - c * h)), a = -std::log(half + root) / h,
               b = -std::log(half - root) / h;
  EXPECT_NEAR(modes[0].omega_shown, std::sqrt(a * b), 1e-9);
  EXPECT_NEAR(modes[0].zeta_shown, (a + b) / (2 * std::sqrt(a * b)), 1e-9);
}

TEST(ContinuedMotions, OfOneFrequencyAreEachShownWhateverTheirPlane) {
  // Two equal oscillators, whose motions of the large step are turned against those of the small one.
  const auto pair_of = [](double rate, double angle) {
    std::vector<StepMotion> both(2);
    for (const int i : {0, 1}) {
      Eigen::VectorXcd shape(2);
      shape << std::cos(angle + i * std::numbers::pi / 2), std::sin(angle + i * std::numbers::pi / 2);
      both[static_cast<std::size_t>(i)] = {.rate = {-0.1, rate}, .shape = shape};
    }
    return both;
  };
  for (const double angle : {0.1, 0.7, 0.8, 1.5})
    for (const ShownMode& mode : continued_motions(pair_of(10, 0), pair_of(9, angle), unit_scales))
      EXPECT_NEAR(mode.omega_shown, std::hypot(9, 0.1), 1e-12) << angle;
}

}  // namespace
}  // namespace hmax
