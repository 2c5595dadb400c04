#include "analysis/dynamics/kink.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "analysis/dynamics/trap.hpp"

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using VectorField = std::function<Vector2d(const Vector2d&)>;

/// x' = v, v' = -k x - c v, where k is another one for each sign of x.
VectorField two_springs(double right, double left, double c) {
  return [=](const Vector2d& y) { return Vector2d(y(1), -(y(0) > 0 ? right : left) * y(0) - c * y(1)); };
}

VectorField turned(const VectorField& f, double angle) {
  const Matrix2d Q =
      (Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
  return [=](const Vector2d& y) -> Vector2d { return Q * f(Q.transpose() * y); };
}

Kink at_zero(const VectorField& f, double unit = 1) {
  return kink_around(f, {0, 0}, {1e-3, 1e-3 * unit}, unit);
}

TEST(Kink, HasTheRatesOfTheLinearFieldsOnBothSides) {
  for (const double angle : {0.0, 0.3, 1.1, 2.5}) {
    // w = sqrt(k - c^2 / 4): half a turn in pi / w on each side, growing by -c / 2.
    const Kink focus = at_zero(turned(two_springs(4, 1, 0.2), angle));
    EXPECT_TRUE(focus.rays.empty());
    EXPECT_NEAR(focus.rate, -0.1, 1e-6) << angle;
    EXPECT_NEAR(focus.frequency, 2 / (1 / std::sqrt(3.99) + 1 / std::sqrt(0.99)), 1e-6);
    // Rays v = s x with s^2 + c s + k = 0, of their own on each side.
    const Kink saddle = at_zero(turned(two_springs(-4, -1, 0.3), angle));
    ASSERT_EQ(saddle.rays.size(), 4U) << angle;
    for (const auto& [direction, rate] : saddle.rays) {
      const Vector2d u = Eigen::Rotation2Dd(-angle) * direction;
      const double k = u(0) > 0 ? -4 : -1;
      EXPECT_NEAR(direction.norm(), 1, 1e-12);
      EXPECT_NEAR(rate, u(1) / u(0), 1e-6);
      EXPECT_NEAR(rate * rate + 0.3 * rate + k, 0, 1e-5);
    }
  }
}

/// x' = -x - |v| sign(x), v' = -v - 2 v sign(x): on x = 0 motions slide with the mean of both sides, v' = -v;
/// others follow v = 0 with rate -1 and |v| = 2 x with -3. Backwards they part there.
TEST(Kink, MotionsThatSlideHaveTheMeanRateOfBothSides) {
  const VectorField f = [](const Vector2d& y) {
    const double sign = y(0) > 0 ? 1 : -1;
    return Vector2d(-y(0) - std::abs(y(1)) * sign, -y(1) - 2 * y(1) * sign);
  };
  const VectorField backwards = [f](const Vector2d& y) -> Vector2d { return -f(y); };
  const auto rates = [](const Kink& kink) {
    std::vector<double> all;
    for (const Kink::Ray& ray : kink.rays) all.push_back(std::round(1e6 * ray.rate) / 1e6);
    std::ranges::sort(all);
    return all;
  };
  for (const double angle : {0.0, 0.3, 1.1}) {
    EXPECT_EQ(rates(at_zero(turned(f, angle))), (std::vector<double>{-3, -3, -1, -1, -1, -1})) << angle;
    EXPECT_EQ(rates(at_zero(turned(backwards, angle))), (std::vector<double>{1, 1, 3, 3})) << angle;
  }
}

TEST(Kink, ItsRateIsToldFromNoneThoughItIsSmall) {
  for (const double c : {1e-3, 1e-5, 1e-7}) {
    const Kink kink = at_zero(two_springs(4, 1, c));
    EXPECT_LT(kink.rate_error, c / 4);
    EXPECT_NEAR(kink.rate, -c / 2, kink.rate_error);
  }
  const Kink centre = at_zero(two_springs(1e6, 1, 0));
  EXPECT_LE(std::abs(centre.rate), centre.rate_error);
}

/// Beside a stiff spring motions turn close to the equilibrium, far in energy.
TEST(Trap, OfAKinkIsNeverLeftByMuch) {
  const double stiff = 1e6, c = 0.02;
  const VectorField f = two_springs(stiff, 1, c);
  const Kink kink = at_zero(f);
  EXPECT_NEAR(kink.swing, std::sqrt(stiff), 0.1 * std::sqrt(stiff));
  const Trap trap({0, 0}, kink, {2, 2});
  for (int k = 0; k < 64; ++k) {
    const double angle = std::acos(-1.0) * k / 32;
    const Vector2d start = 2e-3 * Vector2d(std::cos(angle), std::sin(angle));
    double share = 1;
    while (!trap.holds(share * start)) share *= 0.98;
    // (k x^2 + v^2) / 2 falls, and the soft side has it all at v = 0.
    const Vector2d y = share * start;
    const double farthest = std::sqrt((y(0) > 0 ? stiff : 1) * y(0) * y(0) + y(1) * y(1));
    EXPECT_LT(farthest, 2e-3 * 1.05) << angle;
    EXPECT_GT(share, 1e-4) << angle;
  }
}

}  // namespace
}  // namespace hmax
