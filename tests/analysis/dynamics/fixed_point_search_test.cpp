#include "analysis/dynamics/fixed_point_search.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "analysis/dynamics/poincare.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

/// x'' + c x' + k1 x + k3 x^3 = P cos(w t)
struct Duffing {
  using State = Vector2d;
  double c, k1, k3, P, w;

  static Eigen::Index dim() { return 2; }
  void rhs(double t, const State& y, State& f) const {
    f << y(1), P * std::cos(w * t) - c * y(1) - k1 * y(0) - k3 * y(0) * y(0) * y(0);
  }
};

FixedPointSearch motions_of_one_period(const Duffing& system, const Vector2d& reach) {
  return search_fixed_points(period_map(system, 2 * std::numbers::pi / system.w), {-reach, reach});
}

void expect_points(const FixedPointSearch& found, const std::vector<Vector2d>& expected) {
  ASSERT_EQ(found.points.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LT((found.points[i].state - expected[i]).norm(), 1e-6) << i;
  EXPECT_EQ(found.degree, 1);
  EXPECT_TRUE(found.accounts());
}

// The points are those of Newton's method with variational equations, by a Runge-Kutta method of order 4 at
// 600 steps a period, from 120 x 120 starts.
TEST(FixedPointSearch, FindsTheMotionBetweenTwoOthersInChaos) {
  const auto found = motions_of_one_period({.c = 0.05, .k1 = 0, .k3 = 1, .P = 7.5, .w = 1}, {5, 10});
  expect_points(found, {{2.27385391, -0.26032327}, {2.89136324, 0.24696478}, {3.17068805, 0.29514998}});
  EXPECT_NEAR(found.points[1].multipliers[0].real(), 13.0037, 1e-3);
  EXPECT_NEAR(found.points[1].multipliers[1].real(), 0.0561686, 1e-6);
  EXPECT_EQ(index_of(found.points[1]), -1);
}

TEST(FixedPointSearch, FindsBothBranchesOfAResonanceAndTheOneBetween) {
  expect_points(motions_of_one_period({.c = 0.1, .k1 = 1, .k3 = 1, .P = 1, .w = 2}, {4, 8}),
                {{-1.69253813, 1.56650471}, {-0.34208906, 0.04733757}, {1.91748451, 2.27551194}});
}

TEST(FixedPointSearch, FindsEveryMotionOfTwoWells) {
  expect_points(motions_of_one_period({.c = 0.25, .k1 = -1, .k3 = 1, .P = 0.1, .w = 1}, {3, 4}),
                {{-0.90380181, 0.02145636}, {-0.04927769, 0.00616904}, {1.09492544, 0.02876434}});
  expect_points(motions_of_one_period({.c = 0.25, .k1 = -1, .k3 = 1, .P = 0.2, .w = 1}, {3, 4}),
                {{-0.88576801, 0.64413716},
                 {-0.79005063, 0.04357967},
                 {-0.47579330, 0.18482523},
                 {-0.09884007, 0.01243053},
                 {0.30419698, 0.30852199},
                 {1.11873239, 0.59935103},
                 {1.19706536, 0.08447250}});
  expect_points(motions_of_one_period({.c = 0.25, .k1 = -1, .k3 = 1, .P = 0.4, .w = 1}, {3, 4}),
                {{-1.17218622, 0.55576246}, {-0.20005879, 0.02564190}, {0.03181315, 0.15279645}});
}

const Window square{{-1, -1}, {1, 1}};

/// (x + i v)^n turns n times around zero, its conjugate as often the other way.
TEST(FixedPointSearch, CountsHowOftenAFunctionTurns) {
  for (const int n : {1, 2, 5}) {
    const auto power = [n](const VectorXd& y, double sign) -> VectorXd {
      const std::complex<double> z = std::pow(std::complex<double>(y(0) - 0.3, sign * (y(1) + 0.2)), n);
      return Vector2d(z.real(), z.imag());
    };
    EXPECT_EQ(degree_around([&](const VectorXd& y) { return power(y, 1); }, square), n);
    EXPECT_EQ(degree_around([&](const VectorXd& y) { return power(y, -1); }, square), -n);
  }
  EXPECT_EQ(degree_around([](const VectorXd&) -> VectorXd { return Vector2d(1, 0); }, square), 0);
  // Zero on the border, or nothing there.
  EXPECT_FALSE(degree_around([](const VectorXd& y) -> VectorXd { return y - Vector2d(1, 0); }, square));
  // Half a turn within 1e-7 of a side; the angle of noise is unknown, however long it is looked for.
  const auto steep = [](const VectorXd& y) -> VectorXd { return Vector2d(y(1), 1e-10 * (y(0) + 0.9)); };
  EXPECT_EQ(degree_around(steep, square), -1);
  const auto noise = [](const VectorXd& y) -> VectorXd {
    return Vector2d(std::sin(1e17 * (y(0) + 2 * y(1))), std::cos(3e17 * (y(0) - y(1))));
  };
  EXPECT_FALSE(degree_around(noise, square));
  EXPECT_FALSE(degree_around([](const VectorXd& y) -> VectorXd { return y / (y(0) < 0.9 ? 1 : 0); }, square));
  // Motions of a field slide along its jump towards the zero; a map jumps over it.
  const auto jump = [](const VectorXd& y) -> VectorXd { return Vector2d(y(0) < 0 ? 1 : -1, -y(1)); };
  EXPECT_EQ(degree_around(jump, square, true), 1);
  EXPECT_FALSE(degree_around(jump, square));
}

/// Two points in the square of the lattice whose middle is (w, w), where a straight line through the corners
/// misses them: g is the same at all corners, or at opposite ones.
TEST(FixedPointSearch, FindsPairsThatTheCornersOfTheirSquareDoNotShow) {
  constexpr double w = 1.0 / 32;
  const auto found = [&](const auto& g) {
    return search_fixed_points([&](const VectorXd& y) -> VectorXd { return y + g(y(0) - w, y(1) - w); },
                               square);
  };
  const auto expect_pair = [&](const FixedPointSearch& pair, const Vector2d& from_middle) {
    ASSERT_EQ(pair.points.size(), 2U);
    for (const double sign : {-1.0, 1.0})
      EXPECT_LT((pair.points[sign < 0 ? 0 : 1].state - Vector2d(w, w) - sign * from_middle).norm(), 1e-9)
          << sign;
    EXPECT_EQ(pair.degree, 0);
    EXPECT_TRUE(pair.accounts());
  };
  for (const double share : {0.3, 0.6, 0.9}) {
    const double r = share * w, s = r * r;
    expect_pair(found([=](double u, double v) { return Vector2d(u * u - s, -v / 2); }), {r, 0});
    expect_pair(found([=](double u, double v) { return Vector2d(-u / 2, s - v * v); }), {0, r});
    expect_pair(found([=](double u, double v) { return Vector2d(u * v - s, v - u); }), {r, r});
    expect_pair(found([=](double u, double v) { return Vector2d(u * v + s, u + v); }), {r, -r});
  }
}

TEST(FixedPointSearch, DiscardsCellsByOneComponentThatHasNoZero) {
  // Phi(y) - y = (2 + u, 0): the slopes are singular, and the first component alone says that no point is
  // there: of the first 32 x 32 cells corners and middles, and for the degree the border.
  int evaluations = 0;
  const auto found = search_fixed_points(
      [&](const VectorXd& y) -> VectorXd {
        ++evaluations;
        return y + Vector2d(2 + y(0), 0);
      },
      square);
  EXPECT_TRUE(found.points.empty());
  EXPECT_TRUE(found.whole);
  EXPECT_EQ(found.degree, 0);
  EXPECT_LT(evaluations, 33 * 33 + 32 * 32 + 1000);
}

TEST(FixedPointSearch, SaysWhatItCannotTell) {
  // Every point is fixed.
  const auto all = search_fixed_points([](const VectorXd& y) { return y; }, square);
  EXPECT_FALSE(all.whole);
  EXPECT_FALSE(all.accounts());
  // The same to rounding: a spring without damping, looked at in its own period.
  EXPECT_FALSE(motions_of_one_period({.c = 0, .k1 = 1, .k3 = 0, .P = 0, .w = 1}, {2, 2}).whole);
  // (x, v) -> (x + x^2, v / 2): a double point, whose index the multipliers do not tell.
  const auto fold = search_fixed_points(
      [](const VectorXd& y) -> VectorXd { return Vector2d(y(0) + y(0) * y(0), y(1) / 2); }, square);
  EXPECT_FALSE(fold.index_sum);
  EXPECT_FALSE(fold.accounts());
  // Half of the plane diverges.
  const auto half = search_fixed_points(
      [](const VectorXd& y) -> VectorXd { return y(0) > 0.8 ? y / 0.0 : VectorXd(y / 2); }, square);
  ASSERT_EQ(half.points.size(), 1U);
  EXPECT_EQ(half.index_sum, 1);
  EXPECT_FALSE(half.degree);
  EXPECT_THROW(search_fixed_points([](const VectorXd& y) { return y; }, {Vector2d(0, 0), Vector2d(0, 1)}),
               std::invalid_argument);
}

/// A field from its two components, with a Jacobian by differences.
PlanarField field_of(std::function<Vector2d(const Vector2d&)> rhs) {
  return {rhs, [rhs](const Vector2d& y) -> Eigen::Matrix2d {
            return differenced_jacobian(rhs, y, Vector2d::Constant(1e-3));
          }};
}

TEST(EquilibriumSearch, FindsWhatNewtonsMethodFromAGridOvershoots) {
  // Newton's method on atan diverges from everywhere but a small part of the window.
  const PlanarField steep = field_of([](const Vector2d& y) {
    return Vector2d(-std::atan(3000 * (y(0) - 0.3003)), -std::atan(3000 * (y(1) - 0.2002)));
  });
  const Window window{{-1, -1}, {1, 1}};
  EXPECT_TRUE(find_equilibria(steep, window).empty());
  const EquilibriumSet found = search_equilibria(steep, window);
  ASSERT_EQ(found.points.size(), 1U);
  EXPECT_LT((found.points[0].state - Vector2d(0.3003, 0.2002)).norm(), 1e-9);
  EXPECT_EQ(found.points[0].type, EquilibriumType::stable_node);
  EXPECT_EQ(found.degree, 1);
  EXPECT_TRUE(found.accounts());
}

TEST(EquilibriumSearch, SumsTheIndicesOfADoubleWell) {
  const PlanarField well =
      field_of([](const Vector2d& y) { return Vector2d(y(1), y(0) - y(0) * y(0) * y(0) - 0.2 * y(1)); });
  const EquilibriumSet all = search_equilibria(well, {{-2, -2}, {2, 2}});
  EXPECT_EQ(all.points.size(), 3U);
  EXPECT_EQ(all.index_sum, 1);
  EXPECT_TRUE(all.accounts());
  const EquilibriumSet saddle = search_equilibria(well, {{-0.5, -1}, {0.5, 1}});
  EXPECT_EQ(saddle.degree, -1);
  EXPECT_TRUE(saddle.accounts());
}

TEST(EquilibriumSearch, NamesEachPointOnce) {
  // The grid finds all three before the search in cells does; none is another's image in the origin.
  const PlanarField well = field_of([](const Vector2d& y) {
    const double x = y(0) - 0.4;
    return Vector2d(y(1) - 0.3, x - x * x * x - 0.2 * (y(1) - 0.3));
  });
  const EquilibriumSet found = search_equilibria(well, {{-2, -2}, {2, 2}});
  ASSERT_EQ(found.points.size(), 3U);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT((found.points[static_cast<std::size_t>(i)].state - Vector2d(-0.6 + i, 0.3)).norm(), 1e-9) << i;
  EXPECT_EQ(found.index_sum, 1);
  EXPECT_TRUE(found.accounts());
}

TEST(EquilibriumSearch, SaysWhatItCannotTell) {
  // x' = v, v' = -v: a line of equilibria, of which some are shown.
  const EquilibriumSet line = search_equilibria(
      field_of([](const Vector2d& y) { return Vector2d(y(1), -y(1)); }), {{-1, -1}, {1, 1}});
  EXPECT_FALSE(line.points.empty());
  EXPECT_FALSE(line.index_sum);
  EXPECT_FALSE(line.accounts());
  // One on the border.
  const EquilibriumSet edge = search_equilibria(
      field_of([](const Vector2d& y) { return Vector2d(y(0) - 1, y(1)); }), {{-1, -1}, {1, 1}});
  EXPECT_FALSE(edge.degree);
  EXPECT_FALSE(edge.accounts());
}

}  // namespace
}  // namespace hmax
