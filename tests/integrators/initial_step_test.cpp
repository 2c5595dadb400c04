#include "integrators/initial_step.hpp"

#include <gtest/gtest.h>

#include "integrators/explicit/adaptive.hpp"
#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"
#include "tests/integrators/forced.hpp"

namespace hmax {
namespace {

using forced::Forced;
using forced::Switched;
using Vector = Eigen::VectorXd;

TEST(InitialStep, TakesTheLongestStepWhereNothingEverActs) {
  const RmsNorm<double> norm{1e-6, 1e-9};
  const Forced still{[](double) { return 0.0; }};
  EXPECT_EQ(hairer_initial_step(still, 0.0, Vector(Vector::Zero(1)), 5, norm, 10.0, 1.0), 1);
  EXPECT_EQ(matlab_initial_step(still, 0.0, Vector(Vector::Zero(1)), 5, 1e-6, 1e-9, 10.0, 1.0), 1);
}

TEST(InitialStep, EndsBeforeAForceBegins) {
  const RmsNorm<double> norm{1e-6, 1e-9};
  const Forced late{[](double s) { return s < 0.4 ? 0.0 : 1.0; }};
  for (const double direction : {1.0, -1.0}) {
    const Forced mirrored{[](double s) { return s > -0.4 ? 0.0 : 1.0; }};
    const double h = hairer_initial_step(direction > 0 ? late : mirrored, 0.0, Vector(Vector::Zero(1)), 5,
                                         norm, direction * 10, 1.0);
    EXPECT_GT(h, 0.1);
    EXPECT_LT(h, 0.4);
  }
}

TEST(LongestStep, IsATenthOfTheSpanUnlessItIsGiven) {
  EXPECT_EQ(longest_step(std::numeric_limits<double>::infinity(), -20.0), 2);
  EXPECT_EQ(longest_step(7.0, 20.0), 7);
  // y' = 0: every error is zero.
  const Forced still{[](double) { return 0.0; }};
  const auto steps = [&](double h_first, double h_max) {
    Vector y = Vector::Zero(1);
    const auto control =
        adaptive<tableaux::DormandPrince54>({.rtol = 1e-6, .atol = 1e-9, .h_first = h_first, .h_max = h_max});
    return integrate(Rk<tableaux::DormandPrince54, Vector>{}, still, Span<double>{0, 20}, y, control)
        .stats.steps;
  };
  constexpr double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(steps(0, none), 10);
  EXPECT_EQ(steps(0, 0.5), 40);
  EXPECT_EQ(steps(20, 20), 1);
}

TEST(Breakpoints, AreLandedOnBackwards) {
  const Switched system{};
  Vector y = Vector::Constant(1, system.end());
  const auto end = integrate(Rk<tableaux::DormandPrince54, Vector>{}, system, Span<double>{10, 0}, y,
                             adaptive<tableaux::DormandPrince54>({.rtol = 1e-9, .atol = 1e-12}));
  EXPECT_EQ(end.outcome, Outcome::reached_end);
  EXPECT_NEAR(y[0], 0, 1e-6);
}

TEST(Breakpoints, AreNotLandedOnByFixedSteps) {
  Vector y = Vector::Zero(1);
  std::vector<double> ends;
  const auto note = [&](const auto& view) { ends.push_back(view.t1()); };
  integrate(Rk<tableaux::Rk4, Vector>{}, Switched{}, Span<double>{0, 10}, y, FixedStep<double>(2), note);
  EXPECT_EQ(ends, (std::vector<double>{2, 4, 6, 8, 10}));
}

TEST(Breakpoints, ThatAreNotKnownAreNamedByTheRunThatFailsThere) {
  const Switched unknown{.height = 1e12, .knows = false};
  Vector y = Vector::Zero(1);
  const auto end = integrate(Rk<tableaux::DormandPrince54, Vector>{}, unknown, Span<double>{0, 10}, y,
                             adaptive<tableaux::DormandPrince54>({.rtol = 1e-14, .atol = 1e-14}));
  EXPECT_EQ(end.outcome, Outcome::step_too_small);
  EXPECT_NEAR(end.t, 3, 1e-12);
  EXPECT_EQ(end.note, jump_note);
}

TEST(Breakpoints, LimitTheAttemptsOfAllPiecesTogether) {
  Vector y = Vector::Zero(1);
  const auto end =
      integrate(Rk<tableaux::DormandPrince54, Vector>{}, Switched{}, Span<double>{0, 10}, y,
                adaptive<tableaux::DormandPrince54>({.rtol = 1e-6, .atol = 1e-9}), ObserveNothing{}, 12);
  EXPECT_EQ(end.outcome, Outcome::too_many_steps);
  EXPECT_EQ(end.stats.steps + end.stats.rejected, 12);
}

}  // namespace
}  // namespace hmax
