/// The motion by which steps are judged, its reference, and runs on it.
#include "advice/motion/probing_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <gtest/gtest.h>

#include "advice/advise.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/body.hpp"
#include "tests/advice/cube.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

TEST(ProbingMotion, PressesHoldsAndReleases) {
  const Problem problem = cube("press");
  const ProbingMotion motion = probing_motion(problem);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(motion.problem.body->dofs());
  const auto force = [&](const TissueBody& of, double t) {
    Eigen::VectorXd f(zero.size());
    of.force(t, zero, zero, f);
    return f.norm();
  };
  const double full = force(*problem.body, 0);
  ASSERT_GT(full, 0);
  const TissueBody& body = *motion.problem.body;
  EXPECT_EQ(force(body, 0), 0);
  EXPECT_NEAR(force(body, 0.05), 0.5 * full, 1e-12 * full);
  EXPECT_NEAR(force(body, 0.2), full, 1e-12 * full);
  EXPECT_EQ(force(body, 0.5), 0);
  // Beside elastic forces too, whose rounding a load that only cancels would change.
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(zero.size(), 1e-4, 3e-4);
  Eigen::VectorXd released(q.size()), alone(q.size());
  body.force(0.5, q, zero, released);
  with_settings(motion.problem, [](TissueSettings& settings) {
    settings.forces.clear();
  }).body->force(0.5, q, zero, alone);
  EXPECT_EQ(released, alone);
}

// 1e-17 m from rest the noise of a load that has gone is more than Newton's method solves.
TEST(Advise, HoldsImplicitStepsOfABodyThatHasComeToRest) {
  const Problem problem =
      make_problem("fem_neo_hookean/press@cube:n=2", {.parameters = {{"E", 1e7}, {"force", 0.5}}});
  const Advice advice = advise(problem, question(60, {"implicit_euler"}, problem));
  EXPECT_NE(advice.recommended(), nullptr) << advice.rows.front().status;
}

// Free stiffness has no inverse: 1e-15 N was made of it.
TEST(ProbingMotion, DeformsABodyThatNothingHoldsAndDoesNotCarryItAway) {
  const Problem problem = make_problem("fem_cauchy@cube:n=2", {.parameters = {{"support", 0}}});
  const ProbingMotion motion = probing_motion(problem);
  const TissueBody& body = *motion.problem.body;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.dofs());
  Eigen::VectorXd f(body.dofs());
  body.force(0.2, zero, zero, f);
  const auto by_points = f.reshaped(3, f.size() / 3);
  const Eigen::Vector3d net = by_points.rowwise().sum();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < by_points.cols(); ++i) {
    const Eigen::Vector3d x = body.mesh().points.col(body.free_points()[static_cast<std::size_t>(i)]);
    moment += x.cross(Eigen::Vector3d(by_points.col(i)));
  }
  EXPECT_GT(f.norm(), 0.01);
  EXPECT_LT(net.norm(), 1e-12 * f.norm());
  EXPECT_LT(moment.norm(), 1e-12 * f.norm());
  // Sides of 0.1 m: the diagonal is 0.173 m. A load that rises within a period sways beyond its equilibrium.
  const ReferenceMotion reference = reference_motion(motion, 0.01, 0.1);
  EXPECT_GT(reference.scale, 0.5 * 0.02 * 0.173);
  EXPECT_LT(reference.scale, 2.5 * 0.02 * 0.173);
  const Advice advice = advise(problem, question(60, {"rk4", "newmark"}, problem));
  ASSERT_NE(advice.recommended(), nullptr);
  EXPECT_NEAR(advice.scale, reference.scale, 0.3 * reference.scale);
}

TEST(ProbingMotion, PressesABodyUnderGravityFromItsEquilibrium) {
  const ProbingMotion motion = probing_motion(cube("gravity"));
  const TissueBody& body = *motion.problem.body;
  const Eigen::Index n = body.dofs();
  const Eigen::VectorXd q = motion.problem.y0.head(n), zero = Eigen::VectorXd::Zero(n);
  EXPECT_GT(q.norm(), 0);
  Eigen::VectorXd f(n), weight(n), pressed(n);
  body.force(0, q, zero, f);
  body.force(0, zero, zero, weight);
  EXPECT_LT(f.norm(), 1e-8 * weight.norm());
  body.force(0.2, q, zero, pressed);
  EXPECT_GT(pressed.norm(), 1e3 * f.norm());
}

TEST(ProbingMotion, HalvesALoadThatHasNoEquilibrium) {
  const ProbingMotion motion = probing_motion(cube("press", {{"force", 50}}));
  EXPECT_TRUE(says(motion.words, "equilibrium"));
  EXPECT_LT(motion.load_share, 1);
  EXPECT_EQ(motion.gravity_share, 1);
}

TEST(ProbingMotion, BeginsWithASmallShareOfTheLoadOfALargeBody) {
  const Problem problem = make_problem("fem_green/gravity@ball:n=8", {});
  ASSERT_GT(problem.body->dofs(), 5000);
  const RestingBody resting = resting_under_gravity(problem);
  const double share =
      resting.problem.body->settings().gravity.norm() / problem.body->settings().gravity.norm();
  EXPECT_GT(share, 0);
  EXPECT_LT(share, 1);
  EXPECT_TRUE(says(resting.words, "under which it has an equilibrium"));
  EXPECT_EQ(resting.share, share);
  // At rest there: the forces are those of rounding.
  Eigen::VectorXd f(problem.body->dofs()), start(problem.body->dofs());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(f.size());
  resting.problem.body->force(0, zero, zero, start);
  resting.problem.body->force(0, resting.problem.y0.head(f.size()), zero, f);
  EXPECT_LT(f.norm(), 1e-8 * start.norm());
}

TEST(ProbingMotion, TakesAsMuchOfALoadAsMovesTheBodyByTwoPercent) {
  const ProbingMotion motion = probing_motion(cube("press", {{"force", 1e6}}));
  const ReferenceMotion reference = reference_motion(motion, 0.01, 0.1);
  EXPECT_TRUE(says(motion.words, "2 %"));
  // Sides of 0.1 m: the diagonal is 0.173 m.
  EXPECT_GT(reference.scale, 0.5 * 0.02 * 0.173);
  EXPECT_LT(reference.scale, 2 * 0.02 * 0.173);
}

TEST(ReferenceMotion, IsAsCloseAsItSays) {
  const ProbingMotion motion = probing_motion(cube("press"));
  const ReferenceMotion coarse = reference_motion(motion, 0.01, 0.1),
                        fine = reference_motion(motion, 0.01, 1e-3);
  EXPECT_LE(coarse.error_bound, 0.01);
  EXPECT_LE(fine.error_bound, 1e-4);
  EXPECT_GT(fine.scale, 0);
  ASSERT_EQ(coarse.y.size(), fine.y.size());
  EXPECT_LE(coarse.t.size(), 51U);
  double away = 0;
  for (std::size_t i = 0; i < fine.y.size(); ++i)
    away = std::max(away, relative_error(motion, fine, i, coarse.y[i]));
  EXPECT_LE(away, 0.012);
  EXPECT_GT(away, 0);
}

// Of small strains 2 % are 2 % of the diagonal, 0.173 m. The load had gone before the first frame of a
// second.
TEST(ProbingMotion, LastsSomeFrames) {
  const ProbingMotion motion = probing_motion(make_problem("fem_cauchy@cube:n=2"), {}, 1);
  EXPECT_NEAR(motion.t_end, 8.2, 1e-12);
  EXPECT_TRUE(says(motion.words, "rises within 0.1 s, stays for 4 s"));
  // It sways about its equilibrium.
  const double diagonal = 0.1 * std::sqrt(3.0), scale = reference_motion(motion, 1, 0.1).scale;
  EXPECT_GT(scale, 0.02 * diagonal);
  EXPECT_LT(scale, 2 * 0.02 * diagonal);
  EXPECT_EQ(probing_motion(make_problem("fem_cauchy@cube:n=2"), {}, 0.05).t_end,
            probing_motion(cube("press")).t_end);
}

TEST(ReferenceMotion, HasTheScaleOfItsStatesBetweenFramesToo) {
  // A force that is nothing at the end of each frame.
  const double frame = 0.2;
  ProbingMotion motion =
      probing_motion(make_problem("fem_cauchy/press@cube:n=2", {.parameters = {{"E", 1e5}}}));
  motion.problem = with_settings(motion.problem, [&](TissueSettings& settings) {
    settings.forces.front().profile = {.kind = TimeProfile::Kind::sine,
                                       .omega = 2 * std::numbers::pi / frame};
  });
  motion.t_end = 5 * frame;
  const double scale = reference_motion(motion, 0.01, 0.01).scale;
  EXPECT_NEAR(reference_motion(motion, frame, 0.01).scale, scale, 0.05 * scale);
  // An oscillator of amplitude 1, seen once in each period.
  const double k1 = 5.3, m = 1.45, period = 2 * std::numbers::pi / std::sqrt(k1 / m);
  const Problem spring = make_problem("liver_linear", {.parameters = {{"c", 0}}, .y0 = {1, 0}});
  const ReferenceMotion seldom = reference_motion({.problem = spring, .t_end = 8.5 * period}, period, 0.01);
  EXPECT_NEAR(seldom.ranges[0], 2, 0.15);
}

TEST(ReferenceMotion, IsTheSameByEachMethod) {
  const ProbingMotion motion = probing_motion(cube("press"));
  const Linearised near = linearised(motion.problem, 0, motion.problem.y0);
  const double rk4 = *predict(find_method("rk4"), near).h_max,
               central = *predict(find_method("central_difference"), near).h_max;
  ASSERT_GT(rk4, 1e-4);
  const ReferenceMotion implicit = reference_motion(motion, 0.01, 1e-3);
  const auto away_from_it = [&](double tolerance, const ExplicitLimits& limits) {
    const ReferenceMotion reference = reference_motion(motion, 0.01, tolerance, {}, limits);
    EXPECT_EQ(implicit.t, reference.t);
    EXPECT_LE(reference.error_bound, tolerance / 10);
    double away = 0;
    for (std::size_t i = 0; i < implicit.y.size(); ++i)
      away = std::max(away, relative_error(motion, implicit, i, reference.y[i]));
    return away;
  };
  const double of_rk4 = away_from_it(1e-3, {.rk4 = rk4}),
               of_central = away_from_it(0.05, {.central = central, .rk4 = rk4}),
               of_newmark = away_from_it(1e-3, {.central = central});
  EXPECT_LE(of_rk4, 2e-4);
  EXPECT_LE(of_central, 6e-3);
  // They are not one and the same, but where central differences do not suffice.
  EXPECT_GT(of_rk4, 0);
  EXPECT_GT(of_central, 2 * of_rk4);
  EXPECT_EQ(of_newmark, 0);
}

// Three halvings of a method of second order gain a factor of 64, and a tolerance of 1e-8 takes more.
TEST(ReferenceMotion, IsOfTheMethodThatReachesItsTolerance) {
  const ProbingMotion motion = probing_motion(cube("press"));
  const Linearised near = linearised(motion.problem, 0, motion.problem.y0);
  const ExplicitLimits limits{.central = *predict(find_method("central_difference"), near).h_max,
                              .rk4 = *predict(find_method("rk4"), near).h_max};
  const ReferenceMotion close = reference_motion(motion, 0.01, 1e-8, {}, limits),
                        by_rk4 = reference_motion(motion, 0.01, 1e-8, {}, {.rk4 = limits.rk4});
  EXPECT_LE(close.error_bound, 1e-9);
  EXPECT_EQ(close.y, by_rk4.y);
  // By its fourth order rk4 gains 16 a halving, which twelve of second order do not.
  EXPECT_LE(reference_motion(motion, 0.01, 1e-10, {}, limits).error_bound, 1e-11);
}

TEST(MotionRun, EndsWhereItsFramesTakeTooLong) {
  const Problem problem = cube("press");
  const ProbingMotion motion = probing_motion(problem);
  const ReferenceMotion reference = reference_motion(motion, 0.01, 0.1);
  const Candidate candidate = candidates({find_method("symplectic_euler")}, problem).front();
  // Eighteen million steps, which no machine takes half of in a second.
  const MotionRun run = run_motion(candidate, motion, reference, 0.01, 300'000, {.most_per_frame = 1e-9});
  EXPECT_EQ(run.outcome, Outcome::stopped);
  EXPECT_LT(run.t, 0.5 * motion.t_end);
  EXPECT_EQ(run.error, std::numeric_limits<double>::infinity());
  EXPECT_GT(run.steps, 0);
}

TEST(MotionRun, CountsTheLinearIterationsOfEachFrame) {
  const Problem problem = cube("press");
  const ProbingMotion motion = probing_motion(problem);
  const ReferenceMotion reference = reference_motion(motion, 0.01, 0.1);
  for (const Candidate& candidate : candidates({find_method("linearly_implicit_euler")}, problem)) {
    const MotionRun run = run_motion(candidate, motion, reference, 0.01, 2);
    ASSERT_FALSE(run.linear_iterations.empty());
    const double most = std::ranges::max(run.linear_iterations),
                 sum = std::accumulate(run.linear_iterations.begin(), run.linear_iterations.end(), 0.0);
    if (candidate.linear_solve.iterations == 0) {
      EXPECT_EQ(most, 0) << candidate.words();
      continue;
    }
    EXPECT_GT(most, 0);
    EXPECT_LE(most, 2 * candidate.linear_solve.iterations);
    EXPECT_EQ(sum, static_cast<double>(run.stats.linear_iterations));
  }
}

TEST(RelativeError, IsThatOfEachStateInItsOwnRange) {
  const ProbingMotion motion = probing_motion(make_problem("liver_forced"));
  const ReferenceMotion reference = reference_motion(motion, 0.1, 0.01);
  ASSERT_EQ(reference.ranges.size(), 2);
  for (Eigen::Index i = 0; i < 2; ++i) {
    Eigen::VectorXd y = reference.y[7];
    y[i] += 0.1 * reference.ranges[i];
    EXPECT_NEAR(relative_error(motion, reference, 7, y), 0.1, 1e-9);
  }
}

TEST(ReferenceMotion, IsRefusedWhereNothingMoves) {
  const Problem rests = make_problem("liver_linear", {.y0 = {0, 0}});
  EXPECT_THROW(reference_motion(probing_motion(rests), 0.1, 0.01), InputError);
}

}  // namespace
}  // namespace hmax
