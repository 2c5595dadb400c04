#include "problems/oscillator/oscillator_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "problems/oscillator/liver_problems.hpp"
#include "problems/oscillator/oscillator_exact.hpp"

namespace hmax {
namespace {

const Eigen::Vector2d start{0.5, 1};

/// Largest difference in the maximum norm between the reference as doubles and the exact solution.
double worst_error(const OscillatorReference& reference, const ExactSolution& exact) {
  double worst = 0;
  for (int i = 0; i <= 5000; ++i) {
    const double t = reference.valid_until() * i / 5000;
    const ExactSolution::ExtendedState difference = reference.at(t).cast<long double>() - exact.extended(t);
    worst = std::max(worst, static_cast<double>(difference.cwiseAbs().maxCoeff()));
  }
  return worst;
}

// From a 128-bit Taylor series with the parameters as doubles, which is what every precision here solves.
// With the exact decimals 1.45, 0.7, 0.8 the digits are -3.3690941329057441755e-01, 1.5203434594206605961e-01
// at t = 10 and 7.0445266812877351929e-02, 2.2236913561942911964e-01 at t = 100.
TEST(OscillatorReference, FullModelMeetsDigitsComputedIn128Bits) {
  const auto& full = liver_problem("liver_forced");
  const OscillatorReference reference(full.parameters, full.y0, 100);
  EXPECT_TRUE(reference.complete());
  EXPECT_EQ(reference.valid_until(), 100);
  EXPECT_NEAR(reference.at(10)[0] / -3.3690941329057442645442e-01, 1, 1.2e-16);
  EXPECT_NEAR(reference.at(10)[1] / 1.5203434594206605790830e-01, 1, 1.2e-16);
  EXPECT_NEAR(reference.at(100)[0] / 7.0445266812877343281785e-02, 1, 1.2e-16);
  EXPECT_NEAR(reference.at(100)[1] / 2.2236913561942912197090e-01, 1, 1.2e-16);
  EXPECT_LT(reference.error_bound(), 3e-16);
}

TEST(OscillatorReference, BoundHoldsAgainstExactSolutionsAndIsNotIdle) {
  const OscillatorParameters cases[] = {
      {1.45, 0.3, 5.3, 0, 0, 0},   {1.45, 2, 0.7, 0, 0.5, 0.5}, {1.45, 10, 0.7, 0, 0.5, 0.5},
      {1, 2, 1, 0, 0, 0},          {1, 0, 4, 0, 0.5, 2},        {1.45, -0.2, 0.7, 0, 0.5, 0.5},
      {1.45, 0, 0.7, 0.8, 0, 0},   {1, 0, -1, 1, 0, 0},         {1, 0, 1, -0.1, 0, 0},
      {1.45, 6, 5.3, 0, 0.5, 0.5}, {1, 0, 10, 5, 0, 0},         {1, 0, 0, 0, 0, 0},
  };
  for (const auto& p : cases) {
    const OscillatorReference reference(p, start, 100);
    ASSERT_TRUE(reference.complete());
    const double error = worst_error(reference, *exact_solution(p, start));
    EXPECT_LE(error, reference.error_bound()) << "c " << p.c << " k1 " << p.k1 << " k3 " << p.k3;
    EXPECT_LT(reference.error_bound(), 3000 * error + 1e-15)
        << "c " << p.c << " k1 " << p.k1 << " k3 " << p.k3;
  }
}

TEST(OscillatorReference, EveryCaseOfTheStudyHasATightReference) {
  for (const auto& family : liver_families())
    for (const auto& [label, p] : family.members) {
      const OscillatorReference reference(p, family.y0, family.t_end);
      if (family.id == "timing" && p.c < 0) continue;  // grows without end, see below
      EXPECT_TRUE(reference.complete()) << family.id << " " << label;
      EXPECT_LT(reference.error_bound(), 1e-15 * (1 + reference.at(family.t_end).norm()))
          << family.id << " " << label;
    }
}

TEST(OscillatorReference, SelfExcitingCubicStopsBeforeItsFrequencyOutrunsTheBudget) {
  OscillatorParameters p;
  p.c = -2;
  const OscillatorReference reference(p, start, 100);
  EXPECT_FALSE(reference.complete());
  EXPECT_GT(reference.valid_until(), 5);
  EXPECT_LT(reference.valid_until(), 100);
  EXPECT_TRUE(reference.at(reference.valid_until()).allFinite());
  EXPECT_TRUE(std::isnan(reference.at(std::nextafter(reference.valid_until(), 200.0))[0]));
  EXPECT_LT(reference.error_bound(1), 1e-15);
  EXPECT_LE(reference.error_bound(1), reference.error_bound());
}

TEST(OscillatorReference, StopsWhereANegativeStiffnessBlowsUp) {
  // x'' = 2 x^3 with x(0) = v(0) = 1 has the solution x = 1 / (1 - t).
  const OscillatorReference reference({1, 0, 0, -2, 0, 0}, {1, 1}, 5);
  EXPECT_FALSE(reference.complete());
  EXPECT_NEAR(reference.valid_until(), 1, 1e-9);
  for (const double t : {0.3, 0.9, 0.99, 0.9999}) {
    const double x = static_cast<double>(1 / (1 - static_cast<long double>(t)));
    EXPECT_LE(std::abs(reference.at(t)[0] - x), reference.error_bound(t));
    EXPECT_NEAR(reference.at(t)[0] / x, 1, 1e-12);
  }
}

TEST(OscillatorReference, FollowsAPushFromRestAndStaysAtRestWithoutOne) {
  const OscillatorParameters pushed{1.45, 2, 0.7, 0, 0.5, 0.5};
  const OscillatorReference reference(pushed, {0, 0}, 100);
  EXPECT_LE(worst_error(reference, *exact_solution(pushed, {0, 0})), reference.error_bound());
  const OscillatorReference still({1, 0, 1, 1, 0, 0}, {0, 0}, 100);
  EXPECT_TRUE(still.complete());
  EXPECT_EQ(still.at(50), Eigen::Vector2d(0, 0));
}

TEST(OscillatorReference, EmptyIntervalHoldsTheInitialState) {
  const OscillatorReference reference({}, start, 0);
  EXPECT_TRUE(reference.complete());
  EXPECT_EQ(reference.at(0), start);
}

TEST(OscillatorReference, IsContinuousAndAnyOrderOfAccessGivesTheSame) {
  const auto& full = liver_problem("liver_forced");
  const OscillatorReference reference(full.parameters, full.y0, 100);
  Eigen::Vector2d before = reference.at(0);
  for (int i = 1; i <= 100000; ++i) {
    const Eigen::Vector2d now = reference.at(i * 1e-3);
    ASSERT_LT((now - before).norm(), 3e-3) << i;
    before = now;
  }
  EXPECT_TRUE(std::isnan(reference.at(-1e-300)[0]));
  EXPECT_TRUE(std::isnan(reference.at(std::nan(""))[0]));
}

TEST(OscillatorReference, RefusesStatesAndTimesThatAreNotFinite) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(OscillatorReference({}, {inf, 0}, 1), std::invalid_argument);
  EXPECT_THROW(OscillatorReference({}, start, inf), std::invalid_argument);
  EXPECT_THROW(OscillatorReference({}, start, -1), std::invalid_argument);
  EXPECT_THROW(OscillatorReference({.m = 0}, start, 1), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
