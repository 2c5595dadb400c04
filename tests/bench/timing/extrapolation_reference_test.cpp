#include "bench/timing/extrapolation_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"
#include "tests/problems/test_set.hpp"

namespace hmax {
namespace {

using Quad = long double;
using enum ExtrapolatedRule;

template <class Problem>
ExtrapolationReference reference_of(const Problem& problem, double t_end, ExtrapolatedRule rule) {
  return {BasicAnySystem<Quad>(problem), problem.y0(), t_end, rule};
}

/// The end state agrees with the published one, each component within the error that is claimed for it
/// (relative to the component itself or to the largest one) and the reference's own.
template <class Problem>
void expect_published_end(ExtrapolatedRule rule, bool componentwise) {
  const Problem problem;
  const auto reference = reference_of(problem, Problem::t_end, rule);
  ASSERT_EQ(reference.valid_until(), Problem::t_end);
  const auto y = reference.extended_at(Problem::t_end);
  Quad largest = 0;
  for (const Quad value : Problem::end_point) largest = std::max(largest, std::abs(value));
  for (Eigen::Index i = 0; i < problem.dim(); ++i) {
    const Quad published = Problem::end_point[static_cast<std::size_t>(i)];
    const Quad size = componentwise ? std::abs(published) : largest;
    const Quad own = reference.relative_error_at_end()[i] * std::abs(y[i]);
    EXPECT_LE(std::abs(y[i] - published), Problem::end_point_error * size + own)
        << Problem::id << " " << static_cast<double>(y[i]);
    EXPECT_LE(own, 3e-13L * size) << Problem::id;
  }
}

TEST(ExtrapolationReference, ReachesThePublishedEndPointsOfStiffProblems) {
  expect_published_end<VanDerPol<Quad>>(implicit_euler, true);
  expect_published_end<Robertson<Quad>>(implicit_euler, true);
  expect_published_end<Hires<Quad>>(implicit_euler, true);
  expect_published_end<Oregonator<Quad>>(implicit_euler, true);
}

TEST(ExtrapolationReference, ReachesThePublishedEndPointsOfProblemsThatAreNotStiff) {
  expect_published_end<Pleiades<Quad>>(explicit_midpoint, false);
  expect_published_end<Arenstorf<Quad>>(explicit_midpoint, false);
}

TEST(ExtrapolationReference, ReachesEndPointsOfABetterComputation) {
  expect_published_end<Lorenz<Quad>>(explicit_midpoint, false);
  const Brusselator<Quad> problem;
  for (const ExtrapolatedRule rule : {explicit_midpoint, implicit_euler}) {
    const auto y = reference_of(problem, problem.t_end, rule).extended_at(problem.t_end);
    EXPECT_NEAR(static_cast<double>(y[38] / problem.end_point_middle[0]), 1, problem.end_point_error + 1e-15);
    EXPECT_NEAR(static_cast<double>(y[39] / problem.end_point_middle[1]), 1, problem.end_point_error + 1e-15);
  }
}

/// The bound holds against the exact solution at the engine's steps and between them.
template <class Problem>
void expect_bound(const Problem& problem, double t_end, ExtrapolatedRule rule) {
  const auto reference = reference_of(problem, t_end, rule);
  ASSERT_EQ(reference.valid_until(), t_end) << Problem::id;
  for (int i = 0; i <= 100; ++i) {
    const double t = t_end * (i / 100.0) * (i / 100.0);
    const Quad error = (reference.extended_at(t) - problem.exact(t, problem.y0())).cwiseAbs().maxCoeff();
    EXPECT_LE(static_cast<double>(error), reference.error_bound()) << Problem::id << " t = " << t;
  }
}

TEST(ExtrapolationReference, BoundHoldsAgainstExactSolutions) {
  expect_bound(Dahlquist<Quad>(), 10, explicit_midpoint);
  expect_bound(Dahlquist<Quad>({.lambda = -1e8}), 1e3, implicit_euler);
  expect_bound(Dahlquist<Quad>({.lambda = 2}), 10, explicit_midpoint);
  expect_bound(Kepler<Quad>(), 20, explicit_midpoint);
  expect_bound(Kepler<Quad>({.e = 0.99}), 20, explicit_midpoint);
  expect_bound(Kepler<Quad>(), 20, implicit_euler);
  expect_bound(ProtheroRobinson<Quad>({.lambda = -50}), 10, implicit_euler);
  expect_bound(ProtheroRobinson<Quad>(), 10, implicit_euler);
  expect_bound(SpringChain<Quad>(), 1, explicit_midpoint);
  expect_bound(SpringChain<Quad>({.n = 6, .c = 10}), 1, implicit_euler);
}

TEST(ExtrapolationReference, BothRulesAgreeWithinTheirBounds) {
  for (const double mu : {1.0, 20.0}) {
    const VanDerPol<Quad> problem({.mu = mu});
    const auto one = reference_of(problem, 50, explicit_midpoint),
               other = reference_of(problem, 50, implicit_euler);
    for (int i = 0; i <= 200; ++i) {
      const double t = 0.25 * i;
      EXPECT_LE((one.at(t) - other.at(t)).cwiseAbs().maxCoeff(), one.error_bound() + other.error_bound())
          << t;
    }
  }
}

TEST(ExtrapolationReference, KeepsInvariantsAlongTheWay) {
  const Pleiades<Quad> stars;
  const auto pleiades = reference_of(stars, 3, explicit_midpoint);
  const Arenstorf<Quad> satellite;
  const auto arenstorf = reference_of(satellite, satellite.t_end, explicit_midpoint);
  const Robertson<Quad> reaction;
  const auto robertson = reference_of(reaction, reaction.t_end, implicit_euler);
  for (int i = 1; i <= 20; ++i) {
    const Pleiades<Quad>::State y = pleiades.extended_at(0.15L * i);
    EXPECT_NEAR(static_cast<double>(stars.energy(y) / stars.energy(stars.y0())), 1, 1e-14);
    EXPECT_NEAR(static_cast<double>(stars.angular_momentum(y) / stars.angular_momentum(stars.y0())), 1,
                1e-14);
    const Arenstorf<Quad>::State z = arenstorf.extended_at(satellite.t_end * i / 20);
    EXPECT_NEAR(static_cast<double>(satellite.jacobi_constant(z) - satellite.jacobi_constant(satellite.y0())),
                0, 1e-13);
    EXPECT_NEAR(static_cast<double>(reaction.total(robertson.extended_at(std::pow(10.0L, i - 9)))), 1, 1e-15);
  }
}

/// dop_853 in long double, another engine that shares nothing with the reference.
template <class Problem>
void expect_dop_853_agrees(double t_end, double tolerance) {
  using State = typename Problem::State;
  const Problem problem;
  State y = problem.y0();
  const auto end = integrate(Rk<tableaux::Dop853, State>{}, problem, Span<Quad>{0, t_end}, y,
                             Adaptive<Quad, PiController>({1e-17L, 1e-17L}, tableaux::Dop853::error_order),
                             ObserveNothing{}, 1'000'000);
  ASSERT_EQ(end.outcome, Outcome::reached_end);
  const auto reference = reference_of(problem, t_end, explicit_midpoint);
  EXPECT_LE(static_cast<double>((y - reference.extended_at(t_end)).cwiseAbs().maxCoeff()),
            reference.error_bound() + tolerance)
      << Problem::id;
}

TEST(ExtrapolationReference, AgreesWithARungeKuttaMethodWhereNothingIsStiff) {
  expect_dop_853_agrees<Pleiades<Quad>>(3, 1e-12);
  expect_dop_853_agrees<Arenstorf<Quad>>(Arenstorf<Quad>::t_end, 1e-10);
  expect_dop_853_agrees<Lorenz<Quad>>(20, 1e-9);
  expect_dop_853_agrees<Kepler<Quad>>(20, 1e-14);
}

TEST(ExtrapolationReference, StopsBeforeASingularity) {
  struct BlowUp {  // y' = y^2, y(0) = 1: y = 1 / (1 - t)
    using State = Eigen::Matrix<Quad, 1, 1>;
    static Eigen::Index dim() { return 1; }
    static void rhs(Quad, const State& y, State& dydt) { dydt[0] = y[0] * y[0]; }
  };
  const ExtrapolationReference reference(BasicAnySystem<Quad>(BlowUp{}), BlowUp::State(1.0L), 3,
                                         explicit_midpoint);
  EXPECT_LE(reference.valid_until(), 1);
  EXPECT_GT(reference.valid_until(), 0.99);
  EXPECT_NEAR(reference.at(0.5)[0], 2, 1e-15);
  EXPECT_TRUE(std::isnan(reference.at(1.5)[0]));
}

/// Counts its evaluations.
struct CountedVanDerPol : VanDerPol<Quad> {
  using VanDerPol<Quad>::VanDerPol;
  inline static int evaluations = 0;
  void rhs(Quad t, const State& y, State& dydt) const {
    ++evaluations;
    VanDerPol<Quad>::rhs(t, y, dydt);
  }
};

TEST(ExtrapolationReference, StatesBetweenItsStepsCostAFewEvaluationsWhereNothingIsStiff) {
  const auto reference = reference_of(CountedVanDerPol({.mu = 1}), 10, implicit_euler);
  constexpr int states = 1000;
  CountedVanDerPol::evaluations = 0;
  for (int i = 1; i <= states; ++i) static_cast<void>(reference.extended_at(0.00999L * i));
  EXPECT_LT(CountedVanDerPol::evaluations, 300 * states) << "the shortest implicit step has some 1200";
}

TEST(ExtrapolationReference, IsLeftWhereItsWatchThrows) {
  struct Enough {};
  int steps = 0;
  const auto watch = [&] {
    if (++steps == 3) throw Enough{};
  };
  EXPECT_THROW(ExtrapolationReference(BasicAnySystem<Quad>(Hires<Quad>()), Hires<Quad>().y0(), 300,
                                      implicit_euler, watch),
               Enough);
  EXPECT_EQ(steps, 3);
}

TEST(ExtrapolationReference, IsNaNOutsideItsIntervalAndTheStartAtItsEnd) {
  const Lorenz<Quad> problem;
  const auto reference = reference_of(problem, 0, explicit_midpoint);
  EXPECT_EQ(reference.extended_at(0), problem.y0());
  for (const double t : {-1e-300, 1e-300, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_TRUE(std::isnan(reference.at(t)[0])) << t;
}

TEST(ExtrapolationReference, RefusesWhatItCannotCompute) {
  struct NoJacobian {
    using State = Eigen::Matrix<Quad, 1, 1>;
    static Eigen::Index dim() { return 1; }
    static void rhs(Quad, const State& y, State& dydt) { dydt = y; }
  };
  const BasicAnySystem<Quad> system(NoJacobian{});
  const NoJacobian::State y(1.0L), nan(std::numeric_limits<Quad>::quiet_NaN());
  EXPECT_THROW(ExtrapolationReference(system, y, 1, implicit_euler), std::invalid_argument);
  EXPECT_THROW(ExtrapolationReference(system, y, -1, explicit_midpoint), std::invalid_argument);
  EXPECT_THROW(ExtrapolationReference(system, nan, 1, explicit_midpoint), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
