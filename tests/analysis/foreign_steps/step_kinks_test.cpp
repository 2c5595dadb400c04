/// Limits of steps that have no derivative at rest, and of models that creep, against their formulas.
#include "analysis/foreign_steps/step_kinks.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/foreign_steps/own_step.hpp"
#include "analysis/foreign_steps/step_probe.hpp"
#include "core/errors.hpp"
#include "tests/analysis/foreign_steps/mapped_stepper.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

std::string remarks_of(const ProbedLimit& found) {
  std::string all;
  for (const std::string& remark : found.status) all += remark + "; ";
  return all;
}

/// Explicit Euler of x' = -x / T with another T on each side, as of a muscle, and an oscillator beside it.
template <int stiffness>
VectorXd relaxing(const VectorXd& y, double h) {
  const double v = y[2] - h * stiffness * y[1];
  return Eigen::Vector3d(y[0] - h * y[0] / (y[0] < 0 ? 0.005 : 0.08), y[1] + h * v, v);
}

TEST(StepKinks, TwoTimeConstantsHaveTheLimitOfTheirRunsAndNotThatOfTheirMean) {
  Mapped engine(relaxing<100>, VectorXd::Zero(3));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-4, .h1 = 0.19});
  EXPECT_EQ(found.smoothness, StepSmoothness::kink);
  // To and fro: (h / 0.005 - 1) (h / 0.08 - 1) = 1.
  EXPECT_NEAR(found.h_max, 0.085, 2e-4);
  EXPECT_NEAR(found.observed, 0.085, 2e-4);
  EXPECT_FALSE(found.contradiction) << remarks_of(found);
  EXPECT_TRUE(says(remarks_of(found), "at a kink of the step, where number 0 of the state changes"));
}

TEST(StepKinks, WhatGrowsBesideAKinkIsTold) {
  // The mean of both sides would grow from 0.0188 s on, the oscillator at 2 / 100.
  Mapped engine(relaxing<10'000>, VectorXd::Zero(3));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-4, .h1 = 0.019});
  EXPECT_EQ(found.smoothness, StepSmoothness::kink);
  EXPECT_TRUE(std::isinf(found.h_max)) << found.h_max << remarks_of(found);
  const ProbedLimit longer = probe_steps(engine, {.h0 = 1e-4, .h1 = 0.1});
  EXPECT_NEAR(longer.h_max, 0.02, 4e-5);
}

/// A ball that bounces on a stiff floor at rest height: another stiffness on each side.
VectorXd touching(const VectorXd& y, double h) {
  const double v = (1 - 0.2 * h) * y[1] - h * (y[0] < 0 ? 1e4 : 100) * y[0];
  return Eigen::Vector2d(y[0] + h * v, v);
}

/// Whether the steps grow, which do to a multiple of a state what they do to it.
bool touching_grows(double h) {
  VectorXd y = Eigen::Vector2d(0.003, -1);
  double sum = 0;
  for (int i = 0; i < 20'000; ++i) {
    y = touching(y, h);
    const double size = std::hypot(100 * y[0], y[1]);
    sum += std::log(size);
    y /= size;
  }
  return sum > 0;
}

TEST(StepKinks, AreSeenAlsoWhereDifferencesAreExact) {
  Mapped engine(touching, VectorXd::Zero(2));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-4, .h1 = 0.1});
  EXPECT_EQ(found.smoothness, StepSmoothness::kink);
  // A window of step sizes that grow, of a tenth of a percent.
  EXPECT_TRUE(touching_grows(1.0004 * found.h_max)) << found.h_max;
  EXPECT_FALSE(touching_grows(0.998 * found.h_max)) << found.h_max;
  EXPECT_NEAR(found.observed, found.h_max, 1e-3 * found.h_max) << remarks_of(found);
  EXPECT_FALSE(found.contradiction);
}

/// With a step size of its own.
class Timed : public Mapped {
 public:
  Timed(Map map, VectorXd y, double h) : Mapped(map, std::move(y)), h_(h) {}
  [[nodiscard]] std::optional<double> own_step() const override { return h_; }

 private:
  double h_;
};

TEST(StepKinks, StepsInAWindowBelowTheLimitAreUnstable) {
  // One of the windows that the strides pass by: 0.008604 s to 0.008613 s.
  constexpr double inside = 0.008608, below = 0.0075;
  ASSERT_TRUE(touching_grows(inside));
  ASSERT_FALSE(touching_grows(below));
  for (const double h : {inside, below}) {
    Timed engine(touching, VectorXd::Zero(2), h);
    const ProbedLimit found = probe_steps(engine, {.h0 = 1e-4, .h1 = 0.1, .observe = false});
    ASSERT_GT(found.h_max, inside);
    const auto own = examine_own_step(engine, found, {});
    ASSERT_TRUE(own && own->substeps);
    EXPECT_EQ(own->stable, h == below);
    EXPECT_FALSE(touching_grows(h / static_cast<double>(*own->substeps)));
    EXPECT_EQ(*own->substeps > 1, h == inside);
  }
}

/// Smooth, and strongly curved.
VectorXd curving(const VectorXd& y, double h) {
  const double v = y[1] - h * (100 * y[0] + 400 * y[0] * y[0]);
  return Eigen::Vector2d(y[0] + h * v, v);
}

/// The least elapsed time of a step [s].
double seconds_of_step(Mapped& engine) {
  using Clock = std::chrono::steady_clock;
  double least = 1;
  for (int i = 0; i < 20; ++i) {
    const auto begin = Clock::now();
    engine.step(1e-3, 100);
    least = std::min(least, std::chrono::duration<double>(Clock::now() - begin).count() / 100);
  }
  return least;
}

TEST(StepKinks, AnEndlessSearchIsRefused) {
  Mapped engine(touching, VectorXd::Zero(2)), smooth(curving, VectorXd::Zero(2));
  // At the kink 36 sizes in each of three decades, by 8,000 steps each; without one some 2,700 steps.
  ProbeSettings settings{
      .h0 = 1e-4, .h1 = 0.1, .observe = false, .most_seconds = 50'000 * seconds_of_step(engine)};
  EXPECT_TRUE(says(error_of<InputError>([&] { probe_steps(engine, settings); }),
                   "the state is at a kink of the step"));
  EXPECT_NO_THROW(probe_steps(smooth, settings));
  settings.most_seconds = 100 * seconds_of_step(smooth);
  EXPECT_TRUE(
      says(error_of<InputError>([&] { probe_steps(smooth, settings); }), "a probe takes some 2700 steps"));
  // Six times a second in steps of 1e-4 s to 0.1 s.
  settings.most_seconds = 10'000 * seconds_of_step(smooth);
  settings.motion = 1;
  EXPECT_TRUE(says(error_of<InputError>([&] { probe_steps(smooth, settings); }), "a shorter motion"));
}

/// What is disturbed to one side grows beyond a step of 0.05.
template <int side>
VectorXd growing_on_one_side(const VectorXd& y, double h) {
  return VectorXd::Constant(1, y[0] * (h > 0.05 && side * y[0] > 0 ? 1.01 : 0.5));
}

TEST(StepKinks, RunsToOneSideContradictNothing) {
  int unseen = 0;
  for (const auto step : {growing_on_one_side<-1>, growing_on_one_side<1>}) {
    Mapped engine(step, VectorXd::Zero(1));
    const ProbedLimit found = probe_steps(engine, {.h0 = 1e-3, .h1 = 0.1});
    EXPECT_EQ(found.smoothness, StepSmoothness::kink);
    EXPECT_NEAR(found.h_max, 0.05, 1e-4);
    EXPECT_FALSE(found.contradiction) << remarks_of(found);
    unseen += says(remarks_of(found), "not up to 0.1 s by runs");
  }
  EXPECT_EQ(unseen, 1);
}

TEST(StepKinks, GrowthOfAHundredTimesAStepIsGrowth) {
  Mapped engine(touching, VectorXd::Zero(2));
  const ProbedLimit found = probe_steps(engine, {.h0 = 0.3, .h1 = 0.4});
  EXPECT_TRUE(says(remarks_of(found), "motions grow at h0 already")) << remarks_of(found);
}

TEST(StepKinks, CurvatureIsNone) {
  Mapped engine(curving, VectorXd::Zero(2));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-3, .h1 = 1});
  EXPECT_EQ(found.smoothness, StepSmoothness::smooth);
  EXPECT_NEAR(found.h_max, 0.2, 1e-4);
}

/// A force that is there beyond a distance of 1e-5.
VectorXd jumping(const VectorXd& y, double h) {
  const double jump = y[0] + y[1] > 1e-5 ? 1e-3 : 0;
  const double v = (1 - h) * y[1] - h * (100 * y[0] + jump);
  return Eigen::Vector2d(y[0] + h * v, v);
}

TEST(StepKinks, AtAJumpNoLimitIsPredicted) {
  Mapped engine(jumping, VectorXd::Zero(2));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-3, .h1 = 1});
  EXPECT_EQ(found.smoothness, StepSmoothness::jump);
  EXPECT_TRUE(std::isnan(found.h_max));
  EXPECT_FALSE(found.contradiction);
  EXPECT_TRUE(says(remarks_of(found), "no limit is predicted")) << remarks_of(found);
  // The oscillator's: 4 - 2 h = 100 h^2.
  EXPECT_NEAR(found.observed, (std::sqrt(401) - 1) / 100, 3e-3) << remarks_of(found);
}

/// The same force on an oscillator whose velocity counts little in differences of small steps.
VectorXd jumping_fast(const VectorXd& y, double h) {
  const double jump = y[0] + 1e-4 * y[1] > 1e-9 ? 1 : 0;
  const double v = (1 - 10 * h) * y[1] - h * (1e4 * y[0] + jump);
  return Eigen::Vector2d(y[0] + h * v, v);
}

TEST(StepKinks, AtAJumpOwnStepsAreJudgedByRuns) {
  // 4 - 20 h = 1e4 h^2
  const double limit = (std::sqrt(401) - 1) / 1000;
  for (const double h : {0.9 * limit, 1.5 * limit}) {
    Timed engine(jumping_fast, VectorXd::Zero(2), h);
    const ProbedLimit found = probe_steps(engine, {.h0 = 1e-4, .h1 = 0.1});
    ASSERT_EQ(found.smoothness, StepSmoothness::jump);
    EXPECT_NEAR(found.observed, limit, 0.03 * limit) << remarks_of(found);
    const auto own = examine_own_step(engine, found, {});
    ASSERT_TRUE(own && own->stable && own->substeps);
    EXPECT_EQ(*own->stable, h < limit);
    EXPECT_EQ(*own->substeps, h < limit ? 1 : 2);
  }
}

/// It falls through the place of the jump.
VectorXd falling_past(const VectorXd& y, double h) {
  const double v = y[1] - h * (9.81 + (y[0] + y[1] > -1e-7 ? 0 : 1e3));
  return Eigen::Vector2d(y[0] + h * v, v);
}

TEST(StepKinks, AtAJumpOfAMotionNothingIsRun) {
  Timed engine(falling_past, VectorXd::Zero(2), 1e-3);
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-4, .h1 = 0.1});
  ASSERT_EQ(found.smoothness, StepSmoothness::jump);
  ASSERT_EQ(found.state, ProbedState::initial);
  EXPECT_TRUE(std::isnan(found.observed));
  EXPECT_FALSE(examine_own_step(engine, found, {})->stable);
}

/// An oscillator, and exact growth at a rate.
template <int hundredths>
VectorXd creeping(const VectorXd& y, double h) {
  const double v = y[1] - h * 100 * y[0];
  return Eigen::Vector3d(y[0] + h * v, v, std::exp(1e-2 * hundredths * h) * y[2]);
}

TEST(StepProbe, AModelThatCreepsIsNotUnstable) {
  Mapped slow(creeping<1>, VectorXd::Zero(3)), fast(creeping<500>, VectorXd::Zero(3));
  // sqrt(h0 h1) = 0.005: a run of 100 s shows e^(0.01 * 100).
  const ProbedLimit creeps = probe_steps(slow, {.h0 = 5e-5, .h1 = 0.5});
  EXPECT_NEAR(creeps.h_max, 0.2, 1e-4) << remarks_of(creeps);
  EXPECT_TRUE(says(remarks_of(creeps), "the model itself creeps at this state: a motion grows by 0.01 1/s"))
      << remarks_of(creeps);
  // Runs leave it out, too.
  EXPECT_NEAR(creeps.observed, 0.2, 1e-3) << remarks_of(creeps);
  EXPECT_FALSE(creeps.contradiction);
  const ProbedLimit unstable = probe_steps(fast, {.h0 = 5e-5, .h1 = 0.5});
  EXPECT_TRUE(std::isnan(unstable.h_max));
  EXPECT_TRUE(says(remarks_of(unstable), "the model itself is unstable"));
}

/// An oscillator on three springs of 20 and one of 40.
class OnFourSprings : public Mapped {
 public:
  OnFourSprings() : Mapped(nullptr, VectorXd::Zero(2)) {}
  [[nodiscard]] std::optional<double> own_step() const override { return 0.01; }
  [[nodiscard]] std::vector<ScenePart> parts() const override {
    return {
        {"spring", "a", 20, 0}, {"spring", "single", 40, 0}, {"spring", "b", 20, 0}, {"spring", "c", 20, 0}};
  }
  void scale_part(std::size_t i, double stiffness, double) override { factors_[i] = stiffness; }
  bool step(double h, std::int64_t count) override {
    const double k = 20 * (factors_[0] + factors_[2] + factors_[3]) + 40 * factors_[1];
    VectorXd y = state();
    for (; count > 0; --count) {
      y[1] -= h * k * y[0];
      y[0] += h * y[1];
    }
    set_state(y);
    return true;
  }

 private:
  std::array<double, 4> factors_{1, 1, 1, 1};
};

TEST(OwnStep, TheOwnerIsOneOfThoseThatHaveMostTogether) {
  OnFourSprings engine;
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-3, .h1 = 1, .observe = false});
  const std::optional<OwnStep> own = examine_own_step(engine, found, {});
  ASSERT_TRUE(own && own->owner);
  EXPECT_EQ(own->owner->alike, 3U);
  EXPECT_NEAR(own->owner->share, 0.2, 1e-3);
  EXPECT_NEAR(own->owner->share_of_alike, 0.6, 1e-3);
}

/// A slow creep beside explicit Euler of x'' + 0.2 x' + 100 x = 0, whose growth is slow beyond 0.002 s.
VectorXd creeping_beside_a_limit(const VectorXd& y, double h) {
  return Eigen::Vector3d(y[0] + h * y[1], y[1] - h * (0.2 * y[1] + 100 * y[0]), std::exp(1e-3 * h) * y[2]);
}

TEST(StepProbe, ACreepHidesLittleOfALimitAndContradictsNoRun) {
  Mapped engine(creeping_beside_a_limit, VectorXd::Zero(3));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-4, .h1 = 0.01});
  // 100 h - 0.2 = 2 * 0.002: growth by twice the creep.
  EXPECT_NEAR(found.h_max, 0.00204, 1e-6) << remarks_of(found);
  EXPECT_FALSE(found.contradiction) << remarks_of(found);
  EXPECT_GE(found.observed, found.h_max) << remarks_of(found);
}

/// Falls at 9.81 / 500 m/s for ever.
VectorXd sinking_evenly(const VectorXd& y, double h) {
  const double v = y[1] - h * (9.81 + 500 * y[1]);
  return Eigen::Vector2d(y[0] + h * v, v);
}

TEST(StepProbe, WhatNeverRestsDoesNotSettle) {
  Mapped engine(sinking_evenly, VectorXd::Zero(2));
  const ProbedLimit found = probe_steps(engine, {.h0 = 5e-5, .h1 = 0.1, .observe = false});
  EXPECT_NEAR(found.h_max, 0.004, 1e-6);
  for (const StepSpectrum& row : found.rows) EXPECT_NE(row.settles, true) << row.h;
}

/// A constraint that is softer at longer steps, with a stop that no derivative at the start knows of.
VectorXd sinking(const VectorXd& y, double h) {
  const double T = std::max(0.02, 2 * h), x = y[0] < -0.01 ? 0.9 * y[0] : y[0] * (0.1 + 80 * std::abs(y[0]));
  const double v = (1 - 2 * h / (T + 2 * h)) * (y[1] - h * (x / (T * T) + 9.81));
  return Eigen::Vector2d(y[0] + h * v, v);
}

TEST(StepProbe, StatesOfRestThatAreFarFromThatOfSmallStepsAreFoundByRunning) {
  Mapped engine(sinking, Eigen::Vector2d(-0.00589, 0));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-4, .h1 = 0.2});
  EXPECT_EQ(found.state, ProbedState::equilibrium);
  EXPECT_FALSE(found.contradiction) << remarks_of(found);
  // x = 9.81 T^2 / 0.9 at the end.
  EXPECT_NEAR(found.rows.back().settled[0], -9.81 * 0.16 / 0.9, 1e-6) << remarks_of(found);
}

}  // namespace
}  // namespace hmax
