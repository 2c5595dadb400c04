/// What is known of the solutions of the test set: closed forms, spectra, invariants.
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "tests/problems/test_set.hpp"

namespace hmax {
namespace {

using test_set::dense;
using test_set::lively;
using test_set::states_of;
using Quad = long double;

/// The exact solution starts at y0 and satisfies the equation: y' by central differences of it is f(t, y).
template <class Problem>
void expect_solves(const Problem& problem, const typename Problem::State& start, std::vector<Quad> times,
                   Quad d, Quad tolerance) {
  using State = typename Problem::State;
  EXPECT_LT((problem.exact(0, start) - start).norm(), 1e-17L * start.norm());
  for (const Quad t : times) {
    const State y = problem.exact(t, start);
    State f = y;
    problem.rhs(t, y, f);
    // Differences of fourth order.
    const State slope = ((problem.exact(t + d, start) - problem.exact(t - d, start)) * 8 -
                         (problem.exact(t + 2 * d, start) - problem.exact(t - 2 * d, start))) /
                        (12 * d);
    EXPECT_LT((slope - f).norm(), tolerance * (1 + f.norm())) << "t = " << t;
  }
}

TEST(Dahlquist, ExactSolutionSatisfiesTheEquation) {
  expect_solves(Dahlquist<Quad>({.lambda = -3}), Dahlquist<Quad>::State(0.7L), {0.1L, 1, 5}, 1e-4L, 1e-13L);
}

TEST(ProtheroRobinson, ExactSolutionSatisfiesTheEquationFromAnyStart) {
  using Problem = ProtheroRobinson<Quad>;
  expect_solves(Problem({.lambda = -50}), Problem::State(1.5L), {0.01L, 0.1L, 3}, 1e-5L, 1e-11L);
  expect_solves(Problem(), Problem::y0(), {0.01L, 3, 10}, 1e-4L, 1e-9L);
  // Far from the start even an overflow of the exponential does not harm the smooth solution.
  EXPECT_EQ(Problem({.lambda = 1e6}).exact(10, Problem::y0())[0], std::cos(10.0L));
}

TEST(Kepler, ExactSolutionSatisfiesTheEquationAndComesBack) {
  using Problem = Kepler<Quad>;
  for (const double e : {0.0, 0.1, 0.6, 0.9, 0.99}) {
    const Problem problem({.e = e});
    expect_solves(problem, problem.y0(), {0.7L, 2, 3.2L, 19, 1234.5L}, 1e-4L, e < 0.95 ? 1e-10L : 1e-8L);
  }
  const Problem::State start(0.8L, -0.5L, 0.3L, 0.9L);  // neither at rest radially nor on an axis
  expect_solves(Problem(), start, {0.5L, 5, 50}, 1e-4L, 1e-11L);
  const Problem problem;
  const Quad period = 2 * std::numbers::pi_v<Quad>;
  // The double for sqrt((1 + e) / (1 - e)) is not the root itself, so the period is 2 pi only nearly.
  EXPECT_LT((problem.exact(period, problem.y0()) - problem.y0()).norm(), 1e-13L);
}

TEST(Kepler, ExactSolutionKeepsEnergyAndAngularMomentum) {
  using Problem = Kepler<Quad>;
  const Problem problem({.e = 0.9});
  const auto start = problem.y0();
  for (Quad t = 0; t < 30; t += 0.37L) {
    const auto y = problem.exact(t, start);
    EXPECT_NEAR(static_cast<double>(Problem::energy(y) / Problem::energy(start) - 1), 0, 1e-16) << t;
    EXPECT_NEAR(static_cast<double>(Problem::angular_momentum(y) / Problem::angular_momentum(start) - 1), 0,
                1e-16)
        << t;
  }
}

TEST(Kepler, ExactSolutionAfterManyTurnsOfALargeOrbitIsThatOfOne) {
  // A circle of radius 64: its period is 2 pi 64^(3/2), and after an odd number of halves the planet is
  // opposite.
  using Problem = Kepler<Quad>;
  const Problem::State start(64, 0, 0, 0.125L);
  const Quad half = 512 * std::numbers::pi_v<Quad>;
  for (const int turns : {1, 101, 10001})
    EXPECT_LT((Problem().exact(turns * half, start) + start).norm(), 1e-18L * turns * start.norm()) << turns;
}

TEST(Kepler, HasNoExactSolutionForStartsThatAreNoEllipse) {
  const Kepler<double> problem;
  EXPECT_TRUE(std::isnan(problem.exact(1, {1, 0, 0, 2})[0]));  // flies away
  EXPECT_TRUE(std::isnan(problem.exact(1, {1, 0, 0, 0})[0]));  // falls into the centre
}

TEST(SpringChain, ExactSolutionSatisfiesTheEquationUnderAndOverdamped) {
  using Problem = SpringChain<Quad>;
  for (const double c : {0.0, 0.05, 0.4, 10.0}) {
    const Problem problem({.n = 6, .c = c});
    const auto states = states_of(problem, 1);
    expect_solves(problem, states[0], {0.003L, 0.05L, 1}, 1e-6L, 1e-9L);
  }
  EXPECT_TRUE(std::isnan(Problem({.k3 = 1}).exact(1, Problem({.k3 = 1}).y0())[0]));
}

TEST(SpringChain, CriticallyDampedModeIsExactToo) {
  // c^2 kappa = 4 m k for the single mass, kappa = 2.
  using Problem = SpringChain<Quad>;
  const Problem problem({.n = 1, .m = 2, .k = 4, .c = 4});
  EXPECT_EQ(problem.eigenvalues()[0].imag(), 0);
  expect_solves(problem, problem.y0(), {0.1L, 1, 10}, 1e-4L, 1e-11L);
}

/// Largest distance from each of `some` to the nearest of `all`.
double farthest(const std::vector<std::complex<double>>& some, const Eigen::VectorXcd& all) {
  double worst = 0;
  for (const auto& one : some) worst = std::max(worst, (all.array() - one).abs().minCoeff());
  return worst;
}

TEST(SpringChain, EigenvaluesAreThoseOfItsJacobian) {
  for (const double c : {0.0, 0.05, 2.0}) {
    const SpringChain<double> problem({.n = 8, .c = c});
    SpringChain<double>::Jacobian J;
    problem.jacobian(0, problem.y0(), J);
    const Eigen::VectorXcd numeric = dense(J).eigenvalues();
    const auto known = problem.eigenvalues();
    ASSERT_EQ(static_cast<Eigen::Index>(known.size()), problem.dim());
    EXPECT_LT(farthest(known, numeric), 1e-9 * numeric.cwiseAbs().maxCoeff());
    std::complex<double> product = 1, determinant = 1;
    for (const auto& one : known) product *= one / 100.0;
    for (const auto& one : numeric) determinant *= one / 100.0;
    EXPECT_NEAR(std::abs(product / determinant), 1, 1e-9);
  }
}

template <class Problem>
void expect_bounded_spectrum(const Problem& problem, double at_most) {
  for (const auto& y : states_of(problem, 20)) {
    typename Problem::Jacobian J;
    problem.jacobian(0, y, J);
    const double radius = dense(J).eigenvalues().cwiseAbs().maxCoeff();
    EXPECT_GE(problem.spectral_radius(0, y), radius * (1 - 1e-12));
    EXPECT_LE(problem.spectral_radius(0, y), radius * at_most);
  }
}

TEST(SpectralRadius, IsAboveTheTrueOneAndNotIdle) {
  expect_bounded_spectrum(Dahlquist<double>({.lambda = -7}), 1 + 1e-12);
  expect_bounded_spectrum(ProtheroRobinson<double>(), 1 + 1e-12);
  expect_bounded_spectrum(Brusselator<double>(), 1.3);
  expect_bounded_spectrum(Brusselator<double>({.n = 5}), 10);
  expect_bounded_spectrum(SpringChain<double>(), 1.1);
  expect_bounded_spectrum(SpringChain<double>({.c = 3}), 1.1);
  expect_bounded_spectrum(SpringChain<double>({.n = 5, .k3 = 300}), 2);
  expect_bounded_spectrum(SpringChain<double>({.n = 5, .k3 = -3000}), 4);
}

TEST(Brusselator, DiffusionHasItsKnownSpectrum) {
  const Brusselator<double> problem({.n = 9});
  Brusselator<double>::Jacobian J;
  problem.jacobian_stiff(0, problem.y0(), J);
  const Eigen::VectorXcd numeric = dense(J).eigenvalues();
  std::vector<std::complex<double>> known;
  for (int j = 1; j <= 9; ++j)
    known.emplace_back(-4 * 0.02 * 100 * std::pow(std::sin(j * std::numbers::pi / 20), 2));
  EXPECT_LT(farthest(known, numeric), 1e-11);
}

TEST(Brusselator, RestsWhereReactionAndDiffusionVanish) {
  // u = A, v = B / A solves the reaction; with B = A v it meets the boundary too.
  const Brusselator<double> problem({.n = 4, .A = 1, .B = 3});
  Eigen::VectorXd y(8), dydt(8);
  y << 1, 3, 1, 3, 1, 3, 1, 3;
  problem.rhs(0, y, dydt);
  EXPECT_EQ(dydt, Eigen::VectorXd::Zero(8));
}

/// Of vectors that are longer than the state the rest is left alone.
template <class Problem>
void expect_to_touch_its_states_alone(const Problem& problem) {
  const Eigen::Index n = problem.dim();
  Eigen::VectorXd y = Eigen::VectorXd::LinSpaced(n + 4, 1, 2), dydt = Eigen::VectorXd::Constant(n + 4, 7);
  problem.rhs(0, y, dydt);
  EXPECT_EQ(dydt.tail(4), Eigen::VectorXd::Constant(4, 7));
  EXPECT_NE(dydt[n - 1], 7);
  if constexpr (requires { problem.rhs_nonstiff(0, y, dydt); }) {
    problem.rhs_nonstiff(0, y, dydt);
    EXPECT_EQ(dydt.tail(4), Eigen::VectorXd::Constant(4, 7));
  }
}

TEST(Brusselator, TouchesItsStatesAlone) { expect_to_touch_its_states_alone(Brusselator<double>({.n = 4})); }

/// d/dt of a function of the state along the flow, by central differences.
template <class Problem, class Function>
Quad rate(const Problem& problem, const typename Problem::State& y, const Function& function) {
  typename Problem::State f = y;
  problem.rhs(0, y, f);
  const Quad d = 1e-6L / (1 + f.norm());
  const typename Problem::State plus = y + d * f, minus = y - d * f;
  return (function(plus) - function(minus)) / (2 * d);
}

/// The same at several states, in units of the function's own size and of the speed of the flow.
template <class Problem, class Function>
void expect_invariant(const Problem& problem, const Function& function) {
  for (const auto& y : states_of(problem, 10)) {
    typename Problem::State f = y;
    problem.rhs(0, y, f);
    EXPECT_LT(std::abs(rate(problem, y, function)), 1e-11L * (1 + f.norm()) * (1 + std::abs(function(y))));
  }
}

TEST(Invariants, DoNotChangeAlongTheFlow) {
  using Planet = Kepler<Quad>;
  expect_invariant(Planet(), [](const Planet::State& y) { return Planet::energy(y); });
  expect_invariant(Planet(), [](const Planet::State& y) { return Planet::angular_momentum(y); });
  const Arenstorf<Quad> satellite;
  expect_invariant(satellite, [&](const auto& y) { return satellite.jacobi_constant(y); });
  using Stars = Pleiades<Quad>;
  expect_invariant(Stars(), [](const Stars::State& y) { return Stars::energy(y); });
  expect_invariant(Stars(), [](const Stars::State& y) { return Stars::angular_momentum(y); });
  const SpringChain<Quad> chain({.n = 5, .c = 0, .k3 = 40});
  expect_invariant(chain, [&](const auto& y) { return chain.energy(y); });
  using Reaction = Robertson<Quad>;
  expect_invariant(Reaction(), [](const Reaction::State& y) { return Reaction::total(y); });
}

TEST(SpringChain, EnergyFallsByThePowerOfTheDampers) {
  const SpringChain<Quad> chain({.n = 3, .c = 0.5, .k3 = 40});
  SpringChain<Quad>::State y(6);
  y << 0.1L, -0.2L, 0.3L, 1, 2, -1;
  // Stretch rates of the four dampers: 1, 1, -3, 1.
  EXPECT_NEAR(static_cast<double>(rate(chain, y, [&](const auto& s) { return chain.energy(s); })), -0.5 * 12,
              1e-8);
}

}  // namespace
}  // namespace hmax
