/// The spectral radius found by evaluations of f alone, against spectra that are known.
#include "integrators/spectral_radius.hpp"

#include <cmath>
#include <numbers>

#include "integrators/stats.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

template <class Sys>
struct Estimated {
  double radius;
  std::int64_t evaluations;
};

template <class Sys>
Estimated<Sys> estimated(const Sys& system, const typename Sys::State& y) {
  Stats stats;
  const Counted<Sys> counted(system, stats);
  SpectralRadius<typename Sys::State> estimate;
  typename Sys::State f0 = y;
  system.rhs(0, y, f0);
  estimate.init(counted);
  return {estimate.estimate(counted, 0, y, f0), stats.rhs};
}

/// y' = A y.
auto linear(const Eigen::MatrixXd& A) {
  return system_of<Eigen::VectorXd>(
      [A](double, const Eigen::VectorXd& y, Eigen::VectorXd& dydt) { dydt.noalias() = A * y; }, A.rows());
}
auto planar(double a, double b, double c, double d) {
  return system_of<Eigen::Vector2d>([=](double, const Eigen::Vector2d& y, Eigen::Vector2d& dydt) {
    dydt = Eigen::Vector2d(a * y[0] + b * y[1], c * y[0] + d * y[1]);
  });
}

TEST(SpectralRadius, OfOneEquationIsAFifthAboveItsRate) {
  using One = Eigen::Matrix<double, 1, 1>;
  for (const double rate : {-1e6, -1.0, 0.3, 2e4})
    EXPECT_NEAR(estimated(Decay<One>{One(rate)}, One(2.0)).radius, 1.2 * std::abs(rate),
                1e-6 * std::abs(rate));
}

TEST(SpectralRadius, OfADiffusionChainIsBoundedThoughItMovesInItsSlowestMode) {
  for (const Eigen::Index n : {2, 3, 5, 8, 20, 50, 100, 400}) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd slow(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      A(i, i) = -2;
      if (i > 0) A(i, i - 1) = A(i - 1, i) = 1;
      slow[i] = std::sin(std::numbers::pi * static_cast<double>(i + 1) / static_cast<double>(n + 1));
    }
    const double angle = static_cast<double>(n) / static_cast<double>(n + 1) * std::numbers::pi / 2;
    const double exact = 4 * std::sin(angle) * std::sin(angle);
    const auto [radius, evaluations] = estimated(linear(A), slow);
    EXPECT_GE(radius, exact) << n;
    EXPECT_LE(radius, 1.25 * exact) << n;
    EXPECT_LE(evaluations, 12) << n;
  }
}

TEST(SpectralRadius, SeesTheComplexPairOfAnOscillator) {
  for (const double k : {1e-2, 1.0, 1e2, 1e6})
    for (const double c : {0.0, 0.01, 1.9}) {
      // x'' + c sqrt(k) x' + k x = 0: |lambda| = sqrt(k).
      const auto oscillator = planar(0, 1, -k, -c * std::sqrt(k));
      const auto [radius, evaluations] = estimated(oscillator, {0.5, 1});
      EXPECT_NEAR(radius, 1.2 * std::sqrt(k), 0.02 * std::sqrt(k)) << k << ' ' << c;
      EXPECT_LE(evaluations, 15) << k << ' ' << c;
    }
}

TEST(SpectralRadius, SeesAComplexPairAmongSlowerModes) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6);
  A.diagonal() << -1, -2, -3, -4, -50, -50;
  A(4, 5) = 300;
  A(5, 4) = -300;
  EXPECT_NEAR(estimated(linear(A), Eigen::VectorXd::Ones(6)).radius, 1.2 * std::hypot(50, 300), 5);
}

TEST(SpectralRadius, IsFoundAtRest) {
  // At y = 0 with a force, and at an equilibrium.
  const auto forced = system_of<Eigen::Vector2d>([](double, const Eigen::Vector2d& y, Eigen::Vector2d& dydt) {
    dydt = Eigen::Vector2d(y[1], 0.3 - 400 * y[0] - 100 * y[1]);
  });
  const double rate = 50 + std::sqrt(2500.0 - 400);
  EXPECT_NEAR(estimated(forced, {0, 0}).radius, 1.2 * rate, 2);
  EXPECT_NEAR(estimated(planar(-1000, 0, 0, -1), {0, 0}).radius, 1200, 12);
}

TEST(SpectralRadius, IsZeroWhereNothingDependsOnTheState) {
  const auto clock = system_of<Eigen::Vector2d>(
      [](double, const Eigen::Vector2d&, Eigen::Vector2d& dydt) { dydt = Eigen::Vector2d(1, 2); });
  const auto [radius, evaluations] = estimated(clock, {0.5, 1});
  EXPECT_EQ(radius, 0);
  EXPECT_LE(evaluations, 3);
}

TEST(SpectralRadius, StaysWhatItWasWhereFIsNotFinite) {
  using One = Eigen::Matrix<double, 1, 1>;
  double slope = -7;
  const auto system = system_of<One>([&slope](double, const One& y, One& dydt) { dydt[0] = slope * y[0]; });
  SpectralRadius<One> estimate;
  estimate.init(system);
  EXPECT_NEAR(estimate.estimate(system, 0, One(1.0), One(-7.0)), 8.4, 1e-6);
  slope = std::nan("");
  EXPECT_NEAR(estimate.estimate(system, 0, One(1.0), One(-7.0)), 8.4, 1e-6);
}

TEST(SpectralRadius, IsCheaperTheSecondTime) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(30, 30);
  for (Eigen::Index i = 0; i < 30; ++i) A(i, i) = -1 - 0.1 * static_cast<double>(i * i);
  Stats stats;
  const auto system = linear(A);
  const Counted counted(system, stats);
  const Eigen::VectorXd y = Eigen::VectorXd::Ones(30), f0 = A * y;
  SpectralRadius<Eigen::VectorXd> estimate;
  estimate.init(counted);
  estimate.estimate(counted, 0, y, f0);
  const std::int64_t first = stats.rhs;
  EXPECT_NEAR(estimate.estimate(counted, 0, y, f0), 1.2 * 85.1, 8);
  EXPECT_LT(stats.rhs - first, first);
}

}  // namespace
}  // namespace hmax
