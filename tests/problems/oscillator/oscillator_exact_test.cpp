#include "problems/oscillator/oscillator_exact.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

using LongOscillator = BasicOscillator<long double>;

/// Largest |y' - f(t, y)| of a solution over [0, t_end], y' by an eighth-order central difference, relative
/// to the largest |f| met.
double residual(const ExactSolution& solution, const OscillatorParameters& p, long double t_end) {
  const LongOscillator system(p);
  const long double h = 2e-3L;
  long double largest = 0, scale = 1;
  for (int i = 0; i <= 200; ++i) {
    const long double t = t_end * i / 200;
    const auto pair = [&](int k) -> LongOscillator::State {
      return solution.extended(t + k * h) - solution.extended(t - k * h);
    };
    const LongOscillator::State slope =
        (pair(1) * (4.0L / 5) - pair(2) / 5 + pair(3) * (4.0L / 105) - pair(4) / 280) / h;
    LongOscillator::State f;
    system.rhs(t, solution.extended(t), f);
    largest = std::max(largest, (slope - f).cwiseAbs().maxCoeff());
    scale = std::max(scale, f.cwiseAbs().maxCoeff());
  }
  return static_cast<double>(largest / scale);
}

struct Case {
  const char* what;
  OscillatorParameters p;
  Eigen::Vector2d y0;
};

const std::vector<Case> linear_cases{
    {"underdamped", {1.45, 0.3, 5.3, 0, 0, 0}, {0.5, 1}},
    {"linear part of the full model", {1.45, 2, 0.7, 0, 0, 0}, {0.5, 1}},
    {"critical", {1, 2, 1, 0, 0, 0}, {0.5, 1}},
    {"overdamped", {1.45, 10, 0.7, 0, 0, 0}, {0.5, 1}},
    {"undamped", {1.45, 0, 0.7, 0, 0, 0}, {0.5, 1}},
    {"negative damping", {1.45, -0.2, 0.7, 0, 0, 0}, {0.5, 1}},
    {"strong negative damping", {1.45, -4, 0.7, 0, 0, 0}, {0.5, 1}},
    {"negative stiffness", {1.45, 1, -0.7, 0, 0, 0}, {0.5, 1}},
    {"no stiffness", {1.45, 2, 0, 0, 0, 0}, {0.5, 1}},
    {"free particle", {1.45, 0, 0, 0, 0, 0}, {0.5, 1}},
    {"forced", {1.45, 2, 0.7, 0, 0.5, 0.5}, {0.5, 1}},
    {"forced, overdamped", {1.45, 10, 0.7, 0, 0.5, 0.5}, {0.5, 1}},
    {"constant force", {1.45, 2, 0.7, 0, 0.5, 0}, {0.5, 1}},
    {"resonance", {1, 0, 4, 0, 0.5, 2}, {0.5, 1}},
    {"almost resonance", {1, 1e-12, 4, 0, 0.5, 2 + 1e-11}, {0.5, 1}},
    {"falling particle", {2, 0, 0, 0, 1, 0}, {0.5, 1}},
    {"forced, negative damping", {1.45, -0.2, 0.7, 0, 0.5, 0.5}, {0, 0}},
};

const std::vector<Case> cubic_cases{
    {"hardening", {1.45, 0, 0.7, 0.8, 0, 0}, {0.5, 0}},
    {"hardening, general phase", {1.45, 0, 0.7, 0.8, 0, 0}, {0.5, 1}},
    {"hardening, negative start", {1.45, 0, 0.7, 0.8, 0, 0}, {-0.3, -2}},
    {"from the equilibrium", {1.45, 0, 0.7, 0.8, 0, 0}, {0, 1}},
    {"purely cubic", {1.45, 0, 0, 0.8, 0, 0}, {0.5, 1}},
    {"barely cubic", {1.45, 0, 0.7, 1e-17, 0, 0}, {0.5, 1}},
    {"large", {1.45, 0, 0.7, 0.8, 0, 0}, {5, -3}},
    {"double well, over the hump", {1, 0, -1, 1, 0, 0}, {0.5, 1}},
    {"double well, right side", {1, 0, -1, 1, 0, 0}, {1.2, 0.2}},
    {"double well, left side", {1, 0, -1, 1, 0, 0}, {-0.8, 0.3}},
    {"double well of another mass, right side", {2, 0, -3, 5, 0, 0}, {1, 0.2}},
    {"double well of another mass, left side", {2, 0, -3, 5, 0, 0}, {-0.6, 0.1}},
    {"double well, at rest", {1, 0, -1, 1, 0, 0}, {1, 0}},
    {"softening", {1, 0, 1, -0.5, 0, 0}, {0.5, 0.6}},
    {"softening, other side", {1, 0, 1, -0.5, 0, 0}, {-0.9, -0.2}},
};

TEST(ExactSolution, SatisfiesTheDifferentialEquationAndItsInitialState) {
  for (const auto* cases : {&linear_cases, &cubic_cases})
    for (const auto& [what, p, y0] : *cases) {
      const auto solution = exact_solution(p, y0);
      ASSERT_TRUE(solution) << what;
      EXPECT_LT(((*solution)(0) - y0).norm(), 3e-16 * (1 + y0.norm())) << what;
      EXPECT_LT(residual(*solution, p, 20), 1e-14) << what;
    }
}

TEST(ExactSolution, UndampedCubicKeepsItsEnergy) {
  for (const auto& [what, p, y0] : cubic_cases) {
    const LongOscillator system(p);
    const auto solution = *exact_solution(p, y0);
    const long double energy = system.energy(y0.cast<long double>());
    for (int i = 0; i <= 1000; ++i)
      EXPECT_NEAR(static_cast<double>(system.energy(solution.extended(0.1L * i)) / energy), 1, 1e-16)
          << what << " at t = " << 0.1 * i;
  }
}

// From a 128-bit Taylor series with the parameters as doubles, which is what every precision here solves
// (with the exact decimals 1.45, 0.7, 0.8 the digits are 2.1434567032889537e-01, -3.3936534136465546e-01).
// Period: 4 K(M) / Om.
TEST(ExactSolution, UndampedCubicMeetsDigitsComputedIn128Bits) {
  const auto solution = *exact_solution({1.45, 0, 0.7, 0.8, 0, 0}, {0.5, 0});
  EXPECT_NEAR(solution(100)[0], 2.1434567032889557635864e-01, 3e-17);
  EXPECT_NEAR(solution(100)[1], -3.3936534136465539656923e-01, 6e-17);
  const Eigen::Vector2d after_a_period = solution(8.2117669353012381);
  EXPECT_NEAR(after_a_period[0], 0.5, 1e-15);
  EXPECT_NEAR(after_a_period[1], 0, 1e-15);
}

TEST(ExactSolution, TextbookLinearFormulasHold) {
  const auto critical = *exact_solution({1, 2, 1, 0, 0, 0}, {0.5, 1});
  const auto free = *exact_solution({1, 0, 4, 0, 0, 0}, {0.5, 1});
  const auto resonant = *exact_solution({1, 0, 4, 0, 0.5, 2}, {0, 0});
  for (const double t : {0.1, 1.0, 7.0, 30.0}) {
    EXPECT_NEAR(critical(t)[0], (0.5 + 1.5 * t) * std::exp(-t), 1e-15);
    EXPECT_NEAR(free(t)[0], 0.5 * std::cos(2 * t) + 0.5 * std::sin(2 * t), 1e-14);
    EXPECT_NEAR(resonant(t)[0], 0.5 * t * std::sin(2 * t) / 4, 1e-14);
  }
}

TEST(ExactSolution, SteadyStateRemainsWhenTheTransientIsGone) {
  const OscillatorParameters p{1.45, 2, 0.7, 0, 0.5, 0.5};
  const double t = 300;
  const double a = p.k1 - p.m * p.w * p.w;
  const double b = p.c * p.w;
  const double x = p.P * (a * std::cos(p.w * t) + b * std::sin(p.w * t)) / (a * a + b * b);
  EXPECT_NEAR((*exact_solution(p, {0.5, 1}))(t)[0], x, 1e-15);
}

TEST(ExactSolution, IsContinuousAcrossCriticalDamping) {
  for (const double P : {0.0, 0.5})
    for (const double t : {0.5, 5.0, 50.0}) {
      const auto at = [&](double c) { return (*exact_solution({1, c, 1, 0, P, 0.5}, {0.5, 1})).extended(t); };
      for (const double distance : {1e-15, 1e-12, 1e-9, 1e-6}) {
        // To first order in the distance the solution is linear in c: the mean of both sides is the middle.
        const LongOscillator::State bend = (at(2 - distance) + at(2 + distance)) / 2 - at(2);
        EXPECT_LT(static_cast<double>(bend.norm()), 1e-16 + 10 * distance * distance) << distance << " " << t;
        const LongOscillator::State jump = at(2 + distance) - at(2);
        EXPECT_LT(static_cast<double>(jump.norm()), 1e-16 + 3 * distance) << distance << " " << t;
      }
    }
}

TEST(ExactSolution, StiffOverdampingNeitherOverflowsNorLosesTheSlowRoot) {
  // Roots -1e6 and about -1e-6: x decays as e^(-1e-6 t) from its start.
  const auto solution = *exact_solution({1, 1e6, 1, 0, 0, 0}, {1, 0});
  const Eigen::Vector2d y = solution(1e6);
  EXPECT_NEAR(y[0] / std::exp(-1.0), 1, 3e-12);
  EXPECT_NEAR(y[1] / (-1e-6 * std::exp(-1.0)), 1, 3e-12);
}

TEST(ExactSolution, IsAbsentWhereThereIsNone) {
  EXPECT_FALSE(exact_solution({}, {0.5, 1}));
  EXPECT_FALSE(exact_solution({1.45, 2, 0.7, 0.8, 0, 0}, {0.5, 1}));
  EXPECT_FALSE(exact_solution({1, 0, 1, -0.5, 0, 0}, {2, 0}));   // beyond the barrier
  EXPECT_FALSE(exact_solution({1, 0, -1, -0.5, 0, 0}, {1, 0}));  // no well at all
  EXPECT_THROW(exact_solution({-1, 0, 1, 0, 0, 0}, {1, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
