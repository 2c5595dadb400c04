/// The convergence monitor of simplified Newton, and the life of a Jacobian.
#include "integrators/implicit/newton.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/implicit/residual_rounding.hpp"
#include "integrators/stats.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {
namespace {

struct Iteration {
  NewtonEnd end;
  std::int64_t corrections;
  NewtonMemory<double> memory;
};

/// An iteration whose corrections have the given norms, and shrink on by the last ratio.
/// @param rounding  the norm of corrections that are rounding
Iteration iterate(std::vector<double> norms, NewtonMemory<double> memory = {}, double rounding = 0,
                  int limit = 7) {
  std::size_t k = 0;
  Iteration run{NewtonEnd::converged, 0, memory};
  const auto correct = [&] {
    const std::size_t last = norms.size() - 1;
    const double ratio = last > 0 ? norms[last] / norms[last - 1] : 1.0;
    const double norm = k <= last ? norms[k] : norms[last] * std::pow(ratio, static_cast<double>(k - last));
    ++k;
    return norm * norm;
  };
  run.end = iterate_newton(limit, run.memory, run.corrections, correct,
                           [&](bool estimate) { return estimate ? rounding : 0.0; });
  return run;
}

TEST(Newton, StopsWhenTheRestOfTheSeriesIsWithinTheTolerance) {
  // Corrections 100, 10, 1, ...: theta / (1 - theta) = 1/9, so 10 leaves 1.11 and 1 leaves 0.11.
  const Iteration run = iterate({100, 10});
  EXPECT_EQ(run.end, NewtonEnd::converged);
  EXPECT_EQ(run.corrections, 3);
  EXPECT_NEAR(run.memory.theta, 0.1, 1e-15);
  EXPECT_NEAR(run.memory.eta, 1.0 / 9, 1e-15);
}

TEST(Newton, JudgesTheFirstCorrectionByTheRateBefore) {
  EXPECT_EQ(iterate({100, 0}, {.eta = 1e-4}).corrections, 1);
  EXPECT_EQ(iterate({100, 0}, {.eta = 1}).corrections, 2);
}

TEST(Newton, BelievesNoFirstCorrectionWhenNothingIsKnown) {
  EXPECT_EQ(iterate({1e-9, 1e-12}).corrections, 2);
  EXPECT_EQ(iterate({1e-9, 2e-9}).end, NewtonEnd::diverged) << "small corrections that grow";
}

TEST(Newton, TrustsAnOldRateLessEachTime) {
  Iteration run = iterate({1e-3, 0}, {.eta = 1e-16});
  int alone = 0;
  for (; run.corrections == 1 && alone < 100; ++alone) run = iterate({100, 1}, run.memory);
  EXPECT_GT(alone, 5);
  EXPECT_LT(alone, 30);
}

TEST(Newton, SaysThatItDiverges) {
  const Iteration run = iterate({10, 20});
  EXPECT_EQ(run.end, NewtonEnd::diverged);
  EXPECT_EQ(run.corrections, 2);
}

TEST(Newton, SaysEarlyThatItIsTooSlow) {
  // 0.9^5 1000 / 0.1 is far from 1: two corrections are enough to know.
  const Iteration run = iterate({1000, 900});
  EXPECT_EQ(run.end, NewtonEnd::too_slow);
  EXPECT_EQ(run.corrections, 2);
  EXPECT_EQ(iterate({1000, 900}, {}, 0, 100).end, NewtonEnd::converged);
}

TEST(Newton, SaysThatACorrectionIsNotFinite) {
  EXPECT_EQ(iterate({std::numeric_limits<double>::quiet_NaN()}).end, NewtonEnd::not_finite);
  EXPECT_EQ(iterate({10, std::numeric_limits<double>::infinity()}).end, NewtonEnd::not_finite);
}

TEST(Newton, EndsWhereCorrectionsAreRounding) {
  EXPECT_EQ(iterate({3, 4}, {}, 10).end, NewtonEnd::converged);
  EXPECT_EQ(iterate({3, 4}, {}, 2).end, NewtonEnd::diverged);
}

TEST(Newton, TakesTheRateDownToRoundingForABoundOfTheRate) {
  // 20, then 4, which is rounding: at a rate of 1/5 the rest is 1/4 of the last correction.
  const Iteration run = iterate({20, 4}, {}, 5);
  EXPECT_EQ(run.end, NewtonEnd::converged);
  EXPECT_EQ(run.corrections, 2);
  EXPECT_NEAR(run.memory.eta, 0.25, 1e-15);
  EXPECT_NEAR(run.memory.error, 1, 1e-15);
}

TEST(Newton, TakesRatesBelowRoundingForNoConvergence) {
  // Corrections that hover at 400 after 1e9: neither convergence nor divergence, whatever their ratio.
  for (const double hovering : {380.0, 400.0, 410.0}) {
    const Iteration run = iterate({1e9, 1e6, 400, hovering}, {}, 500, 50);
    EXPECT_EQ(run.end, NewtonEnd::converged);
    EXPECT_EQ(run.corrections, 3);
    EXPECT_LT(run.memory.theta, 2e-3) << "the rate of the corrections that are no rounding";
  }
}

TEST(Newton, AsksForRoundingOnlyWhereTheConvergenceBreaksOff) {
  NewtonMemory<double> memory;
  std::int64_t count = 0;
  double norm = 1e8;
  const auto end = iterate_newton(
      7, memory, count, [&] { return std::pow(norm *= 1e-3, 2); },
      [](bool estimate) {
        EXPECT_FALSE(estimate);
        return 0.0;
      });
  EXPECT_EQ(end, NewtonEnd::converged);
}

/// z = s f(z) with f(z) = 4 z - z^3 of the potential z^4/4 - 2 z^2, s = 1: rest states 0, a saddle, and
/// +-sqrt 3. From 0.1 Newton's method ends at the saddle.
TEST(Newton, ContinuationEndsAtAMinimumOfThePotential) {
  double z = 0.1, r = 0;
  NewtonMemory<double> memory;
  std::int64_t count = 0;
  const auto end = continue_newton(
      10.0, memory, count,
      [&] {
        r = 4 * z - z * z * z - z;
        return std::abs(r);
      },
      [&](double mu) -> std::optional<double> {
        const double d = r / (1 + mu - (4 - 3 * z * z));
        z += d;
        return std::pow(d / 1e-15, 2);
      },
      [](bool) { return 0.0; });
  EXPECT_EQ(end, NewtonEnd::converged);
  EXPECT_NEAR(z, std::sqrt(3.0), 1e-14);
}

TEST(ResidualRounding, IsTheCorrectionThatRoundingOfTheForceMakes) {
  // f = -k (X + q) with k = 100, X = 1000: rounding of f is eps k X, whatever q.
  struct Offset {
    using State = Eigen::VectorXd;
    static Eigen::Index dim() { return 2; }
    static void rhs(double, const State& y, State& dydt) { dydt = -100 * y; }
    static void offset(State& X) { X = Eigen::Vector2d(1000, 0); }
  };
  ResidualRounding<Eigen::VectorXd> rounding;
  const Offset system;
  rounding.init(system);
  NewtonNorm<Eigen::VectorXd> norm;
  norm.init(2);
  const Eigen::VectorXd y = Eigen::Vector2d(1, 1), z = Eigen::Vector2d(0, 0);
  norm.prepare(system, y);
  const Eigen::MatrixXd J = -100 * Eigen::Matrix2d::Identity();
  const double s = 0.1;
  const auto solve = [&](Eigen::VectorXd& x) { x /= 1 + 100 * s; };
  EXPECT_EQ(rounding(system, false, J, 1, s, y, z, norm, solve), 0) << "not known yet";
  const double eps = std::numeric_limits<double>::epsilon();
  const double correction = s * eps * 100 * 1001 / (1 + 100 * s);  // against the unit 4 eps
  const double found = rounding(system, true, J, 1, s, y, z, norm, solve);
  EXPECT_NEAR(found, ResidualRounding<Eigen::VectorXd>::margin * correction / (4 * eps), 1e-9 * found);
  EXPECT_EQ(rounding(system, false, J, 1, s, y, z, norm, solve), found);
  EXPECT_EQ(rounding(system, false, J, 2, s, y, z, norm, solve), 0) << "another matrix";
  EXPECT_EQ(rounding(system, false, J, 1, s, 1e-6 * y, z, norm, solve), 0) << "smaller numbers";
}

TEST(NewtonNorm, MeasuresInAFractionOfTheTolerance) {
  NewtonNorm<Eigen::Vector2d> norm(0.1);
  norm.init(2);
  norm.set_tolerances(1e-3, 1e-6);
  norm.prepare(Oscillator(), {2, 0});
  EXPECT_NEAR(norm.squared(Oscillator(), {0.1 * (1e-6 + 2e-3), 0}, {2, 0}), 0.5, 1e-12);
  EXPECT_NEAR(norm.squared(Oscillator(), {0, 1e-7}, {2, 0}), 0.5, 1e-12);
}

TEST(NewtonNorm, MeasuresInRoundingWhereThereIsNoTolerance) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  NewtonNorm<Eigen::Vector2d> norm;
  norm.init(2);
  norm.prepare(Oscillator(), {-8, 0});
  EXPECT_NEAR(norm.squared(Oscillator(), {0, 32 * eps}, {1, 1}), 1, 1e-12);
  EXPECT_NEAR(norm.squared(Oscillator(), {0, 64 * eps}, {1, -16}), 1, 1e-12);
  norm.prepare(Oscillator(), {0, 0});
  EXPECT_EQ(norm.squared(Oscillator(), {0, 0}, {0, 0}), 0);
  EXPECT_TRUE(std::isnan(norm.squared(Oscillator(), {std::numeric_limits<double>::quiet_NaN(), 0}, {0, 0})));
}

TEST(NewtonNorm, NeverAsksForMoreThanRounding) {
  NewtonNorm<Eigen::Vector2d> norm;
  norm.init(2);
  norm.set_tolerances(1e-16, 1e-300);
  norm.prepare(Oscillator(), {1, 1});
  const Eigen::Vector2d rounding = Eigen::Vector2d::Constant(std::numeric_limits<double>::epsilon());
  EXPECT_LE(norm.squared(Oscillator(), rounding, {1, 1}), 1);
}

/// The Jacobians that `steps` accepted steps with a rate of convergence theta take.
std::int64_t jacobians(JacobianUpdate update, double theta, int steps) {
  Stats stats;
  const Counted<Oscillator> system(Oscillator(), stats);
  const Eigen::Vector2d y(0.5, 1);
  Linearisation<Eigen::Vector2d, Eigen::Matrix2d> jacobian;
  jacobian.set_update(update);
  jacobian.init(system);
  for (int n = 0; n < steps; ++n) {
    jacobian.begin(system, n, y);
    jacobian.begin(system, n, y);  // a second attempt at the same point
    jacobian.accept(theta);
  }
  return stats.jacobian;
}

TEST(Linearisation, TakesJacobiansAsTheUserDecides) {
  EXPECT_EQ(jacobians({1}, 0.5, 12), 12);
  EXPECT_EQ(jacobians({5}, 0.5, 12), 3);
  EXPECT_EQ(jacobians({JacobianUpdate::frozen}, 0.5, 12), 1);
}

TEST(Linearisation, RenewsTheJacobianWhenConvergenceWasSlow) {
  EXPECT_EQ(jacobians({}, 1e-6, 12), 1);
  EXPECT_EQ(jacobians({}, 0.5, 12), 12);
}

TEST(Linearisation, TurnsToAFreshJacobianOnceAndForgetsItWithoutAccept) {
  Stats stats;
  const Counted<Oscillator> system(Oscillator(), stats);
  const Eigen::Vector2d y(0.5, 1), later(0.1, 1);
  Linearisation<Eigen::Vector2d, Eigen::Matrix2d> jacobian;
  jacobian.init(system);
  jacobian.begin(system, 0, y);
  EXPECT_FALSE(jacobian.renew(system, 0, y)) << "it is of this very point";
  const Eigen::Matrix2d old = jacobian.matrix();
  const std::int64_t old_id = jacobian.id();
  jacobian.accept(0);

  for (int attempt = 0; attempt < 2; ++attempt) {
    jacobian.begin(system, 1, later);
    EXPECT_EQ(jacobian.matrix(), old);
    EXPECT_EQ(jacobian.id(), old_id);
    EXPECT_TRUE(jacobian.renew(system, 1, later));
    EXPECT_NE(jacobian.matrix(), old);
    EXPECT_NE(jacobian.id(), old_id);
    EXPECT_FALSE(jacobian.renew(system, 1, later));
  }
  EXPECT_EQ(stats.jacobian, 2);
  const Eigen::Matrix2d fresh = jacobian.matrix();
  jacobian.accept(0);
  jacobian.begin(system, 2, y);
  EXPECT_EQ(jacobian.matrix(), fresh);
}

TEST(Linearisation, LeavesAFrozenJacobianAlone) {
  const Oscillator system;
  const Eigen::Vector2d y(0.5, 1);
  Linearisation<Eigen::Vector2d, Eigen::Matrix2d> jacobian;
  jacobian.set_update({JacobianUpdate::frozen});
  jacobian.init(system);
  jacobian.begin(system, 0, y);
  jacobian.accept(0.9);
  jacobian.begin(system, 1, y);
  EXPECT_FALSE(jacobian.renew(system, 1, y));
}

/// The mu that equations without solution are tried with after an old Jacobian; 0 stands for the iteration.
std::vector<double> trials(const NewtonNorm<Eigen::Vector2d>& norm, JacobianUpdate update = {}) {
  const Oscillator system;
  const Eigen::Vector2d y(0.5, 1);
  Linearisation<Eigen::Vector2d, Eigen::Matrix2d> jacobian;
  jacobian.set_update(update);
  jacobian.init(system);
  jacobian.begin(system, 0, y);
  jacobian.accept(0);
  jacobian.begin(system, 1, y);
  NewtonMemory<double> memory;
  std::vector<double> mus;
  EXPECT_FALSE(
      solve_or_continue(jacobian, norm, memory, system, 1, y, first_mu, [&](std::optional<double> mu) {
        mus.push_back(mu.value_or(0));
        return false;
      }));
  return mus;
}

TEST(SolveOrContinue, ContinuesAtFixedStepsUnlessTheUserLimitsIterationsOrJacobians) {
  NewtonNorm<Eigen::Vector2d> norm;
  EXPECT_EQ(trials(norm), (std::vector<double>{0, 0, 1, 10, 100}));
  EXPECT_EQ(trials(norm, {JacobianUpdate::frozen}), std::vector<double>{0});
  norm.set({.iterations = 8});
  EXPECT_EQ(trials(norm), (std::vector<double>{0, 0}));
  norm.set({});
  norm.set_tolerances(1e-6, 1e-6);
  EXPECT_EQ(trials(norm), (std::vector<double>{0, 0}));
}

TEST(ShiftedSolver, FactorsOnlyWhatIsNew) {
  Eigen::Matrix2d J;
  J << 0, 1, -4, -1;
  ShiftedSolver<Eigen::Matrix2d, std::complex<double>> solver;
  solver.init(2);
  std::int64_t count = 0;
  const std::complex<double> s(0.3, -0.2);
  EXPECT_TRUE(solver.factor(J, 1, s, count) && solver.factor(J, 1, s, count));
  EXPECT_EQ(count, 1);
  Eigen::Vector2cd x(1, std::complex<double>(0, 2));
  const Eigen::Vector2cd b = x;
  solver.solve(x);
  EXPECT_LT((x - s * (J * x) - b).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_TRUE(solver.factor(J, 2, s, count) && solver.factor(J, 2, 0.5, count));
  EXPECT_EQ(count, 3);
}

TEST(ShiftedSolver, RemembersThatAMatrixIsSingular) {
  ShiftedSolver<Eigen::Matrix2d, double> solver;
  solver.init(2);
  std::int64_t count = 0;
  const Eigen::Matrix2d J = Eigen::Matrix2d::Identity();
  EXPECT_FALSE(solver.factor(J, 1, 1.0, count));
  EXPECT_FALSE(solver.factor(J, 1, 1.0, count));
  EXPECT_EQ(count, 1);
}

}  // namespace
}  // namespace hmax
