#include "limits/by_steps/period_maps.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/dynamics/poincare.hpp"
#include "catalogue/device/host_device.hpp"
#include "catalogue/device/motion_runs.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/planar.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "core/instructions/cosines.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

using Set = std::vector<std::pair<std::string, double>>;

Problem liver(const Set& set) { return make_problem("liver_forced", {.parameters = set}); }

/// A chaotic motion beside periodic ones, one without force, one without stiffness, and one that runs away.
std::vector<Problem> various() {
  const Set ueda{{"m", 1}, {"c", 0.05}, {"k1", 0}, {"k3", 1}, {"w", 1}};
  std::vector<Problem> problems;
  for (const double P : {7.5, 5.75, 0.1, 0.0, -3.0}) {
    Set set = ueda;
    set.emplace_back("P", P);
    problems.push_back(liver(set));
  }
  problems.push_back(liver({{"m", 1}, {"c", 0.1}, {"k1", 0}, {"k3", 0}, {"w", 1}}));
  problems.push_back(liver({{"k1", 1}, {"k3", -1}, {"c", 0.5}, {"w", 1}}));
  return problems;
}

/// Compared as bits, in which NaN equals itself.
void expect_equal(const std::vector<VectorXd>& found, const std::vector<VectorXd>& expected,
                  const std::string& what) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    for (Eigen::Index d = 0; d < 2; ++d)
      EXPECT_TRUE(found[i](d) == expected[i](d) || (std::isnan(found[i](d)) && std::isnan(expected[i](d))))
          << what << ", image " << i << ": " << found[i].transpose() << " and " << expected[i].transpose();
}

/// Those of the processor.
std::vector<MotionRunner> all_lanes() {
  std::vector<MotionRunner> runners;
  for (const InstructionSet set : instruction_sets()) runners.push_back(in_lanes(set));
  return runners;
}

/// More motions than there are lanes, each compared with what stroboscope() makes of it alone. Some have no
/// image from the beginning.
void expect_the_images_of_single_runs(const std::vector<Problem>& problems,
                                      const std::vector<double>& periods,
                                      const std::optional<FixedSteps>& steps, int count,
                                      const std::vector<MotionRunner>& runners = all_lanes()) {
  std::vector<VectorXd> starts;
  for (int i = 0; i < 39; ++i) starts.push_back(Vector2d(std::sin(i), 2 * std::cos(3 * i)));
  starts.push_back(Vector2d(std::nan(""), 0));
  starts.push_back(Vector2d(0, 1e200));
  starts.push_back(Vector2d::Zero());
  std::vector<std::vector<VectorXd>> expected;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::size_t map = i % problems.size();
    const VectorFunction P = stroboscope(problems[map], periods[map], steps);
    std::vector<VectorXd>& all = expected.emplace_back();
    for (VectorXd y = starts[i]; static_cast<int>(all.size()) < count;) all.push_back(y = P(y));
  }
  for (std::size_t k = 0; k < runners.size(); ++k) {
    const MapEnsemble ensemble =
        period_maps([&](std::size_t i) { return problems[i]; }, periods, steps, runners[k]);
    std::vector<std::size_t> maps;
    for (std::size_t i = 0; i < starts.size(); ++i) maps.push_back(i % problems.size());
    std::vector<VectorXd> states = starts;
    for (int image = 0; image < count; ++image) {
      std::size_t begun = 0, done = 0;
      ensemble({[&]() -> std::optional<MapCall> {
                  if (begun == starts.size()) return std::nullopt;
                  const std::size_t i = begun++;
                  return MapCall{maps[i], &states[i], nullptr};
                },
                [&](const MapCall&) { ++done; }});
      ASSERT_EQ(done, starts.size());
      for (std::size_t i = 0; i < starts.size(); ++i)
        expect_equal({states[i]}, {expected[i][std::size_t(image)]},
                     "runner " + std::to_string(k) + (steps ? " " + steps->method.id : "") + ", start " +
                         std::to_string(i));
    }
  }
}

TEST(PeriodMaps, AdaptiveOnesAreThoseOfSingleRuns) {
  const std::vector<Problem> problems = various();
  expect_the_images_of_single_runs(problems, std::vector<double>(problems.size(), 2 * std::acos(-1.0)), {},
                                   4);
}

/// Each lane has a frequency of its own, also a negative one, and a period that is a multiple of it.
TEST(PeriodMaps, AdaptiveOnesMayDifferInTime) {
  std::vector<Problem> problems;
  std::vector<double> periods;
  for (const double w : {0.3, 0.5, 0.9, 1.7, -2.0, 11.0}) {
    problems.push_back(liver({{"w", w}}));
    periods.push_back(2 * drive_period(problems.back(), {}));
  }
  expect_the_images_of_single_runs(problems, periods, {}, 3);
}

TEST(PeriodMaps, FixedStepsAreThoseOfSingleRuns) {
  const std::vector<Problem> problems = various();
  const std::vector<double> periods(problems.size(), 2 * std::acos(-1.0));
  // First same as last and not; with and without a stage at the end of a step.
  for (const char* method :
       {"rk4", "dop_853", "dormand_prince_54", "rk2_midpoint", "explicit_euler", "fehlberg_78"})
    for (const double h : {0.05, 0.3})
      expect_the_images_of_single_runs(problems, periods, FixedSteps{find_method(method), h}, 3);
}

TEST(PeriodMaps, GoOneByOneWhereLanesDoNotApply) {
  const double pi = std::acos(-1.0);
  // An implicit method; frequencies that differ; formulas beside an oscillator, and of an implicit method.
  expect_the_images_of_single_runs(various(), std::vector<double>(7, 2 * pi),
                                   FixedSteps{find_method("trapezoidal"), 0.3}, 1);
  expect_the_images_of_single_runs({liver({{"w", 0.5}}), liver({{"w", 2}})}, {4 * pi, pi},
                                   FixedSteps{find_method("rk4"), 0.3}, 2);
  const Scratch scratch;
  write_text(scratch / "swing.toml",
             "[equations]\nx = \"v\"\nv = \"cos(t) - x - 0.3*v\"\n[initial]\nx = 0.5\nv = 1\n");
  expect_the_images_of_single_runs({make_problem(scratch / "swing.toml"), liver({{"w", 1}})},
                                   {2 * pi, 2 * pi}, {}, 1);
  expect_the_images_of_single_runs({make_problem(scratch / "swing.toml")}, {2 * pi},
                                   FixedSteps{find_method("trapezoidal"), 0.3}, 1);
}

/// x' = v and v' as it is given, by numbers p.
std::vector<Problem> formulas(const std::string& acceleration, const std::vector<double>& p) {
  std::vector<Problem> problems;
  for (const double value : p)
    problems.push_back(make_problem({.name = acceleration,
                                     .equations = {{"x", "v"}, {"v", acceleration}},
                                     .parameters = {{"p", value}},
                                     .y0 = {0.5, 1},
                                     .t_end = 100},
                                    "my.toml"));
  return problems;
}

/// On the processor, and as a device runs them: smooth ones; those that time alone switches, at times that
/// depend on p; one that has no force; some that run away or have no slope.
TEST(PeriodMaps, OfFormulasAreThoseOfSingleRuns) {
  HostDevice device;
  std::vector<MotionRunner> runners{in_lanes(), motions_on(device, 5)};
  const double period = 2 * std::acos(-1.0);
  const auto expect = [&](const std::string& acceleration, int count) {
    const auto problems = formulas(acceleration, {7.5, 1.0, 0.0, 0.37});
    const std::vector<double> periods(problems.size(), period);
    expect_the_images_of_single_runs(problems, periods, {}, count, runners);
    for (const char* method : {"rk4", "dop_853", "dormand_prince_54", "explicit_euler"})
      expect_the_images_of_single_runs(problems, periods, FixedSteps{find_method(method), 0.06}, count,
                                       runners);
  };
  expect("p*abs(v)*x - x^3 - sqrt(x + 9)", 2);
  expect("(t < 1 + p/3 ? 5 : t < 4 ? p : 0) - x^3 - 0.3*v", 3);
  if (!cosines_are_those_of_musl()) runners.pop_back();
  expect("p*cos(t) - x^3 - 0.05*v", 3);
  expect("p*sign(sin(t))*max(0, cos(3*t)) - x - x^3 - 0.2*v", 2);
  expect("sin(1e7*t)*p/1e13 - x", 1);
}

/// With as many attempts as a period takes it has an image, with one less none: in three pieces as alone.
TEST(PeriodMaps, CountTheAttemptsOfAllPiecesTogether) {
  HostDevice device;
  const double period = 2 * std::acos(-1.0);
  const Problem problem = formulas("(t < 1.3 ? 5 : t < 4 ? p : 0) - x^3 - 0.3*v", {7.5}).front();
  const VectorXd start = Vector2d(0.5, 1);
  std::int64_t enough = 1;
  while (std::isnan(stroboscope(problem, period, enough)(start)[0])) ++enough;
  ASSERT_GT(enough, 20);
  for (const MotionRunner& runner : {in_lanes(), motions_on(device, 3)}) {
    const auto image = [&](std::int64_t most) {
      MotionRunner limited = runner;
      limited.formulas = [&](AdaptiveSteps steps, const FormulaPrograms& programs) {
        steps.most_attempts = most;
        return runner.formulas(steps, programs);
      };
      VectorXd state = start;
      bool begun = false;
      period_maps([&](std::size_t) { return problem; }, {period}, {},
                  limited)({[&]() -> std::optional<MapCall> {
                              if (std::exchange(begun, true)) return std::nullopt;
                              return MapCall{0, &state, nullptr};
                            },
                            [](const MapCall&) {}});
      return state;
    };
    EXPECT_EQ(image(enough), stroboscope(problem, period)(start));
    EXPECT_TRUE(std::isnan(image(enough - 1)[0]));
  }
}

TEST(PeriodMaps, OfFormulasMakeTheDiagramOfSingleRunsOnADevice) {
  HostDevice device;
  const std::vector<double> values{5.305, 5.75, 7.5};
  const auto problems = formulas("(t < pi ? p : -p) - x^3 - 0.05*v", values);
  const auto problem_at = [&](std::size_t i) { return problems[i]; };
  const std::vector<double> periods(values.size(), 2 * std::acos(-1.0));
  for (const auto& steps :
       {std::optional<FixedSteps>(), std::optional(FixedSteps{find_method("rk4"), 0.1})}) {
    const auto diagram = [&](const MapEnsemble& maps) {
      return bifurcation(maps, values, Vector2d(0.5, 1), 20, 16, false);
    };
    const auto single =
        diagram(one_by_one([&](std::size_t i) { return stroboscope(problem_at(i), periods[i], steps); }));
    const auto there = diagram(period_maps(problem_at, periods, steps, motions_on(device, 3)));
    ASSERT_EQ(there.size(), single.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_EQ(there[i].motion.followed, single[i].motion.followed);
      expect_equal(there[i].motion.looks, single[i].motion.looks, std::to_string(values[i]));
    }
  }
}

/// The largest step that divides the period and is not longer than the one that is asked for.
TEST(PeriodMaps, StepsDivideThePeriod) {
  const Problem problem = liver({});
  const double period = drive_period(problem, {});
  const FixedSteps about{find_method("rk4"), period / 9.5}, exact{find_method("rk4"), period / 10};
  EXPECT_EQ(stroboscope(problem, period, about)(problem.y0), stroboscope(problem, period, exact)(problem.y0));
  // Order 4, against the adaptive map.
  const VectorXd limit = stroboscope(problem, period, std::nullopt)(problem.y0);
  const auto error = [&](int steps) {
    const FixedSteps fixed{find_method("rk4"), period / steps};
    return (stroboscope(problem, period, fixed)(problem.y0) - limit).norm();
  };
  EXPECT_NEAR(std::log2(error(100) / error(200)), 4, 0.2);
}

TEST(PeriodMaps, RefuseStepsThatAreNone) {
  const auto make = [](const char* method, double h) {
    return period_maps([](std::size_t) { return liver({}); }, {12.0}, FixedSteps{find_method(method), h});
  };
  EXPECT_THROW(make("rk4", 0), InputError);
  EXPECT_THROW(make("rk4", -1), InputError);
  EXPECT_THROW(make("rk4", std::nan("")), InputError);
  EXPECT_THROW(make("rk4", std::numeric_limits<double>::infinity()), InputError);
  EXPECT_THROW(make("adams_bashforth_2", 0.1), InputError);  // it remembers more than the state
}

/// Motions that are followed for different lengths, two images at a time among them.
TEST(PeriodMaps, MakeTheDiagramOfSingleRuns) {
  const std::vector<double> values{5.305, 5.75, 7.5, 6.475, 0.0};
  const auto problem_at = [&](std::size_t i) {
    return liver({{"m", 1}, {"c", 0.05}, {"k1", 0}, {"k3", 1}, {"w", 1}, {"P", values[i]}});
  };
  const std::vector<double> periods(values.size(), 2 * std::acos(-1.0));
  const FixedSteps steps{find_method("rk4"), 0.1};
  const auto single =
      bifurcation(one_by_one([&](std::size_t i) { return stroboscope(problem_at(i), periods[i], steps); }),
                  values, Vector2d(0.5, 1), 20, 16, false);
  ASSERT_EQ(single.size(), values.size());
  HostDevice device;
  for (const MotionRunner& runner : {in_lanes(), motions_on(device, 3)}) {
    const auto many =
        bifurcation(period_maps(problem_at, periods, steps, runner), values, Vector2d(0.5, 1), 20, 16, false);
    ASSERT_EQ(many.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_EQ(many[i].motion.settling, single[i].motion.settling);
      EXPECT_EQ(many[i].motion.period, single[i].motion.period);
      EXPECT_EQ(many[i].motion.followed, single[i].motion.followed);
      expect_equal(many[i].motion.looks, single[i].motion.looks, std::to_string(values[i]));
    }
  }
}

/// A diagram over w: each motion has a period and steps of its own.
TEST(PeriodMaps, OfManyPeriodsAreThoseOfSingleRunsOnADevice) {
  HostDevice device;
  const std::vector<double> values{0.9, 1.0, 1.1, 1.7};
  const auto problem_at = [&](std::size_t i) {
    return liver({{"m", 1}, {"c", 0.2}, {"k1", 0}, {"k3", 1}, {"P", 3}, {"w", values[i]}});
  };
  std::vector<double> periods;
  for (const double w : values) periods.push_back(2 * std::acos(-1.0) / w);
  const FixedSteps steps{find_method("rk4"), 0.1};
  const auto single =
      bifurcation(period_maps(problem_at, periods, steps), values, Vector2d(0.5, 1), 20, 16, false);
  if (!cosines_are_those_of_musl()) {
    EXPECT_THROW(period_maps(problem_at, periods, steps, motions_on(device, 3)), InputError);
    return;
  }
  const auto there = bifurcation(period_maps(problem_at, periods, steps, motions_on(device, 3)), values,
                                 Vector2d(0.5, 1), 20, 16, false);
  ASSERT_EQ(there.size(), single.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    expect_equal(there[i].motion.looks, single[i].motion.looks, std::to_string(values[i]));
}

TEST(PeriodMaps, SayWhatNoDeviceRuns) {
  HostDevice device;
  const auto make = [&](const char* method) {
    return period_maps([](std::size_t) { return liver({}); }, {6.0}, FixedSteps{find_method(method), 0.1},
                       motions_on(device, 3));
  };
  EXPECT_TRUE(make("rk4"));
  EXPECT_THROW(make("radau_iia_5"), InputError);
  const auto expect_refused = [&](const Problem& problem) {
    EXPECT_THROW(period_maps([&](std::size_t) { return problem; }, {6.0}, {}, motions_on(device, 3)),
                 InputError);
  };
  expect_refused(make_problem("van_der_pol"));
  expect_refused(formulas("p*tanh(t) - x", {1}).front());
}

}  // namespace
}  // namespace hmax
