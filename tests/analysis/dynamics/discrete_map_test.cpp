#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "analysis/dynamics/fixed_point_search.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;

/// y' = y (1 - y)
double logistic_growth(double y) { return y * (1 - y); }

using LineMap = std::function<double(double)>;
LineMap euler(double h) {
  return [h](double y) { return y + h * logistic_growth(y); };
}
LineMap midpoint(double h) {
  return [h](double y) { return y + h * logistic_growth(y + h / 2 * logistic_growth(y)); };
}
LineMap heun(double h) {
  return [h](double y) {
    return y + h / 2 * (logistic_growth(y) + logistic_growth(y + h * logistic_growth(y)));
  };
}

/// (y, z) -> (Phi(y), 0): what a map of the line does in the plane, with a multiplier of 0 more.
PlanarMap in_plane(const LineMap& map) {
  return [map](const Vector2d& y) { return Vector2d(map(y(0)), 0); };
}
Window line(double lower, double upper) { return {{lower, -1}, {upper, 1}}; }

std::vector<FixedPoint> find_fixed_points(const LineMap& map, const Window& window = line(-2, 4)) {
  const auto points = search_fixed_points(in_plane(map), window).points;
  for (const FixedPoint& point : points) EXPECT_EQ(point.state(1), 0);
  return points;
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
    const auto found = find_fixed_points(euler(h));
    expect_near(states(found), {0, 1}, h);
    // 1 + h f'(y): 1 + h at 0, 1 - h at 1.
    EXPECT_NEAR(found[0].multipliers[0].real(), 1 + h, 1e-11);
    EXPECT_NEAR(found[1].multipliers[0].real(), 1 - h, 1e-11);
    EXPECT_EQ(found[0].type, EquilibriumType::saddle);
    EXPECT_EQ(found[1].type, h < 2 ? EquilibriumType::stable_node : EquilibriumType::saddle);
    for (const FixedPoint& point : found)
      EXPECT_FALSE(is_spurious(in_plane(logistic_growth), h, point.state, line(-2, 4)));
  }
}

/// y + (h/2) y (1 - y) = 0 or 1, besides y = 0 and y = 1: y = 2/h and y = 1 + 2/h.
TEST(DiscreteMap, TheMidpointRuleRestsInTwoPlacesWhereTheEquationDoesNot) {
  for (const double h : {0.9, 1.5, 2.5, 3.5}) {
    const auto found = find_fixed_points(midpoint(h));
    std::vector<double> expected{0, 1, 2 / h};
    if (1 + 2 / h <= 4) expected.push_back(1 + 2 / h);
    expect_near(states(found), expected, h);
    for (const FixedPoint& point : found) {
      const double y = point.state(0);
      EXPECT_EQ(is_spurious(in_plane(logistic_growth), h, point.state, line(-2, 4)),
                std::abs(y * (1 - y)) > 1e-9)
          << y;
      // 1 + h f'(z) (1 + (h/2) f'(y)) with z = y + (h/2) f(y).
      const double z = y + h / 2 * y * (1 - y);
      const double mu = 1 + h * (1 - 2 * z) * (1 + h / 2 * (1 - 2 * y));
      EXPECT_NEAR(point.multipliers[0].real(), mu, 1e-10) << y;
    }
  }
}

/// f(y) + f(y + h f(y)) = 0: h^2 y^2 - h (h + 2) y + h + 2 = 0, real from h = 2 on.
TEST(DiscreteMap, HeunsRuleGainsTwoFixedPointsBeyondItsLimit) {
  expect_near(states(find_fixed_points(heun(1.9), line(-0.4, 2))), {0, 1}, 1.9);
  for (const double h : {2.1, 2.6}) {
    const double root = std::sqrt(h * h - 4);
    expect_near(states(find_fixed_points(heun(h), line(-0.4, 2))),
                {0, 1, (h + 2 - root) / (2 * h), (h + 2 + root) / (2 * h)}, h);
  }
}

/// The same equation for Euler's rule, whose multiplier is 5 - h^2.
TEST(DiscreteMap, EulersRuleGoesBackAndForthBeyondItsLimit) {
  EXPECT_TRUE(find_period_two(in_plane(euler(1.9)), line(-2, 4)).empty());
  for (const double h : {2.1, 2.4, 2.5, 3.0}) {
    const auto found = find_period_two(in_plane(euler(h)), line(-2, 4));
    ASSERT_EQ(found.size(), 1U) << h;
    const double root = std::sqrt(h * h - 4);
    EXPECT_NEAR(found[0].states[0](0), (h + 2 - root) / (2 * h), 1e-11);
    EXPECT_NEAR(found[0].states[1](0), (h + 2 + root) / (2 * h), 1e-11);
    EXPECT_NEAR(found[0].multipliers[0].real(), 5 - h * h, 1e-9);
    EXPECT_EQ(found[0].type, h * h < 6 ? EquilibriumType::stable_node : EquilibriumType::saddle);
  }
}

/// Henon's map (1 - a x^2 + y, b x): fixed points a x^2 + (1 - b) x - 1 = 0; points of period two
/// a^2 x^2 - a (1 - b) x + (1 - b)^2 - a = 0.
TEST(DiscreteMap, FindsThePointsOfHenonsMap) {
  const double a = 1.4, b = 0.3;
  const PlanarMap henon = [=](const Vector2d& y) { return Vector2d(1 - a * y(0) * y(0) + y(1), b * y(0)); };
  const Window box{{-2, -1}, {2, 1}};
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
  EXPECT_EQ(type({-1, 0.5}), "degenerate");
}

TEST(DiscreteMap, SortsMultipliersByTheirModulus) {
  const Multipliers mu = multipliers_of(Vector2d(0.5, -2).asDiagonal());
  EXPECT_NEAR(mu[0].real(), -2, 1e-14);
  EXPECT_NEAR(mu[1].real(), 0.5, 1e-14);
}

TEST(DiscreteMap, PassesOverPlacesWhereTheStepDiverges) {
  const LineMap map = [](double y) { return y > 0.3 ? std::nan("") : y * y; };
  expect_near(states(find_fixed_points(map, line(-1, 2))), {0}, 0);
  const LineMap nowhere = [](double) { return std::nan(""); };
  EXPECT_TRUE(find_fixed_points(nowhere).empty());
  EXPECT_TRUE(find_period_two(in_plane(nowhere), line(-2, 4)).empty());
}

TEST(DiscreteMap, APointThatIsZeroBesideALargeBoxIsZero) {
  // A double point: Newton's steps halve the way to it, and end at the root of rounding.
  const PlanarMap map = [](const Vector2d& y) { return Vector2d(y(0) + 1e-6 * y(0) * y(0), 0.5 * y(1)); };
  const Window box{{-1e6, -1e6}, {1.1e6, 1.2e6}};
  const auto found = newton_fixed_point(map, box, Vector2d(2e4, 1e4));
  ASSERT_TRUE(found);
  EXPECT_EQ(*found, Vector2d(0, 0));
}

TEST(DiscreteMap, RefusesAnEmptyBox) {
  EXPECT_THROW(find_fixed_points(euler(1), line(1, 1)), std::invalid_argument);
  EXPECT_THROW(find_period_two(in_plane(euler(1)), line(1, std::nan(""))), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
