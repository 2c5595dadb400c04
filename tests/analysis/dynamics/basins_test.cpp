#include "analysis/dynamics/basins.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/parallel_for.hpp"
#include "tests/core/jobs.hpp"

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// exp(J t) y of J = T diag(a, b) T^-1 in closed form: a shear with very different rates.
TEST(Trap, IsNotLeftByTheLinearFlow) {
  const double a = -0.1, b = -30;
  const Matrix2d T = (Matrix2d() << 1, 1, -5, 0.2).finished();
  const Matrix2d J = T * Vector2d(a, b).asDiagonal() * T.inverse();
  const Vector2d rest(2, -1), size(3, 7);
  const Trap trap(rest, J, size);
  EXPECT_TRUE(trap.holds(rest));
  double largest = 0;
  for (int k = 0; k < 200; ++k) {
    const double angle = 2 * std::acos(-1.0) * k / 200;
    const Vector2d u(std::cos(angle), std::sin(angle));
    double r = 2e-3;
    while (!trap.holds(rest + r * u.cwiseProduct(size))) r *= 0.98;
    largest = std::max(largest, r);
    for (const double t : {1e-3, 1e-2, 0.1, 1.0, 10.0}) {
      const Vector2d y = T * Vector2d(std::exp(a * t), std::exp(b * t)).asDiagonal() * T.inverse() *
                         (r * u.cwiseProduct(size));
      EXPECT_TRUE(trap.holds(rest + y)) << angle << " " << t;
    }
  }
  EXPECT_LE(largest, 1e-3);
  EXPECT_GT(largest, 0.9e-3) << "the ellipse is smaller than it may be";
}

/// The linear flow with N(u) = 4 slack R u besides, R a rotation, by short steps.
TEST(Trap, IsNotLeftWithinItsSlack) {
  const Matrix2d J = (Matrix2d() << -0.1, 40, -1, -0.3).finished();
  const Trap trap({0, 0}, J, {1, 1});
  const double h = 1e-3;
  for (int k = 0; k < 32; ++k)
    for (int direction = 0; direction < 16; ++direction) {
      const double phi = std::acos(-1.0) * k / 16, psi = std::acos(-1.0) * direction / 8;
      double r = 2e-3;
      while (!trap.holds(r * Vector2d(std::cos(phi), std::sin(phi)))) r *= 0.999;
      Vector2d u = r * Vector2d(std::cos(phi), std::sin(phi));
      const Matrix2d A = h * (J + 4 * trap.slack() * Eigen::Rotation2Dd(psi).toRotationMatrix());
      const Matrix2d step = Matrix2d::Identity() + A + A * A / 2 + A * A * A / 6;
      for (int i = 0; i < 2000 && trap.holds(u); ++i) u = step * u;
      EXPECT_TRUE(trap.holds(u)) << phi << " " << psi;
    }
}

TEST(Trap, NeedsAStableEquilibrium) {
  for (const Matrix2d& J : {(Matrix2d() << 0, 1, -1, 0).finished(), (Matrix2d() << 0, 1, 1, -1).finished(),
                            (Matrix2d() << 0, 1, -1, 0.1).finished()})
    EXPECT_THROW(Trap({0, 0}, J, {1, 1}), std::invalid_argument);
}

/// The basins of fate_of(start, worker).
template <class FateOf>
Basins basins_by(const FateOf& fate_of, const Window& window, int columns, int rows,
                 const std::function<bool(double)>& going = {}) {
  std::vector<FatesOf> fates_of;
  for (std::size_t worker = 0; worker < std::max<std::size_t>(jobs(), 1); ++worker)
    fates_of.push_back([&, worker](std::span<const Vector2d> starts, std::span<int> fates) {
      std::ranges::transform(starts, fates.begin(), [&](const Vector2d& y) { return fate_of(y, worker); });
    });
  return basins(fates_of, window, columns, rows, going);
}

/// Fates that the line x = 0 divides, as in x' = x - x^3, v' = -v.
TEST(Basins, AreDividedByTheSeparatrix) {
  const auto side = [](const Vector2d& y, std::size_t) { return y(0) < 0 ? 0 : 1; };
  const Basins found = basins_by(side, {{-2, -1}, {1, 1}}, 30, 4);
  EXPECT_EQ(found.fate.size(), 120U);
  EXPECT_DOUBLE_EQ(found.share(0), 2.0 / 3);
  EXPECT_DOUBLE_EQ(found.share(1), 1.0 / 3);
  EXPECT_EQ(found.share(undecided), 0);
  EXPECT_EQ(found.fate[19], 0);
  EXPECT_EQ(found.fate[20], 1);
}

TEST(Basins, StartsOfASymmetricWindowMirrorEachOtherExactly) {
  const Jobs one(1);
  std::vector<Vector2d> starts;
  basins_by(
      [&](const Vector2d& y, std::size_t) {
        starts.push_back(y);
        return 0;
      },
      {{-0.7, -1.1}, {0.7, 1.1}}, 7, 5);
  for (std::size_t i = 0; i < starts.size(); ++i) EXPECT_EQ(starts[i], -starts[starts.size() - 1 - i]);
}

TEST(Basins, CanBeInterrupted) {
  const Basins found = basins_by([](const Vector2d&, std::size_t) { return 0; }, {{0, 0}, {1, 1}}, 4, 4,
                                 [](double share) { return share < 0.5; });
  EXPECT_DOUBLE_EQ(found.share(0), 0.5);
  EXPECT_DOUBLE_EQ(found.share(undecided), 0.5);
}

TEST(Basins, AreTheSameForAnyNumberOfThreads) {
  const auto found_by = [](std::size_t threads) {
    const Jobs those(threads);
    std::atomic<std::size_t> highest = 0;
    const auto spiral = [&](const Vector2d& y, std::size_t worker) {
      if (worker > highest) highest = worker;
      return static_cast<int>(1e6 * y.squaredNorm()) % 7;
    };
    const Basins found = basins_by(spiral, {{-2, -1}, {1, 1}}, 40, 30);
    EXPECT_LT(highest, threads);
    return found.fate;
  };
  EXPECT_EQ(found_by(1), found_by(2));
  EXPECT_EQ(found_by(1), found_by(5));
}

TEST(Basins, NeedAWindow) {
  const auto fate = [](const Vector2d&, std::size_t) { return 0; };
  EXPECT_THROW(basins_by(fate, {{0, 0}, {0, 1}}, 4, 4), std::invalid_argument);
  EXPECT_THROW(basins_by(fate, {{0, 0}, {1, 1}}, 0, 4), std::invalid_argument);
  EXPECT_EQ(basins_by(fate, {{0, 0}, {1, 1}}, 1, 1).fate, std::vector{0});
}

}  // namespace
}  // namespace hmax
