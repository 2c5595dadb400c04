/// Steps are judged by what neighbours of a motion do, beside those of a shorter step.
#include "advice/motion/stable_step.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>

#include <gtest/gtest.h>

#include "advice/advise.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "problems/tissue/body.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// A ball of mass m that falls on a floor of a stiff spring and a damper. Its limit is that of contact, 2.785
/// / sqrt(k / m) of rk4; it ends at rest at -m g / k.
constexpr double gravity = 9.81, floor_k = 1e6, ball_m = 1;

/// @param floor  where it is [m]; `height` counts from it
Problem ball(const Scratch& scratch, double height, double t_end = 2, double floor = 0) {
  const std::filesystem::path file = scratch / "ball.toml";
  std::ofstream(file) << "[problem]\nt_end = " << t_end
                      << "\n[equations]\nx = \"v\"\nv = \"-9.81 + (x < F ? (-k*(x - F) - c*v)/m : 0)\"\n"
                         "[parameters]\nk = 1e6\nc = 10\nm = 1\nF = "
                      << floor << "\n[initial]\nx = " << floor + height << "\nv = 0\n";
  return make_problem(file.string());
}

Candidate rk4() { return {find_method("rk4"), {}, {}}; }

StepVerdict judged(const Problem& problem, double h, double t_end, double scale = 0) {
  ReferenceMotion reference;
  reference.scale = scale > 0 ? scale : problem.y0.cwiseAbs().maxCoeff();
  return judged_step(rk4(), {.problem = problem, .t_end = t_end}, reference, h);
}

TEST(StableStep, LandsAtRestFromWhereverABallFalls) {
  const Scratch scratch;
  for (const double height : {1.0, 0.5, 0.5001}) {
    const Problem problem = ball(scratch, height);
    const RunRecord run = rk4().method.bind(problem).run(rk4().spec(0.01 / 28, 60), {});
    ASSERT_EQ(run.outcome, Outcome::reached_end);
    EXPECT_NEAR(run.y[0], -ball_m * gravity / floor_k, 1e-8) << height;
    // So the step is stable, though neighbours part by impacts between two of its steps.
    const StepVerdict verdict = judged(problem, 0.01 / 28, 20);
    EXPECT_TRUE(verdict.stable) << height << ": " << verdict.why;
    EXPECT_TRUE(verdict.parts) << height;
  }
}

TEST(StableStep, IsNoneBeyondTheLimitOfContact) {
  const Scratch scratch;
  const double limit = 2.785 / std::sqrt(floor_k / ball_m);
  // Bounces higher and higher: 60 s end far above where it began.
  for (const double factor : {1.05, 1.2}) {
    const Problem problem = ball(scratch, 0.5);
    const StepVerdict verdict = judged(problem, factor * limit, 20);
    EXPECT_FALSE(verdict.stable) << factor;
    EXPECT_TRUE(says(verdict.why, "as large as with a quarter of the step"));
  }
  // By how much further than with a quarter of the step it goes, wherever the floor is.
  const double h = 1.2 * limit;
  const Problem problem = ball(scratch, 0.5, 2, 3000);
  const auto way = [&](double step) {
    double farthest = 0;
    (void)rk4().method.bind(problem).run(rk4().spec(step, 20),
                                         [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
                                           farthest = std::max(farthest, std::abs(y[0] - problem.y0[0]));
                                         });
    return farthest;
  };
  const StepVerdict verdict = judged(problem, h, 20, 0.5);
  EXPECT_FALSE(verdict.stable);
  double times = 0;
  EXPECT_EQ(std::sscanf(verdict.why.c_str(), "the motion becomes %lf times as large", &times), 1)
      << verdict.why;
  EXPECT_NEAR(times * way(h / 4) / way(h), 1, 0.2);
}

TEST(StableStep, OfALinearOscillatorIsDecidedByGrowthAlone) {
  // |R(i w h)| > 1 from w h = sqrt(8) on.
  const Problem problem = make_problem("liver_linear", {.parameters = {{"c", 0}}, .y0 = {0.01, 0}});
  const double limit = std::sqrt(8 / (5.3 / 1.45));
  const StepVerdict below = judged(problem, 0.99 * limit, 100), beyond = judged(problem, 1.01 * limit, 100);
  EXPECT_TRUE(below.stable) << below.why;
  EXPECT_FALSE(beyond.stable);
  EXPECT_FALSE(beyond.parts) << "a quarter of the step holds neighbours together";
}

// Of 1e5 rad/s: displacements of 1e-9 beside velocities of 1e-4, looked at after 191 and a half half-turns.
TEST(StableStep, MeasuresEachStateByItsOwnRange) {
  const Problem problem =
      make_problem("liver_linear", {.parameters = {{"m", 1e-10}, {"c", 0}, {"k1", 1}}, .y0 = {1e-9, 0}});
  ReferenceMotion reference{.t = {}, .y = {}, .scale = 1e-4, .ranges = Eigen::Vector2d(2e-9, 1e-4)};
  const StepVerdict verdict = judged_step(rk4(), {.problem = problem, .t_end = 6.016e-3}, reference, 1e-6);
  EXPECT_TRUE(verdict.stable) << verdict.why;
  EXPECT_FALSE(verdict.parts);
}

TEST(StableStep, IsNotWhatChaosOfTheModelDecides) {
  // Neighbours of the Lorenz attractor part like exp(0.906 t) with every integrator: 1e-8 becomes 1 within 25
  // s.
  const Problem problem = make_problem("lorenz");
  const StepVerdict verdict = judged(problem, 0.01, 40);
  EXPECT_TRUE(verdict.stable) << verdict.why;
  EXPECT_TRUE(verdict.parts);
}

TEST(StableStep, NamesTheElementThatARunInverts) {
  const Problem problem = make_problem("fem_neo_hookean/press@cube:n=2", {.parameters = {{"force", 60}}});
  ReferenceMotion reference;
  reference.scale = 0.01;
  const StepVerdict verdict = judged_step({find_method("symplectic_euler"), {}, {}},
                                          {.problem = problem, .t_end = 0.1}, reference, 1e-4);
  ASSERT_TRUE(verdict.inversion);
  EXPECT_LE(verdict.inversion->volume, 0);
  EXPECT_GE(verdict.inversion->tetrahedron, 1);
  EXPECT_GT(verdict.inversion->t, 0);
  EXPECT_LE(verdict.inversion->t, 0.1);
}

TEST(Advise, RecommendsAStepForAnImpact) {
  const Scratch scratch;
  const Problem problem = ball(scratch, 1);
  AdviceQuestion asked;
  asked.rate = 100;
  asked.frames = 100;
  asked.methods = choose_methods({"rk4"}, {problem});
  const Advice advice = advise(problem, asked);
  ASSERT_NE(advice.recommended(), nullptr) << advice.rows.front().status;
  EXPECT_EQ(advice.rows.front().steps_per_frame, 28);
  EXPECT_NEAR(advice.rows.front().h_max, 2.84e-3, 0.01e-3);
  EXPECT_EQ(advice.rows.front().bound, AdviceBound::accuracy) << "the limit is eight times as long";
}

/// Heights that shrink to a share of theirs make all volumes shrink to that share.
TEST(Inversion, IsFoundByTheSignOfTheVolume) {
  const Problem problem = make_problem("fem_green@cube:n=1", {.parameters = {{"support", 0.01}}});
  const TissueBody& body = *problem.body;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(problem.y0.size());
  EXPECT_FALSE(inversion_at(problem, 0, y));
  const auto moved_down = [&](double share) {
    for (std::size_t i = 0; i < body.free_points().size(); ++i) {
      const auto point = body.free_points()[i];
      y[3 * static_cast<Eigen::Index>(i) + 2] =
          -share * (body.mesh().points(2, point) - body.mesh().points.row(2).minCoeff());
    }
    return inversion_at(problem, 0, y, 0.1);
  };
  ASSERT_TRUE(moved_down(0.95));
  EXPECT_NEAR(moved_down(0.95)->volume, 0.05, 1e-12);
  EXPECT_FALSE(says(in_words(*moved_down(0.95)), "inverted"));
  EXPECT_FALSE(moved_down(0.8));
  ASSERT_TRUE(moved_down(1.5));
  EXPECT_NEAR(moved_down(1.5)->volume, -0.5, 1e-12);
  EXPECT_TRUE(says(in_words(*moved_down(1.5)), "is inverted at t = 0 s"));
}

TEST(LoadMargin, EndsWhereAnElementInverts) {
  // 2 N move a soft cube of 0.1 m by a tenth of its side; 16 N turn elements inside out.
  const Problem problem = make_problem("fem_green/press@cube:n=2", {.parameters = {{"force", 2}}});
  const Candidate candidate{find_method("symplectic_euler"), {}, {}};
  const ProbingMotion motion = probing_motion(problem);
  const ReferenceMotion reference = reference_motion(motion, 0.01, 0.01);
  const double h = 2e-4;
  const LoadMargin margin = load_margin(candidate, h, motion, reference, {});
  ASSERT_TRUE(margin.inversion);
  EXPECT_LT(margin.holds, margin.fails);
  EXPECT_EQ(margin.of_model, true);
  // The shape at the largest load that is called stable keeps every element, by the body's own volumes.
  const Problem larger = larger_motion(motion, margin.holds, {}).problem;
  double least = 1;
  (void)candidate.method.bind(larger).run(
      candidate.spec(h, motion.t_end), [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
        least = std::min(least, larger.body->least_volume(t, y.head(larger.body->dofs())).first);
      });
  EXPECT_GT(least, -0.1);
}

TEST(LoadMargin, IsNoneWhereTheMotionItselfInvertsAnElement) {
  const Problem problem = make_problem("fem_neo_hookean/press@cube:n=2", {.parameters = {{"force", 60}}});
  ReferenceMotion reference{.t = {0}, .y = {problem.y0}, .scale = 0.01};
  const ProbingMotion motion{.problem = problem, .t_end = 0.1};
  EXPECT_FALSE(first_inversion(motion, reference));
  // Mirrored through the plane that holds it.
  reference.t.push_back(0.1);
  reference.y.push_back(problem.y0);
  const TissueBody& body = *problem.body;
  for (std::size_t i = 0; i < body.free_points().size(); ++i)
    reference.y[1][3 * static_cast<Eigen::Index>(i) + 2] = -2 * body.mesh().points(2, body.free_points()[i]);
  const LoadMargin margin =
      load_margin({find_method("symplectic_euler"), {}, {}}, 1e-4, motion, reference, {});
  ASSERT_TRUE(margin.inversion);
  EXPECT_EQ(margin.inversion->t, 0.1);
  EXPECT_TRUE(std::isnan(margin.holds));
  EXPECT_EQ(margin.fails, 1);
}

/// A method whose clock says that a frame of one step took as long as told.
Method slow_on(std::function<double(int run, int frame)> seconds) {
  Method method = find_method("rk4");
  method.bind = [seconds](const Problem& problem) {
    const auto clock = std::make_shared<double>(0);
    Runner runner;
    runner.seconds = [clock] { return *clock; };
    runner.run = [=, y = problem.y0, run = std::make_shared<int>(0)](const RunSpec& spec, const Sink& sink) {
      const int now = (*run)++;
      const auto steps = static_cast<int>(std::lround(spec.t_end / spec.h));
      sink(0, y);
      for (int i = 1; i <= steps; ++i) {
        *clock += seconds(now, i);
        sink(i * spec.h, y);
      }
      RunRecord record;
      record.t = record.t_state = spec.t_end;
      record.y = y;
      record.stats.steps = steps;
      return record;
    };
    return runner;
  };
  return method;
}

TEST(MotionRun, DoesNotCountFramesThatAreLateInOneRunOfThree) {
  const Problem problem = make_problem("liver_forced");
  const ProbingMotion motion{.problem = problem, .t_end = 1};
  double with_repeats = 10;
  const auto run = [&](const std::function<double(int, int)>& seconds) {
    return run_motion({slow_on(seconds), {}, {}}, motion, {}, 0.01, 1,
                      {.budget = 2e-3, .with_repeats = with_repeats});
  };
  const MotionRun disturbed =
      run([](int now, int frame) { return frame == 20 + now || frame == 60 + now ? 3e-3 : 1e-5; });
  EXPECT_EQ(disturbed.frames_s.size(), 99U);
  EXPECT_EQ(disturbed.missed, 0U);
  EXPECT_EQ(disturbed.disturbed, 2U);
  const MotionRun late = run([](int, int frame) { return frame == 20 || frame == 60 ? 3e-3 : 1e-5; });
  EXPECT_EQ(late.missed, 2U);
  EXPECT_EQ(late.disturbed, 0U);
  // A run takes 7 ms at least.
  with_repeats = 15e-3;
  int runs = 0;
  const MotionRun once = run([&](int now, int frame) {
    runs = std::max(runs, now + 1);
    return frame == 20 + now || frame == 60 + now ? 3e-3 : 1e-5;
  });
  EXPECT_EQ(runs, 1);
  EXPECT_EQ(once.missed, 2U);
  EXPECT_EQ(once.disturbed, 0U);
}

TEST(MiddleTimes, AreMedians) {
  const std::array<std::vector<double>, 3> runs{{{1, 5, 3}, {2, 4, 3}, {3, 6, 1}}};
  EXPECT_EQ(middle_times(runs), (std::vector<double>{2, 5, 3}));
}

TEST(Proof, EndsBeforeTheLongRunWhereAShortOneFails) {
  const Problem problem = make_problem("fem_green/press@cube:n=2", {.parameters = {{"E", 1e5}}});
  const ProbingMotion motion = probing_motion(problem);
  const ReferenceMotion reference = reference_motion(motion, 0.01, 0.01);
  const Candidate candidate{find_method("symplectic_euler"), {}, {}};
  // A step far beyond 2 / omega of an element of 5 cm, some 2 ms.
  const double begun = thread_cpu_seconds();
  const std::vector<ProofRun> proof =
      prove(candidate, 1, motion, reference, {.frame = 0.01, .budget = 1, .seconds = 1e5, .slowest = 0});
  EXPECT_LT(thread_cpu_seconds() - begun, 5) << "ten million steps were not run";
  ASSERT_EQ(proof.size(), 1U);
  EXPECT_FALSE(proof[0].stable);
  EXPECT_TRUE(says(proof[0].why, "diverges"));
}

}  // namespace
}  // namespace hmax
