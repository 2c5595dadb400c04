#include "analysis/dynamics/phase_plane.hpp"

#include <cmath>
#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "analysis/dynamics/fixed_point_search.hpp"

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// m x'' + c x' + k1 x + k3 x^3 = 0, written here once more so that this test needs no other folder.
struct CubicOscillator {
  using State = Vector2d;
  double m = 1.45, c = 0, k1 = 0.7, k3 = 0.8;

  Eigen::Index dim() const { return 2; }
  void rhs(double, const State& y, State& f) const {
    f << y(1), -(c * y(1) + k1 * y(0) + k3 * y(0) * y(0) * y(0)) / m;
  }
  void jacobian(double, const State& y, Matrix2d& J) const {
    J << 0, 1, -(k1 + 3 * k3 * y(0) * y(0)) / m, -c / m;
  }
};

const Window near_origin{{-2, -2.5}, {2, 2.5}};

/// The only equilibrium of the liver oscillator with damping c.
Equilibrium liver(double c) {
  const auto found = find_equilibria(frozen_at(CubicOscillator{.c = c}), near_origin);
  EXPECT_EQ(found.size(), 1u);
  return found.at(0);
}

TEST(PhasePlane, ClassifiesTheFourPublishedDampings) {
  EXPECT_EQ(liver(-0.2).type, EquilibriumType::unstable_focus);
  EXPECT_EQ(liver(0).type, EquilibriumType::centre);
  EXPECT_EQ(liver(2).type, EquilibriumType::stable_focus);
  EXPECT_EQ(liver(10).type, EquilibriumType::stable_node);
  for (const double c : {-0.2, 0.0, 2.0, 10.0}) EXPECT_EQ(liver(c).state, Vector2d::Zero()) << c;
}

TEST(PhasePlane, EigenvaluesSolveTheCharacteristicEquationOfTheOscillator) {
  for (const double c : {-0.2, 0.0, 2.0, 10.0})
    for (const auto lambda : liver(c).eigenvalues)
      EXPECT_LT(std::abs(1.45 * lambda * lambda + c * lambda + 0.7), 2e-15 * (1 + c * c)) << c;
  // zeta = -Re(lambda) / |lambda| of c = 2.
  const auto lambda = liver(2).eigenvalues[0];
  EXPECT_NEAR(-lambda.real() / std::abs(lambda), 0.992583, 5e-7);
}

TEST(PhasePlane, ACentreNeedsDampingThatIsZeroToRounding) {
  EXPECT_EQ(liver(1e-9).type, EquilibriumType::stable_focus);
  EXPECT_EQ(liver(-1e-9).type, EquilibriumType::unstable_focus);
}

TEST(PhasePlane, CriticalDampingIsANode) {
  const double c = 2 * std::sqrt(1.45 * 0.7);
  EXPECT_EQ(liver(c).type, EquilibriumType::stable_node);
  EXPECT_EQ(liver(-c).type, EquilibriumType::unstable_node);
}

TEST(PhasePlane, StiffNodesKeepTheSmallEigenvalue) {
  // lambda^2 + 1e9 lambda + 1 = 0 has the root -1e-9 (1 + 1e-18), lost by T/2 + sqrt(T^2/4 - D).
  const auto lambda = eigenvalues_2x2((Matrix2d() << 0, 1, -1, -1e9).finished());
  EXPECT_NEAR(lambda[0].real(), -1e-9, 1e-23);
  EXPECT_NEAR(lambda[1].real(), -1e9, 1e-6);
}

TEST(PhasePlane, TheDoubleWellHasASaddleBetweenTwoFociInAnyWindow) {
  const PlanarField well = frozen_at(CubicOscillator{.c = 0.2, .k1 = -0.7, .k3 = 0.8});
  for (const double far : {2.5, 10.0, 1e6, 1e9}) {
    const auto found = find_equilibria(well, {{-far, -far}, {far, far}});
    ASSERT_EQ(found.size(), 3u) << far;
    for (const double side : {-1.0, 1.0}) {
      const Equilibrium& focus = found[side < 0 ? 0 : 2];
      EXPECT_EQ(focus.type, EquilibriumType::stable_focus) << far;
      EXPECT_NEAR(focus.state(0), side * std::sqrt(0.7 / 0.8), 1e-14) << far;
    }
    EXPECT_EQ(found[1].type, EquilibriumType::saddle) << far;
    EXPECT_EQ(found[1].state, Vector2d::Zero()) << far;
  }
}

TEST(PhasePlane, AFoldIsDegenerateInAnyWindow) {
  // x^2 - 2 x + 1, whose terms cancel at its double root.
  const PlanarField fold{[](const Vector2d& y) { return Vector2d(y(1), y(0) * y(0) - 2 * y(0) + 1); },
                         [](const Vector2d& y) { return (Matrix2d() << 0, 1, 2 * y(0) - 2, 0).finished(); }};
  for (const double far : {3.0, 1e3, 1e6, 1e9}) {
    const auto found = find_equilibria(fold, {{-far, -far}, {far, far}});
    ASSERT_FALSE(found.empty()) << far;
    for (const Equilibrium& e : found) {
      EXPECT_EQ(e.type, EquilibriumType::degenerate) << far;
      EXPECT_NEAR(e.state(0), 1, 1e-7) << far;
    }
  }
}

TEST(PhasePlane, ASpringWithoutLinearPartIsDegenerate) {
  const auto found = find_equilibria(frozen_at(CubicOscillator{.c = 0.5, .k1 = 0}), near_origin);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].type, EquilibriumType::degenerate);
  EXPECT_NEAR(found[0].state(0), 0, 1e-9);
}

TEST(PhasePlane, ARootThatNewtonReachesSlowlyIsOneAndDegenerate) {
  // Flat on one side of 0, steep on the other.
  const PlanarField field{
      [](const Vector2d& y) {
        return Vector2d(y(1), y(0) > 0 ? -std::pow(y(0), 4) - 0.7 * y(1) : std::sqrt(-y(0)) - 0.7 * y(1));
      },
      [](const Vector2d& y) {
        const double slope = y(0) > 0 ? -4 * std::pow(y(0), 3) : -0.5 / std::sqrt(-y(0));
        return (Matrix2d() << 0, 1, slope, -0.7).finished();
      }};
  const auto found = find_equilibria(field, {{-3, -3}, {3, 3}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].type, EquilibriumType::degenerate);
  EXPECT_NEAR(found[0].state(0), 0, 1e-5);
}

TEST(PhasePlane, ARootWhereTermsCancelIsOne) {
  // Centre and focus at 0, where v' is the difference of two numbers.
  for (const auto& [a, b] : {std::pair(0.87, 0.87), std::pair(0.5, 0.8)}) {
    const PlanarField field{
        [=](const Vector2d& y) {
          return Vector2d(y(1) + a * y(0), 1.1449 - (y(0) + 1.07) * (y(0) + 1.07) - b * y(1));
        },
        [=](const Vector2d& y) { return (Matrix2d() << a, 1, -2 * (y(0) + 1.07), -b).finished(); }};
    const auto found = find_equilibria(field, {{-0.1, -1}, {1, 1}});
    ASSERT_EQ(found.size(), 1u) << a;
    EXPECT_EQ(found[0].type, a == b ? EquilibriumType::centre : EquilibriumType::stable_focus) << a;
    EXPECT_EQ(found[0].state, Vector2d::Zero()) << a;
  }
}

TEST(PhasePlane, FindsBothEquilibriaOfLotkaVolterra) {
  // x' = x (1 - y), y' = y (x - 1): saddle at the origin, centre at (1, 1) although J(0,0) and J(1,1) are
  // differences.
  const PlanarField field{
      [](const Vector2d& y) { return Vector2d(y(0) * (1 - y(1)), y(1) * (y(0) - 1)); },
      [](const Vector2d& y) { return (Matrix2d() << 1 - y(1), -y(0), y(1), y(0) - 1).finished(); }};
  const auto found = find_equilibria(field, {{-0.53, -0.41}, {3.1, 2.9}});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].type, EquilibriumType::saddle);
  EXPECT_EQ(found[1].type, EquilibriumType::centre);
  EXPECT_LT((found[1].state - Vector2d(1, 1)).norm(), 1e-13);
}

TEST(PhasePlane, PointsThatNewtonPassesAreNoEquilibria) {
  // From far, its steps are shares of the way, and f is small beside the largest of the window.
  const auto field = [](auto f, auto slope) {
    return PlanarField{[=](const Vector2d& y) { return Vector2d(y(1), f(y(0)) - y(1)); },
                       [=](const Vector2d& y) { return (Matrix2d() << 0, 1, slope(y(0)), -1).finished(); }};
  };
  const auto ninth = [](double x) { return 1 - std::pow(x, 9); };
  const auto found =
      find_equilibria(field(ninth, [](double x) { return -9 * std::pow(x, 8); }), {{-1e4, -5}, {1e4, 5}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].type, EquilibriumType::stable_focus);
  EXPECT_NEAR(found[0].state(0), 1, 1e-14);
  const auto growth = [](double x) { return std::exp(x); };
  EXPECT_TRUE(find_equilibria(field(growth, growth), {{-20, -5}, {20, 5}}).empty());
}

TEST(PhasePlane, AFieldWithoutEquilibriaHasNone) {
  const PlanarField field{[](const Vector2d& y) { return Vector2d(1, y(0) * y(0) + 1); },
                          [](const Vector2d& y) { return (Matrix2d() << 0, 0, 2 * y(0), 0).finished(); }};
  EXPECT_TRUE(find_equilibria(field, near_origin).empty());
}

TEST(PhasePlane, NullclinesOfTheOscillatorAreTheAxisAndTheCubic) {
  const CubicOscillator liver{.c = 2};
  const PlanarField field = frozen_at(liver);
  const auto axis = nullcline(field, 0, near_origin);
  ASSERT_EQ(axis.size(), 1u);
  for (const Vector2d& p : axis[0]) EXPECT_NEAR(p(1), 0, 1e-12);
  const auto cubic = nullcline(field, 1, near_origin);
  ASSERT_EQ(cubic.size(), 1u);
  for (const Vector2d& p : cubic[0])
    EXPECT_NEAR(p(1), -(0.7 * p(0) + 0.8 * std::pow(p(0), 3)) / 2, 1e-3);  // v = -(k1 x + k3 x^3) / c
  // One unbroken curve from border to border: neighbours are at most a cell apart.
  for (std::size_t i = 1; i < cubic[0].size(); ++i) EXPECT_LT((cubic[0][i] - cubic[0][i - 1]).norm(), 0.05);
}

TEST(PhasePlane, AClosedNullclineIsStitchedToOneClosedCurve) {
  const PlanarField circle{[](const Vector2d& y) { return Vector2d(y.squaredNorm() - 1, y(0) * y(1)); }, {}};
  const auto closed = nullcline(circle, 0, near_origin);
  ASSERT_EQ(closed.size(), 1u);
  EXPECT_EQ(closed[0].front(), closed[0].back());
  for (const Vector2d& p : closed[0]) EXPECT_NEAR(p.norm(), 1, 1e-3);
  EXPECT_GE(nullcline(circle, 1, near_origin).size(), 2u);  // the two axes cross at the origin
}

TEST(PhasePlane, NullclinesStopWhereTheFieldIsNotFinite) {
  const PlanarField field{[](const Vector2d& y) { return Vector2d(y(1) + 0 / y(0) * std::sqrt(y(0)), 0); },
                          {}};
  const auto half = nullcline(field, 0, {{-1, -1.03}, {1, 1}}, 50);
  ASSERT_EQ(half.size(), 1u);
  for (const Vector2d& p : half[0]) EXPECT_GT(p(0), 0);
}

TEST(PhasePlane, ArrowsFollowTheFieldAndSkipTheEquilibrium) {
  const CubicOscillator liver{.c = 2};
  const Table arrows = direction_field(frozen_at(liver), {{-1, -1}, {1, 1}}, {"x [m]", "v [m/s]"}, 5, 5);
  EXPECT_EQ(arrows.columns, (std::vector<std::string>{"x [m]", "v [m/s]", "dx [m]", "dv [m/s]"}));
  ASSERT_EQ(arrows.values.size(), 4u);
  EXPECT_EQ(arrows.values[0].size(), 24u);  // 25 points without the origin
  for (std::size_t i = 0; i < arrows.values[0].size(); ++i) {
    const Vector2d arrow(arrows.values[2][i], arrows.values[3][i]);
    Vector2d f;
    liver.rhs(0, {arrows.values[0][i], arrows.values[1][i]}, f);
    EXPECT_NEAR(arrow.normalized().dot(f.normalized()), 1, 1e-14);
  }
}

TEST(PhasePlane, TheWindowHoldsTheOrbitsAndIsSymmetricAboutZero) {
  const Table orbit{{}, {"t [s]", "x [m]", "v [m/s]"}, {{0, 1, 2}, {0.5, -0.25, NAN}, {0, 2, 1e300}}};
  const Window window = window_around({orbit}, "x [m]", "v [m/s]", {}, 0.1);
  EXPECT_NEAR(window.lower(0), -0.6, 1e-14);
  EXPECT_NEAR(window.upper(0), 0.6, 1e-14);
  EXPECT_NEAR(window.lower(1), -0.2, 1e-14);
  EXPECT_NEAR(window.upper(1), 2.2, 1e-14);
  EXPECT_THROW(window_around({orbit}, "x", "v [m/s]"), std::invalid_argument);
  EXPECT_THROW(window_around({}, "x", "v"), std::invalid_argument);
}

TEST(PhasePlane, BadWindowsAreRefused) {
  const PlanarField field = frozen_at(CubicOscillator{});
  EXPECT_THROW(find_equilibria(field, {{0, 0}, {0, 1}}), std::invalid_argument);
  EXPECT_THROW(find_equilibria(field, {{0, 0}, {1, NAN}}), std::invalid_argument);
  EXPECT_THROW(nullcline(field, 2, near_origin), std::invalid_argument);
  EXPECT_THROW(direction_field(field, near_origin, {"x", "v"}, 0, 3), std::invalid_argument);
}

TEST(PhasePlane, ARealEigenvalueHasItsDirection) {
  Eigen::Matrix2d J;
  J << 1, 2, 3, 2;  // -1 and 4
  for (const double lambda : {-1.0, 4.0}) {
    const Eigen::Vector2d d = eigenvector(J, lambda);
    EXPECT_NEAR(d.norm(), 1, 1e-15);
    EXPECT_LT((J * d - lambda * d).norm(), 1e-14) << lambda;
  }
}

/// x' = v, v' = f(x) - c v with f'(x).
PlanarField oscillator(std::function<double(double)> f, std::function<double(double)> slope, double c = 1) {
  return {[=](const Vector2d& y) { return Vector2d(y(1), f(y(0)) - c * y(1)); },
          [=](const Vector2d& y) { return (Matrix2d() << 0, 1, slope(y(0)), -c).finished(); }};
}

/// f(x) = -a x where x > 0, -b x elsewhere.
PlanarField kinked(double a, double b, double c = 1) {
  return oscillator([=](double x) { return -(x > 0 ? a : b) * x; },
                    [=](double x) { return -(x > 0 ? a : b); }, c);
}

PlanarField power(double root, int n) {
  return oscillator([=](double x) { return -std::pow(x - root, n); },
                    [=](double x) { return -n * std::pow(x - root, n - 1); });
}

Window square_of(double far) { return {{-far, -far}, {far, far}}; }

TEST(Equilibria, AMultipleZeroIsOneDegeneratePoint) {
  for (const double far : {1.03, 50.0, 1e4, 1e9})
    for (const double root : {0.0, 1.0})
      for (const int n : {2, 3, 5, 9}) {
        const auto found = search_equilibria(power(root, n), square_of(far));
        ASSERT_EQ(found.points.size(), 1U) << far << " " << root << " " << n;
        EXPECT_EQ(found.points[0].type, EquilibriumType::degenerate);
        EXPECT_NEAR(found.points[0].state(0), root, 1e-6);
        EXPECT_EQ(found.points[0].index, n % 2) << far << " " << n;
        EXPECT_TRUE(found.accounts());
      }
  // A saddle and a node in one, whose index is 0.
  const PlanarField saddle_node{
      [](const Vector2d& y) { return Vector2d(y(0) * y(0), -y(1)); },
      [](const Vector2d& y) { return (Matrix2d() << 2 * y(0), 0, 0, -1).finished(); }};
  const auto found = search_equilibria(saddle_node, square_of(1));
  ASSERT_EQ(found.points.size(), 1U);
  EXPECT_EQ(found.points[0].type, EquilibriumType::degenerate);
  EXPECT_EQ(found.points[0].index, 0);
}

/// (x - 1)^7 and its terms, which cancel to rounding within 0.01 of 1.
TEST(Equilibria, WhatRoundingHidesIsOneDegeneratePoint) {
  const auto expanded = [](double x) {
    return -(((((((x - 7) * x + 21) * x - 35) * x + 35) * x - 21) * x + 7) * x - 1);
  };
  const auto slope = [](double x) {
    return -((((((7 * x - 42) * x + 105) * x - 140) * x + 105) * x - 42) * x + 7);
  };
  for (const double far : {1.0, 1.1, 50.0, 1e4}) {
    const auto found = search_equilibria(oscillator(expanded, slope), square_of(far));
    ASSERT_EQ(found.points.size(), 1U) << far;
    EXPECT_EQ(found.points[0].type, EquilibriumType::degenerate) << far;
    EXPECT_NEAR(found.points[0].state(0), 1, 0.02) << far;
  }
}

TEST(Equilibria, PairsAreTwoDownToRounding) {
  for (const double far : {1.03, 50.0, 1e4, 1e9})
    for (const double apart : {1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
      const auto found = search_equilibria(oscillator([=](double x) { return (x - 1) * (x - 1 - apart); },
                                                      [=](double x) { return 2 * (x - 1) - apart; }),
                                           square_of(far));
      ASSERT_EQ(found.points.size(), 2U) << far << " " << apart;
      EXPECT_EQ(found.points[0].type, EquilibriumType::stable_node);
      EXPECT_EQ(found.points[1].type, EquilibriumType::saddle);
      EXPECT_NEAR(found.points[1].state(0) - found.points[0].state(0), apart, 1e-15);
      EXPECT_TRUE(found.accounts());
    }
  // Around zero, and what only nearly is one.
  const auto parabola = [](double above) {
    return oscillator([=](double x) { return x * x + above; }, [](double x) { return 2 * x; });
  };
  EXPECT_EQ(search_equilibria(parabola(-1e-18), square_of(1)).points.size(), 2U);
  EXPECT_TRUE(search_equilibria(parabola(1e-12), square_of(1)).points.empty());
}

/// Between two nodes a millionth of the window apart lies a saddle that no grid shows.
TEST(Equilibria, AThirdOneIsFoundBetweenTwo) {
  const auto field = oscillator([](double x) { return -x + 1e-6 * std::tanh(2e6 * x); },
                                [](double x) { return -1 + 2 / std::pow(std::cosh(2e6 * x), 2); });
  const auto found = search_equilibria(field, {{-3.1, -2.2}, {2.7, 2.9}});
  ASSERT_EQ(found.points.size(), 3U);
  EXPECT_EQ(found.points[1].type, EquilibriumType::saddle);
  EXPECT_TRUE(found.accounts());
}

TEST(Equilibria, NoneIsListedOutsideTheWindow) {
  const auto count = [](int n, double upper) {
    const auto found = search_equilibria(power(1, n), {{-1, -1}, {upper, 1}});
    for (const Equilibrium& e : found.points) EXPECT_LE(e.state(0), upper);
    return found.points.size();
  };
  for (const int n : {1, 2, 3}) {
    EXPECT_EQ(count(n, 1), 1U) << n;
    EXPECT_EQ(count(n, 1 - 1e-9), 0U) << n;
  }
}

TEST(Equilibria, TailsThatNeverEndInAZeroHaveNone) {
  const auto exponential = [](double minus) {
    return oscillator([=](double x) { return std::exp(x) - minus; }, [](double x) { return std::exp(x); });
  };
  for (const double far : {5.0, 50.0, 500.0}) {
    const auto none = search_equilibria(exponential(0), square_of(far));
    EXPECT_TRUE(none.points.empty()) << far;
    EXPECT_TRUE(none.whole) << far;
    const auto one = search_equilibria(exponential(1), square_of(far));
    ASSERT_EQ(one.points.size(), 1U) << far;
    EXPECT_EQ(one.points[0].type, EquilibriumType::saddle);
    EXPECT_TRUE(one.accounts()) << far;
  }
}

/// Lines, straight and closed, and a stretch of one between two kinks.
TEST(Equilibria, LinesOfThemAreNotPoints) {
  const PlanarField line{[](const Vector2d& y) { return Vector2d(y(1), -y(1)); },
                         [](const Vector2d&) { return (Matrix2d() << 0, 1, 0, -1).finished(); }};
  const auto circle_and = [](double x, double v) {  // beside the circle a node
    const Vector2d node(x, v);
    return PlanarField{[node](const Vector2d& y) -> Vector2d { return (1 - y.squaredNorm()) * (y - node); },
                       [node](const Vector2d& y) -> Matrix2d {
                         return (1 - y.squaredNorm()) * Matrix2d::Identity() - 2 * (y - node) * y.transpose();
                       }};
  };
  const auto gap = oscillator([](double x) { return std::max(-0.5 - x, 0.0) - std::max(x - 0.5, 0.0); },
                              [](double x) { return std::abs(x) > 0.5 ? -1.0 : 0.0; });
  const auto off_centre = search_equilibria(circle_and(0, 0), {{0.5, 0.5}, {3, 3}});
  EXPECT_GT(off_centre.points.size(), 9U);
  EXPECT_FALSE(off_centre.whole);
  EXPECT_FALSE(search_equilibria(circle_and(0, 0), square_of(2)).whole);
  EXPECT_FALSE(search_equilibria(gap, {{-1000, -50}, {1100, 30}}).whole);
  for (const PlanarField& field : {line, circle_and(300, -200), gap})
    for (const double far : {1.1, 50.0}) {
      const auto found = search_equilibria(field, square_of(far));
      EXPECT_FALSE(found.points.empty());
      EXPECT_FALSE(found.whole);
      EXPECT_FALSE(found.index_sum);
      for (const Equilibrium& e : found.points)
        EXPECT_EQ(e.type, EquilibriumType::degenerate) << far << " " << e.state.transpose();
    }
  for (const Equilibrium& e : search_equilibria(line, near_origin).points) EXPECT_NEAR(e.state(1), 0, 1e-12);
}

TEST(Equilibria, ADegenerateOneHidesNoOther) {
  for (const int n : {2, 3})
    for (double d = 0.479; d > 1e-4; d /= 8) {
      const auto field = oscillator([=](double x) { return std::pow(x, n) * (d - x); },
                                    [=](double x) { return std::pow(x, n - 1) * (n * d - (n + 1) * x); });
      const auto found = search_equilibria(field, square_of(2));
      ASSERT_EQ(found.points.size(), 2U) << n << " " << d;
      EXPECT_EQ(found.points[0].type, EquilibriumType::degenerate);
      EXPECT_EQ(found.points[1].type, EquilibriumType::stable_node);
      EXPECT_NEAR(found.points[1].state(0), d, 1e-12);
      EXPECT_TRUE(found.accounts());
    }
}

/// A damper that touches from x = 0 on.
TEST(Equilibria, TheDegreeIsKnownWhereTheFieldJumps) {
  const PlanarField contact{
      [](const Vector2d& y) { return Vector2d(y(1), 9.81 - (y(0) > 0 ? 1e5 * y(0) + 50 * y(1) : 0)); },
      [](const Vector2d& y) {
        return (Matrix2d() << 0, 1, y(0) > 0 ? -1e5 : 0, y(0) > 0 ? -50 : 0).finished();
      }};
  const auto found = search_equilibria(contact, {{-0.01, -1}, {0.01, 1}});
  EXPECT_EQ(found.degree, 1);
  EXPECT_TRUE(found.accounts());
  EXPECT_EQ(found.points.size(), 1U);
}

/// Half turns of the two linear oscillators on both sides: pi / w of each, growing by -c / 2 in time.
TEST(Equilibria, AKinkHasTheTypeOfTheFieldAroundIt) {
  const auto at = [](const PlanarField& field, double far) {
    const auto found = search_equilibria(field, square_of(far));
    EXPECT_EQ(found.points.size(), 1U);
    EXPECT_TRUE(found.accounts());
    EXPECT_TRUE(found.points.at(0).kink);
    return found.points.at(0);
  };
  for (const double far : {1.03, 50.0, 1e6}) {
    const Equilibrium focus = at(kinked(1.5, 0.5), far);
    EXPECT_EQ(focus.type, EquilibriumType::stable_focus);
    EXPECT_NEAR(focus.eigenvalues[0].real(), -0.5, 1e-5);
    EXPECT_NEAR(focus.eigenvalues[0].imag(), 2 / (1 / std::sqrt(1.25) + 1 / std::sqrt(0.25)), 1e-5);
    EXPECT_EQ(at(kinked(1.5, 0.5, -0.1), far).type, EquilibriumType::unstable_focus);
    EXPECT_EQ(at(kinked(1.5, 0.5, 0), far).type, EquilibriumType::centre);
    for (const double stiff : {1e3, 1e6, 1e9}) {
      const Equilibrium contact = at(kinked(1 + stiff, 1, 0.1), far);
      EXPECT_EQ(contact.type, EquilibriumType::stable_focus);
      EXPECT_NEAR(contact.eigenvalues[0].real(), -0.05, 1e-4) << stiff;
      EXPECT_NEAR(contact.eigenvalues[0].imag(), 2 / (1 / std::sqrt(0.9975 + stiff) + 1 / std::sqrt(0.9975)),
                  1e-3)
          << stiff;
    }
    // v = s x of both sides are rays: s^2 + 4 s + 1.5 = 0, s^2 + 4 s + 0.5 = 0.
    const Equilibrium node = at(kinked(1.5, 0.5, 4), far);
    EXPECT_EQ(node.type, EquilibriumType::stable_node);
    EXPECT_NEAR(node.eigenvalues[0].real(), -2 + std::sqrt(3.5), 1e-5);
    EXPECT_NEAR(node.eigenvalues[1].real(), -2 - std::sqrt(3.5), 1e-5);
    EXPECT_EQ(at(kinked(-0.5, -1.5), far).type, EquilibriumType::saddle);
    EXPECT_EQ(at(kinked(-0.5, -1.5), far).index, -1);
    // -|x|: a saddle on the left, a focus on the right.
    const Equilibrium half = at(kinked(1, -1), far);
    EXPECT_EQ(half.type, EquilibriumType::degenerate);
    EXPECT_EQ(half.index, 0);
    // Critical on the left, where v = -2 x is a ray.
    const Equilibrium critical = at(kinked(1, 4, 4), far);
    EXPECT_EQ(critical.type, EquilibriumType::stable_node);
    EXPECT_NEAR(critical.eigenvalues[0].real(), -2 + std::sqrt(3), 1e-6);
    // On the left alone.
    EXPECT_EQ(at(kinked(9, 4, 4), far).type, EquilibriumType::stable_node);
    EXPECT_NEAR(at(kinked(9, 4, 4), far).eigenvalues[0].real(), -2, 1e-6);
  }
  for (const double tall : {1e-4, 1e4})
    EXPECT_EQ(search_equilibria(kinked(1, -1), {{-2, -2 * tall}, {2, 2 * tall}}).index_sum, 0) << tall;
}

/// v' = -x - c v with another c for each sign of v: damping that differs is seen beside a stiff spring.
TEST(Equilibria, AKinkOfTheDampingIsOne) {
  const auto damped = [](double k, double out, double in) {
    return PlanarField{
        [=](const Vector2d& y) { return Vector2d(y(1), -k * y(0) - (y(1) > 0 ? out : in) * y(1)); },
        [=](const Vector2d& y) { return (Matrix2d() << 0, 1, -k, y(1) > 0 ? -out : -in).finished(); }};
  };
  for (const double wide : {1e-3, 2.0}) {
    const auto stiff = search_equilibria(damped(1e6, -0.2, 1), {{-wide, -1}, {wide, 1}});
    EXPECT_EQ(stiff.points.at(0).type, EquilibriumType::stable_focus) << wide;
    EXPECT_TRUE(stiff.accounts());
    EXPECT_NEAR(stiff.points.at(0).eigenvalues[0].real(), -0.2, 1e-4);  // half of the mean of both
  }
  EXPECT_EQ(search_equilibria(damped(1, 0.1, 2), square_of(2)).points.at(0).type,
            EquilibriumType::stable_node);
}

/// x' = v, v' = -x - sign(v), and slopes that vanish like a logarithm: from far both look simple.
TEST(Equilibria, AJumpOrAVanishingSlopeIsDegenerate) {
  const PlanarField friction{[](const Vector2d& y) {
                               return Vector2d(y(1), -y(0) - (y(1) > 0 ? 1 : y(1) < 0 ? -1 : 0));
                             },
                             [](const Vector2d&) { return (Matrix2d() << 0, 1, -1, 0).finished(); }};
  const auto flat = oscillator([](double x) { return -x * std::log1p(x * x); },
                               [](double x) { return -std::log1p(x * x) - 2 * x * x / (1 + x * x); });
  for (const PlanarField& field : {friction, flat})
    for (const double far : {1.03, 50.0, 1e4}) {
      const auto found = search_equilibria(field, square_of(far));
      ASSERT_EQ(found.points.size(), 1U) << far;
      EXPECT_EQ(found.points[0].type, EquilibriumType::degenerate) << far;
    }
  EXPECT_EQ(search_equilibria(flat, square_of(1e9)).points.at(0).type, EquilibriumType::degenerate);
}

/// What is shifted or has other units has the same equilibria.
TEST(Equilibria, UnitsAndOriginDoNotMatter) {
  for (const double unit : {1e-9, 1.0, 1e9})
    for (const double force : {1e-9, 1.0, 1e9})
      for (const double shift : {0.0, 1e6}) {
        const PlanarField well{[=](const Vector2d& y) {
                                 const double x = y(0) / unit - shift;
                                 return Vector2d(y(1), unit * force * (x - x * x * x) - y(1));
                               },
                               [=](const Vector2d& y) {
                                 const double x = y(0) / unit - shift;
                                 return (Matrix2d() << 0, 1, force * (1 - 3 * x * x), -1).finished();
                               }};
        for (const double far : {2.0, 1e3, 1e6}) {
          const Vector2d middle(unit * shift, 0), reach(unit * far, unit * far);
          const auto found = search_equilibria(well, {middle - reach, middle + 1.1 * reach});
          ASSERT_EQ(found.points.size(), 3U) << unit << " " << force << " " << shift << " " << far;
          EXPECT_EQ(found.points[1].type, EquilibriumType::saddle);
          for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(found.points[static_cast<std::size_t>(i)].state(0) / unit, shift + i - 1, 1e-8);
          EXPECT_TRUE(found.accounts());
        }
      }
}

}  // namespace
}  // namespace hmax
