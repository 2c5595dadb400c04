#include "analysis/dynamics/poincare.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "analysis/dynamics/fixed_point_search.hpp"
#include "core/parallel_for.hpp"
#include "tests/core/jobs.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

/// m x'' + c x' + k1 x + k3 x^3 = P cos(w t)
struct Driven {
  using State = Vector2d;
  double m = 1, c = 0, k1 = 0, k3 = 0, P = 0, w = 1;

  static Eigen::Index dim() { return 2; }
  void rhs(double t, const State& y, State& f) const {
    f << y(1), (P * std::cos(w * t) - c * y(1) - k1 * y(0) - k3 * y(0) * y(0) * y(0)) / m;
  }
  double period() const { return 2 * std::numbers::pi / w; }
};

VectorFunction map_of(const Driven& system) { return period_map(system, system.period()); }

/// x = Re(Z e^{i w t}), Z = P / (k1 - m w^2 + i c w): at t = 0 x = Re Z and v = -w Im Z.
TEST(Poincare, ALinearSystemIsSeenAtOnePointOfItsSteadyState) {
  for (const double w : {0.3, 0.7, 2.0}) {
    const Driven liver{.m = 1.45, .c = 0.6, .k1 = 0.7, .P = 0.5, .w = w};
    const std::complex<double> Z = 0.5 / std::complex<double>(0.7 - 1.45 * w * w, 0.6 * w);
    const Vector2d steady(Z.real(), -w * Z.imag());
    const auto seen = looks(map_of(liver), Vector2d(0.5, 1), 100, 40);
    ASSERT_EQ(seen.size(), 40U);
    for (const VectorXd& y : seen) EXPECT_LT((y - steady).norm(), 1e-9) << w;
    EXPECT_EQ(period_of(seen), 1);
    // The only fixed point of the map, with the multipliers exp(lambda T).
    const auto fixed = search_fixed_points(map_of(liver), {Vector2d(-3, -3), Vector2d(3, 3)}).points;
    ASSERT_EQ(fixed.size(), 1U);
    EXPECT_LT((fixed[0].state - steady).norm(), 1e-9);
    const std::complex<double> lambda(-0.6 / 2.9, std::sqrt(0.7 / 1.45 - std::pow(0.6 / 2.9, 2)));
    EXPECT_NEAR(std::abs(fixed[0].multipliers[0]), std::exp(lambda.real() * liver.period()), 1e-9);
  }
}

/// Both eigenvalues of the underdamped system have the real part -c / (2 m).
TEST(Poincare, TheExponentOfALinearSystemIsItsDamping) {
  const Driven liver{.m = 1.45, .c = 0.1, .k1 = 0.7, .P = 0.5, .w = 0.9};
  const Exponent exponent = largest_lyapunov(map_of(liver), Vector2d(0, 0), Vector2d(1, 1));
  EXPECT_NEAR(exponent.value / liver.period(), -0.1 / 2.9, 1e-3);
  EXPECT_NEAR(exponent.value / liver.period(), -0.1 / 2.9, exponent.error / liver.period());
}

/// Over a period of 125 s neighbours part as exp(-0.69 * 125), which no two doubles tell.
TEST(Poincare, NeighboursThatMeetGiveABound) {
  const Driven liver{.m = 1.45, .c = 2, .k1 = 0.7, .P = 0.5, .w = 0.05};
  const VectorXd start = looks(map_of(liver), Vector2d(0, 0), 20, 1)[0];
  const Exponent exponent = largest_lyapunov(map_of(liver), start, Vector2d(1, 1));
  EXPECT_TRUE(exponent.at_most);
  EXPECT_GT(exponent.value, -1 / 1.45 * liver.period());
  EXPECT_LT(exponent.value, -15);
}

/// Ueda's x'' + 0.05 x' + x^3 = 7.5 cos t, the chaotic attractor of [ueda1979randomly].
TEST(Poincare, UedasOscillatorIsBoundedAndNeverRepeats) {
  const Driven ueda{.m = 1, .c = 0.05, .k3 = 1, .P = 7.5, .w = 1};
  const auto seen = looks(map_of(ueda), Vector2d(2.5, 0), 100, 1000);
  ASSERT_EQ(seen.size(), 1000U);
  for (const VectorXd& y : seen) {
    EXPECT_LT(std::abs(y(0)), 5);
    EXPECT_LT(std::abs(y(1)), 12);
  }
  EXPECT_FALSE(period_of(seen, 1e-3));
}

/// 0.1031 1/s: variational equations over 300,000 periods by a Runge-Kutta method of order 4, error 0.0004.
TEST(Poincare, TheExponentOfUedasOscillatorIsWithinItsError) {
  const Driven ueda{.m = 1, .c = 0.05, .k3 = 1, .P = 7.5, .w = 1};
  const VectorXd start = looks(map_of(ueda), Vector2d(0.5, 1), 200, 1)[0];
  const Exponent exponent = largest_lyapunov(map_of(ueda), start, Vector2d(3, 5));
  EXPECT_NEAR(exponent.value / ueda.period(), 0.1031, exponent.error / ueda.period() + 0.0004);
  EXPECT_LE(exponent.error, 0.02 * exponent.value);
  EXPECT_LT(exponent.count, 40'000);
  EXPECT_TRUE(exponent.positive());
}

TEST(Poincare, ASmallForceOnTheCubicSpringHasItsOwnPeriod) {
  const Driven liver{.m = 1.45, .c = 2, .k1 = 0.7, .k3 = 0.8, .P = 0.05, .w = 0.5};
  EXPECT_EQ(period_of(looks(map_of(liver), Vector2d(0.5, 1), 60, 40)), 1);
}

/// The diagram of map_at(value).
template <class MapAt>
std::vector<BifurcationColumn> diagram(const MapAt& map_at, const std::vector<double>& values,
                                       const VectorXd& y0, int skip, int count, bool follow,
                                       const std::function<bool(double)>& going = {}) {
  return bifurcation(one_by_one([&](std::size_t i) { return map_at(values[i]); }), values, y0, skip, count,
                     follow, going);
}

/// x -> r x (1 - x): one point up to r = 3, two up to 1 + sqrt(6), three in the window of 3.83, and the
/// exponent ln 2 at r = 4.
VectorFunction logistic(double r) {
  return [r](const VectorXd& x) -> VectorXd { return VectorXd::Constant(1, r * x(0) * (1 - x(0))); };
}

/// The same map in other units, where two points 7 % apart are less than a picometre apart.
TEST(Poincare, JudgesSmallMotionsAsLargeOnes) {
  const double unit = 1e-12;
  const auto judged = [unit](double r) {
    const VectorFunction map = [r, unit](const VectorXd& x) -> VectorXd {
      return unit * logistic(r)(x / unit);
    };
    return settle(map, looks(map, VectorXd::Constant(1, 0.3 * unit), 2000, 64), 64, {},
                  {1e-12 * unit, 1e-11 * unit});
  };
  EXPECT_EQ(judged(3.01).period, 2);
  EXPECT_EQ(judged(3.9).settling, Settling::chaotic);
}

TEST(Poincare, CountsThePeriodsOfTheLogisticMap) {
  const auto columns =
      diagram(logistic, {2.5, 3.2, 3.5, 3.83, 3.9, 4.5}, VectorXd::Constant(1, 0.3), 2000, 100, false);
  ASSERT_EQ(columns.size(), 6U);
  const std::optional<int> expected[] = {1, 2, 4, 3, std::nullopt, std::nullopt};
  for (std::size_t i = 0; i < columns.size(); ++i)
    EXPECT_EQ(columns[i].motion.period, expected[i]) << columns[i].value;
  EXPECT_NEAR(columns[0].motion.looks[7](0), 1 - 1 / 2.5, 1e-12);
  EXPECT_EQ(columns[4].motion.settling, Settling::chaotic);
  EXPECT_EQ(columns[5].motion.settling, Settling::diverges);  // it leaves for minus infinity
  EXPECT_LT(columns[5].motion.looks.size(), 100U);
}

TEST(Poincare, HasTheSameDiagramForAnyNumberOfThreads) {
  const auto points_by = [](std::size_t threads) {
    const Jobs those(threads);
    std::vector<double> points;
    for (const BifurcationColumn& column :
         diagram(logistic, {3.1, 3.5, 3.7, 3.8, 3.9, 4.0}, VectorXd::Constant(1, 0.3), 50, 20, false))
      for (const VectorXd& look : column.motion.looks) points.push_back(look(0));
    return points;
  };
  EXPECT_EQ(points_by(1), points_by(3));
}

TEST(Poincare, ADiagramThatEndsEarlyHasItsFirstColumns) {
  const auto columns_until = [](double end) {
    return diagram(logistic, {3.1, 3.2, 3.3, 3.4, 3.5}, VectorXd::Constant(1, 0.3), 50, 20, false,
                   [end](double share) { return share < end; });
  };
  const Jobs one(1);
  const auto columns = columns_until(0.4);
  ASSERT_EQ(columns.size(), 2U);
  EXPECT_EQ(columns[1].value, 3.2);
  const Jobs three(3);
  EXPECT_TRUE(columns_until(0).empty());
}

TEST(Poincare, MeasuresKnownExponents) {
  // The mean, and an error that is that of the mean, neither too small nor much too large.
  const auto expect_known = [](const Exponent& found, double expected) {
    EXPECT_NEAR(found.value, expected, 2 * found.error);
    EXPECT_LE(found.error, 0.02 * std::abs(expected) + 3e-3);
  };
  expect_known(largest_lyapunov(logistic(4), VectorXd::Constant(1, 0.3123), VectorXd::Ones(1)), std::log(2));
  // f'(x*) = 2 - r at the fixed point.
  const Exponent rest =
      largest_lyapunov(logistic(2.8), VectorXd::Constant(1, 1 - 1 / 2.8), VectorXd::Ones(1));
  EXPECT_NEAR(rest.value, std::log(0.8), 1e-5);
  EXPECT_LE(rest.error, 0.02 * std::log(1 / 0.8));
  const VectorFunction henon = [](const VectorXd& y) -> VectorXd {
    return Vector2d(1 - 1.4 * y(0) * y(0) + y(1), 0.3 * y(0));
  };
  expect_known(largest_lyapunov(henon, Vector2d(0.1, 0.1), Vector2d(1, 0.3)), 0.419);
}

/// (x, n) -> (exp(rate(n)) x, n + 1) at x = 0: neighbours part by `rate`, which falls after 9000
/// applications. In 5813 of them both halves agree.
TEST(Poincare, TheErrorOfAWeakExponentCoversAMotionThatSettlesSlowly) {
  constexpr double early = 0.0195, late = 0.0038;
  const VectorFunction settling = [](const VectorXd& y) -> VectorXd {
    return Vector2d(std::exp(y(1) < 9000 ? early : late) * y(0), y(1) + 1);
  };
  const Exponent exponent = largest_lyapunov(settling, Vector2d(0, 0), Vector2d(1, 1));
  EXPECT_NEAR(exponent.value, late, exponent.error);
  EXPECT_GT(exponent.count, 9000);
}

TEST(Poincare, KnowsWhatIsNeitherPeriodicNorChaotic) {
  // (x, v) -> (x + v, v) on the circle: neighbours part linearly, with no exponent.
  const VectorFunction shear = [](const VectorXd& y) -> VectorXd { return Vector2d(y(0) + y(1), y(1)); };
  EXPECT_FALSE(largest_lyapunov(shear, Vector2d(0.1, 0.2), Vector2d(1, 1)).positive());
  // Nor has a spring without damping, whose motion under a force never repeats.
  const Driven free{.m = 1.45, .c = 0, .k1 = 0.7, .k3 = 0.8, .P = 0.3, .w = 1.3};
  const Settled regular = settle(map_of(free), looks(map_of(free), Vector2d(0.5, 1), 200, 2000), 2000, {});
  EXPECT_EQ(regular.settling, Settling::unsettled);
  // A turn by an irrational angle fills a circle.
  const VectorFunction turned = [](const VectorXd& y) -> VectorXd {
    return Vector2d(std::cos(1.0) * y(0) - std::sin(1.0) * y(1), std::sin(1.0) * y(0) + std::cos(1.0) * y(1));
  };
  EXPECT_EQ(settle(turned, looks(turned, Vector2d(1, 0), 0, 64), 64, {}).settling, Settling::unsettled);
}

TEST(Poincare, ShowsTheWholeOrbitToWhomLooksOnce) {
  const VectorXd start = VectorXd::Constant(1, 0.3);
  const Settled motion = settle(logistic(3.5), looks(logistic(3.5), start, 0, 1), 1, {});
  EXPECT_EQ(motion.period, 4);
  EXPECT_EQ(motion.looks.size(), 4U);
  EXPECT_GT(motion.followed, 0);
}

/// Columns that a diagram of 64 looks after 200 periods took for chaos. Their periods are those of a
/// Runge-Kutta method of order 4 after 8000 periods.
TEST(Poincare, WaitsForChaosThatDoesNotLast) {
  const auto map_at = [](double P) { return map_of({.m = 1, .c = 0.05, .k3 = 1, .P = P, .w = 1}); };
  const auto columns = diagram(map_at, {5.305, 6.475, 6.525, 8.0, 7.5}, Vector2d(0.5, 1), 200, 64, false);
  const std::optional<int> expected[] = {4, 3, 6, 1, std::nullopt};
  for (std::size_t i = 0; i < columns.size(); ++i)
    EXPECT_EQ(columns[i].motion.period, expected[i]) << columns[i].value;
  EXPECT_EQ(columns[4].motion.settling, Settling::chaotic);
  EXPECT_EQ(columns[4].motion.looks.size(), 64U);
}

/// x -> -0.99 x alternates around zero: two looks later it is nearer to itself than one look later.
TEST(Poincare, TakesNoSlowApproachForAnotherPeriod) {
  const VectorFunction map = [](const VectorXd& x) -> VectorXd { return -0.99 * x + VectorXd::Ones(1); };
  for (int skip = 0; skip < 3000; skip += 50) {
    const auto period = period_of(looks(map, VectorXd::Zero(1), skip, 64));
    EXPECT_TRUE(!period || period == 1) << skip;
  }
  EXPECT_EQ(period_of(looks(map, VectorXd::Zero(1), 3000, 64)), 1);
}

TEST(Poincare, FollowsABranchThroughHysteresis) {
  // x -> x + 0.1 (p + x - x^3): two branches for small |p|.
  const auto map_at = [](double p) -> VectorFunction {
    return [p](const VectorXd& x) -> VectorXd {
      return VectorXd::Constant(1, x(0) + 0.1 * (p + x(0) - x(0) * x(0) * x(0)));
    };
  };
  const std::vector<double> values{1, 0.2, -0.2};
  const VectorXd low = VectorXd::Constant(1, -1);
  EXPECT_GT(diagram(map_at, values, low, 500, 5, true).back().motion.looks[0](0), 0.5);
  EXPECT_LT(diagram(map_at, values, low, 500, 5, false).back().motion.looks[0](0), -0.5);
}

TEST(Poincare, EndsWhereTheMotionDoes) {
  const Driven runaway{.m = 1, .c = -3, .k1 = 1, .k3 = 1, .P = 1, .w = 1};
  EXPECT_LT(looks(map_of(runaway), Vector2d(1, 1), 0, 200).size(), 200U);
  EXPECT_TRUE(std::isnan(largest_lyapunov(map_of(runaway), Vector2d(1, 1), Vector2d(1, 1)).value));
  EXPECT_FALSE(period_of({}));
  EXPECT_THROW(looks(logistic(3), VectorXd::Constant(1, 0.3), -1, 3), std::invalid_argument);
}

// How many motions other threads have finished by then depends on the machine.
TEST(Bifurcation, EndsWhereItsProgressSaysSo) {
  const auto columns_up_to_two_thirds = [] {
    return diagram(logistic, {1, 2, 3}, VectorXd::Constant(1, 0.3), 1, 1, false,
                   [&](double done) { return done < 0.5; });
  };
  const std::vector<BifurcationColumn> of_any_threads = columns_up_to_two_thirds();
  for (std::size_t i = 0; i < of_any_threads.size(); ++i)
    EXPECT_EQ(of_any_threads[i].value, static_cast<double>(i + 1));
  const OneThread alone;
  EXPECT_EQ(columns_up_to_two_thirds().size(), 2U);
}

// A chaotic motion takes tens of thousands of images: an interrupt does not wait for its end.
TEST(Bifurcation, EndsWithinAMotion) {
  const OneThread alone;
  int asked = 0;
  const auto columns =
      diagram(logistic, {3.9}, VectorXd::Constant(1, 0.3), 1, 1, false, [&](double) { return ++asked < 2; });
  EXPECT_TRUE(columns.empty());
}

}  // namespace
}  // namespace hmax
