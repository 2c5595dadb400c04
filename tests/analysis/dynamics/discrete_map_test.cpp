#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "analysis/dynamics/fixed_point_search.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

VectorXd one(double value) { return VectorXd::Constant(1, value); }

/// y' = y (1 - y)
const VectorFunction logistic = [](const VectorXd& y) { return one(y(0) * (1 - y(0))); };

VectorFunction euler(double h) {
  return [h](const VectorXd& y) -> VectorXd { return y + h * logistic(y); };
}
VectorFunction midpoint(double h) {
  return [h](const VectorXd& y) -> VectorXd { return y + h * logistic(y + h / 2 * logistic(y)); };
}
VectorFunction heun(double h) {
  return [h](const VectorXd& y) -> VectorXd {
    return y + h / 2 * (logistic(y) + logistic(y + h * logistic(y)));
  };
}

const Box line{one(-2), one(4)};

/// (y, z) -> (Phi(y), 0): what a map of the line does in the plane.
VectorFunction in_plane(const VectorFunction& map) {
  return [map](const VectorXd& y) -> VectorXd { return Vector2d(map(y.head(1))(0), 0); };
}
Box in_plane(const Box& box) { return {Vector2d(box.lower(0), -1), Vector2d(box.upper(0), 1)}; }

/// Those of a map of the line, where z = 0 with a multiplier of 0.
std::vector<FixedPoint> find_fixed_points(const VectorFunction& map, const Box& box) {
  const FixedPointSearch found = search_fixed_points(in_plane(map), in_plane(box));
  std::vector<FixedPoint> points;
  for (const FixedPoint& point : found.points) {
    EXPECT_EQ(point.state(1), 0);
    points.push_back({point.state.head(1), {point.multipliers[0]}, classify_map({point.multipliers[0]})});
  }
  return points;
}
std::vector<PeriodTwo> find_period_two_of_line(const VectorFunction& map, const Box& box) {
  std::vector<PeriodTwo> orbits;
  for (const auto& [states, mu, type] : find_period_two(in_plane(map), in_plane(box)))
    orbits.push_back({{states[0].head(1), states[1].head(1)}, {mu[0]}, classify_map({mu[0]})});
  return orbits;
}

std::vector<double> states(const std::vector<FixedPoint>& points) {
  std::vector<double> values;
  for (const FixedPoint& point : points) values.push_back(point.state(0));
  return values;
}

void expect_near(const std::vector<double>& found, std::vector<double> expected, double h) {
  std::ranges::sort(expected);
  ASSERT_EQ(found.size(), expected.size()) << "h = " << h;
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-11) << "h = " << h;
}

TEST(DiscreteMap, EulersStepRestsWhereTheEquationRests) {
  for (const double h : {0.5, 1.9, 2.3}) {
    const auto found = find_fixed_points(euler(h), line);
    expect_near(states(found), {0, 1}, h);
    // 1 + h f'(y): 1 + h at 0, 1 - h at 1.
    EXPECT_NEAR(found[0].multipliers[0].real(), 1 + h, 1e-11);
    EXPECT_NEAR(found[1].multipliers[0].real(), 1 - h, 1e-11);
    EXPECT_EQ(found[0].type, EquilibriumType::unstable_node);
    EXPECT_EQ(found[1].type, h < 2 ? EquilibriumType::stable_node : EquilibriumType::unstable_node);
    for (const FixedPoint& point : found) EXPECT_FALSE(is_spurious(logistic, h, point.state, line));
  }
}

/// y + (h/2) y (1 - y) = 0 or 1, besides y = 0 and y = 1: y = 2/h and y = 1 + 2/h.
TEST(DiscreteMap, TheMidpointRuleRestsInTwoPlacesWhereTheEquationDoesNot) {
  for (const double h : {0.9, 1.5, 2.5, 3.5}) {
    const auto found = find_fixed_points(midpoint(h), line);
    std::vector<double> expected{0, 1, 2 / h};
    if (1 + 2 / h <= 4) expected.push_back(1 + 2 / h);
    expect_near(states(found), expected, h);
    for (const FixedPoint& point : found) {
      const double y = point.state(0);
      EXPECT_EQ(is_spurious(logistic, h, point.state, line), std::abs(y * (1 - y)) > 1e-9) << y;
      // 1 + h f'(z) (1 + (h/2) f'(y)) with z = y + (h/2) f(y).
      const double z = y + h / 2 * y * (1 - y);
      const double mu = 1 + h * (1 - 2 * z) * (1 + h / 2 * (1 - 2 * y));
      EXPECT_NEAR(point.multipliers[0].real(), mu, 1e-10) << y;
    }
  }
}

/// f(y) + f(y + h f(y)) = 0: h^2 y^2 - h (h + 2) y + h + 2 = 0, real from h = 2 on.
TEST(DiscreteMap, HeunsRuleGainsTwoFixedPointsBeyondItsLimit) {
  expect_near(states(find_fixed_points(heun(1.9), {one(-0.4), one(2)})), {0, 1}, 1.9);
  for (const double h : {2.1, 2.6}) {
    const double root = std::sqrt(h * h - 4);
    expect_near(states(find_fixed_points(heun(h), {one(-0.4), one(2)})),
                {0, 1, (h + 2 - root) / (2 * h), (h + 2 + root) / (2 * h)}, h);
  }
}

/// The same equation for Euler's rule, whose multiplier is 5 - h^2.
TEST(DiscreteMap, EulersRuleGoesBackAndForthBeyondItsLimit) {
  EXPECT_TRUE(find_period_two_of_line(euler(1.9), line).empty());
  for (const double h : {2.1, 2.4, 2.5, 3.0}) {
    const auto found = find_period_two_of_line(euler(h), line);
    ASSERT_EQ(found.size(), 1U) << h;
    const double root = std::sqrt(h * h - 4);
    EXPECT_NEAR(found[0].states[0](0), (h + 2 - root) / (2 * h), 1e-11);
    EXPECT_NEAR(found[0].states[1](0), (h + 2 + root) / (2 * h), 1e-11);
    EXPECT_NEAR(found[0].multipliers[0].real(), 5 - h * h, 1e-9);
    EXPECT_EQ(found[0].type, h * h < 6 ? EquilibriumType::stable_node : EquilibriumType::unstable_node);
  }
}

/// Henon's map (1 - a x^2 + y, b x): fixed points a x^2 + (1 - b) x - 1 = 0; points of period two
/// a^2 x^2 - a (1 - b) x + (1 - b)^2 - a = 0.
TEST(DiscreteMap, FindsThePointsOfHenonsMap) {
  const double a = 1.4, b = 0.3;
  const VectorFunction henon = [=](const VectorXd& y) -> VectorXd {
    return Vector2d(1 - a * y(0) * y(0) + y(1), b * y(0));
  };
  const Box box{Vector2d(-2, -1), Vector2d(2, 1)};
  const auto fixed = search_fixed_points(henon, box).points;
  ASSERT_EQ(fixed.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const double root = std::sqrt((1 - b) * (1 - b) + 4 * a);
    const double x = (-(1 - b) + (i == 0 ? -root : root)) / (2 * a);
    EXPECT_NEAR(fixed[i].state(0), x, 1e-12);
    EXPECT_NEAR(fixed[i].state(1), b * x, 1e-12);
    // mu^2 + 2 a x mu - b = 0
    for (const auto mu : fixed[i].multipliers) EXPECT_LT(std::abs(mu * mu + 2 * a * x * mu - b), 1e-10);
    EXPECT_EQ(fixed[i].type, EquilibriumType::saddle);
  }
  const auto two = find_period_two(henon, box);
  ASSERT_EQ(two.size(), 1U);
  const double root = std::sqrt(a * a * (1 - b) * (1 - b) - 4 * a * a * ((1 - b) * (1 - b) - a));
  EXPECT_NEAR(two[0].states[0](0), (a * (1 - b) - root) / (2 * a * a), 1e-12);
  EXPECT_NEAR(two[0].states[1](0), (a * (1 - b) + root) / (2 * a * a), 1e-12);
}

TEST(DiscreteMap, TellsTypesByTheUnitCircle) {
  using C = std::complex<double>;
  const auto type = [](const Multipliers& mu) { return name_of(classify_map(mu)); };
  EXPECT_EQ(type({0.5, -0.9}), "stable_node");
  EXPECT_EQ(type({-1.5, 0.5}), "saddle");
  EXPECT_EQ(type({-1.5, 3}), "unstable_node");
  EXPECT_EQ(type({C(0.5, 0.5), C(0.5, -0.5)}), "stable_focus");
  EXPECT_EQ(type({C(0.5, 1), C(0.5, -1)}), "unstable_focus");
  EXPECT_EQ(type({C(0.6, 0.8), C(0.6, -0.8)}), "centre");
  EXPECT_EQ(type({1, 0.5}), "degenerate");
  EXPECT_EQ(type({-1}), "degenerate");
}

TEST(DiscreteMap, SortsMultipliersByTheirModulus) {
  const MatrixXd D = Eigen::Vector3d(0.5, -2, 1).asDiagonal();
  const Multipliers mu = multipliers_of(D);
  EXPECT_NEAR(mu[0].real(), -2, 1e-14);
  EXPECT_NEAR(mu[2].real(), 0.5, 1e-14);
}

TEST(DiscreteMap, PassesOverPlacesWhereTheStepDiverges) {
  const VectorFunction map = [](const VectorXd& y) { return one(y(0) > 0.3 ? std::nan("") : y(0) * y(0)); };
  expect_near(states(find_fixed_points(map, {one(-1), one(2)})), {0}, 0);
  const VectorFunction nowhere = [](const VectorXd&) { return one(std::nan("")); };
  EXPECT_TRUE(find_fixed_points(nowhere, line).empty());
  EXPECT_TRUE(find_period_two_of_line(nowhere, line).empty());
}

TEST(DiscreteMap, APointThatIsZeroBesideALargeBoxIsZero) {
  // A double point: Newton's steps halve the way to it, and end at the root of rounding.
  const VectorFunction map = [](const VectorXd& y) -> VectorXd {
    return Vector2d(y(0) + 1e-6 * y(0) * y(0), 0.5 * y(1));
  };
  const Box box{Vector2d(-1e6, -1e6), Vector2d(1.1e6, 1.2e6)};
  const auto found = newton_fixed_point(map, box, Vector2d(2e4, 1e4));
  ASSERT_TRUE(found);
  EXPECT_EQ(*found, Vector2d(0, 0));
}

TEST(DiscreteMap, RefusesAnEmptyBox) {
  EXPECT_THROW(find_fixed_points(euler(1), {one(1), one(1)}), std::invalid_argument);
  EXPECT_THROW(find_period_two_of_line(euler(1), {one(1), one(std::nan(""))}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
