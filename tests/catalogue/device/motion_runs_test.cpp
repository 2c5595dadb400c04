/// Motions of oscillators by the programs of devices: the bits of the lanes of the processor, on the
/// processor in every build and on a card where there is one.
#include "catalogue/device/motion_runs.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/device/host_device.hpp"
#include "catalogue/models/planar.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "core/instructions/cosines.hpp"
#include "tests/catalogue/device/gpu.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;

constexpr std::size_t motion_count = 10'000;

/// Oscillators of all kinds with starts near and far, some of them no numbers: what runs away is among them.
struct Ensemble {
  std::vector<Oscillator> systems;
  std::vector<OscillatorRun> runs;

  /// @param w  of the forces; 0: of each its own, as are the periods
  Ensemble(std::size_t count, double w) {
    std::mt19937_64 random(19);
    const auto number = [&](double least, double most) {
      return std::uniform_real_distribution<double>(least, most)(random);
    };
    for (std::size_t i = 0; i < count; ++i)
      systems.emplace_back(OscillatorParameters{.m = number(0.5, 2),
                                                .c = number(-0.2, 1),
                                                .k1 = number(-1, 2),
                                                .k3 = i % 7 == 0 ? -1 : number(0, 2),
                                                .P = i % 5 == 0 ? 0 : number(-2, 8),
                                                .w = w != 0 ? w : number(0.3, 40)});
    for (const Oscillator& system : systems) {
      const double size = runs.size() % 11 == 0 ? 30 : 3;
      runs.push_back({&system,
                      2 * std::numbers::pi / system.parameters().w,
                      {number(-size, size), number(-size, size)}});
    }
    runs[count / 3].y = {1e200, 0};
    runs[count / 2].y = {0, std::nan("")};
  }
};

std::vector<OscillatorRun> ends_of(const RunMotions& run, std::vector<OscillatorRun> runs) {
  std::size_t begun = 0, ended = 0;
  run({[&]() { return begun < runs.size() ? &runs[begun++] : nullptr; }, [&](OscillatorRun&) { ++ended; }});
  EXPECT_EQ(ended, runs.size());
  return runs;
}

std::array<std::uint64_t, 2> plane_bits(const Vector2d& y) {
  return {std::bit_cast<std::uint64_t>(y[0]), std::bit_cast<std::uint64_t>(y[1])};
}

using Devices = std::vector<Device*>;

/// How many have ended in which way, after a comparison of all bits.
std::map<Outcome, std::size_t> expect_same_ends(const Devices& devices,
                                                const std::function<RunMotions(Device&)>& found,
                                                const RunMotions& expected,
                                                const std::vector<OscillatorRun>& runs) {
  const auto here = ends_of(expected, runs);
  for (Device* device : devices) {
    const auto there = ends_of(found(*device), runs);
    std::size_t unequal = 0;
    for (std::size_t i = 0; i < runs.size(); ++i)
      unequal += there[i].outcome != here[i].outcome || there[i].attempts != here[i].attempts ||
                 (is_bounded(here[i].y) && plane_bits(there[i].y) != plane_bits(here[i].y));
    EXPECT_EQ(unequal, 0U) << "of " << runs.size();
  }
  std::map<Outcome, std::size_t> outcomes;
  for (const OscillatorRun& run : here) ++outcomes[run.outcome];
  return outcomes;
}

void expect_same_shared(const Devices& devices) {
  const Ensemble all(motion_count, 1.3);
  const double period = all.runs.front().t_end;
  for (const char* method : {"rk4", "dormand_prince_54", "rk2_heun", "dop_853"}) {
    const SharedSteps steps{.method = method, .w = 1.3, .t_end = period, .h = period / 230.5};
    const auto outcomes = expect_same_ends(
        devices, [&](Device& device) { return motions_on(device, 3000).shared(steps); },
        in_lanes().shared(steps), all.runs);
    EXPECT_GT(outcomes.at(Outcome::diverged), 100U) << method;
    EXPECT_GT(outcomes.at(Outcome::reached_end), motion_count / 2) << method;
  }
  const Ensemble few(70, 1.3);  // for more steps than a launch takes
  const SharedSteps steps{.method = "rk4", .w = 1.3, .t_end = period, .h = period / 2500};
  expect_same_ends(
      devices, [&](Device& device) { return motions_on(device, 3000).shared(steps); },
      in_lanes().shared(steps), few.runs);
}

/// Beside steps that are shared by a single motion.
void expect_same_own_steps(const Devices& devices) {
  Ensemble all(motion_count, 0);
  for (std::size_t i = 0; i < all.runs.size(); ++i)
    all.runs[i].h = all.runs[i].t_end / (80.0 + static_cast<double>(i % 90));
  for (const std::string_view method : {"rk4", "dormand_prince_54", "explicit_euler", "rk4_38"}) {
    const auto expected = [method](const RunClient& client) {
      while (OscillatorRun* run = client.next()) {
        const SharedSteps steps{
            .method = method, .w = run->system->parameters().w, .t_end = run->t_end, .h = run->h};
        in_lanes().shared(steps)({[&] { return std::exchange(run, nullptr); }, client.ended});
      }
    };
    const auto outcomes = expect_same_ends(
        devices, [&](Device& device) { return motions_on(device, 3000).own_steps(method); }, expected,
        all.runs);
    EXPECT_GT(outcomes.at(Outcome::reached_end), motion_count / 2) << method;
  }
}

void expect_same_adaptive(const Devices& devices) {
  const Ensemble all(motion_count, 0);
  const auto outcomes_at = [&](double tolerance, std::int64_t most) {
    const AdaptiveSteps steps{.tolerances = {tolerance, tolerance}, .most_attempts = most, .steady = false};
    return expect_same_ends(
        devices, [&](Device& device) { return motions_on(device, 3000).adaptive(steps); },
        in_lanes().adaptive(steps), all.runs);
  };
  auto outcomes = outcomes_at(1e-11, 4000);
  EXPECT_GT(outcomes[Outcome::reached_end], motion_count / 2);
  EXPECT_GT(outcomes[Outcome::diverged] + outcomes[Outcome::step_too_small], 100U);
  outcomes = outcomes_at(1e-6, 25);
  EXPECT_GT(outcomes[Outcome::too_many_steps], 100U);
}

/// x' = v and v' as it is given, maybe by a number p.
Problem formulas(const std::string& acceleration, double p = 1) {
  return make_problem({.name = acceleration,
                       .equations = {{"x", "v"}, {"v", acceleration}},
                       .parameters = {{"p", p}},
                       .y0 = {1, 0},
                       .t_end = 200},
                      "my.toml");
}

/// In groups that are not those of rows.
std::vector<int> expect_same_fates(const Devices& devices, const Problem& problem, const Window& window) {
  const auto equilibria = find_equilibria(planar_field(problem, 0, window.size()), window);
  const auto grid = [&](const MotionRunner& runner, std::size_t at_once) {
    const std::vector<FatesOf> each(64, fates_of_starts(problem, window, equilibria, runner));
    return basins(each, window, 50, 41, {}, at_once).fate;
  };
  std::vector<int> fates = grid(in_lanes(), 1);
  for (Device* device : devices) EXPECT_EQ(grid(motions_on(*device, 700), 800), fates) << problem.id;
  return fates;
}

/// The states at which runs of formulas end, by adaptive steps and by fixed ones: numbers differ from motion
/// to motion, as do the sides of jumps that motions are on.
void expect_same_ends_of_formulas(const Devices& devices, const std::string& acceleration, double t_end,
                                  std::int64_t most_attempts = 4000) {
  SCOPED_TRACE(acceleration);
  FormulaPrograms programs;
  std::vector<FormulaPiece> pieces;
  for (const double p : {1.0, 0.3, 2.0, -0.7, 0.0}) {
    const Problem problem = formulas(acceleration, p);
    const auto& system = std::get<AnySystem>(problem.system);
    programs.push_back(system.formulas());
    for (const double from : {-PlanarFormulas::forever, t_end / 5}) {
      pieces.push_back({{system.formulas(), system.is_autonomous()}, {t_end / 10, t_end}, t_end});
      pieces.back().system.confine(from, from < 0 ? -from : 4 * from);
    }
  }
  std::vector<OscillatorRun> runs;
  for (const OscillatorRun& run : Ensemble(2000, 1.3).runs)
    runs.push_back({.system = nullptr,
                    .t_end = t_end,
                    .y = run.y,
                    .h = t_end / (150.0 + static_cast<double>(runs.size() % 70)),
                    .piece = &pieces[runs.size() % pieces.size()],
                    .attempts = static_cast<std::int64_t>(runs.size() % 3)});
  const AdaptiveSteps steps{.tolerances = {1e-9, 1e-9}, .most_attempts = most_attempts, .steady = true};
  auto outcomes = expect_same_ends(
      devices, [&](Device& device) { return motions_on(device, 700).formulas(steps, programs); },
      in_lanes().formulas(steps, programs), runs);
  EXPECT_GT(outcomes[most_attempts < 4000 ? Outcome::too_many_steps : Outcome::reached_end], 1000U);
  for (FormulaPiece& piece : pieces) piece.span.t0 = 0;
  runs.resize(800);
  for (const std::string_view method : {"rk4", "dormand_prince_54", "explicit_euler"}) {
    outcomes = expect_same_ends(
        devices, [&](Device& device) { return motions_on(device, 700).formula_steps(method, programs); },
        in_lanes().formula_steps(method, programs), runs);
    EXPECT_GT(outcomes[Outcome::reached_end], 400U);
  }
}

/// Formulas: a pendulum with places of rest beside one another, one that is driven away, a spring that
/// breaks, a stop that a condition tells, and functions that are exact.
void expect_same_fates_of_formulas(const Devices& devices) {
  const Window wide{{-9, -4}, {9, 4}}, window{{-3, -3}, {3, 3}};
  std::ptrdiff_t leave = 0, rest = 0;
  const auto look = [&](const std::string& acceleration, const Window& seen) {
    const std::vector<int> fates = expect_same_fates(devices, formulas(acceleration), seen);
    leave += std::ranges::count(fates, int{unbounded});
    rest += std::ranges::count_if(fates, [](int fate) { return fate >= 0; });
  };
  look("x - x^3 - 0.2*v", window);
  look("-x + x^3 - v/2", window);
  look("x > 1 ? -x - 40*(x - 1) - v : -x - 0.3*v", window);
  look("sqrt(abs(x)) * (x < 0) - max(x, min(v, 1))^4 - 0.7*v + sign(v)*rint(x/9)", window);
  if (cosines_are_those_of_musl()) {
    look("-sin(x) - 0.2*v*(2 + cos(3*x))", wide);
    // Angles that escape, and angles that are no numbers.
    look("(x > 2 ? 1000*x + sin(x) : -x) - 0.2*v", window);
    look("x - x^3 - 0.2*v + sin(sqrt(x + 2))/100", window);
    look("-x - 0.2*v + sin(1/(x - 0.9))/100", window);
  }
  EXPECT_GT(leave, 500);
  EXPECT_GT(rest, 4000);
  expect_same_ends_of_formulas(devices, "sqrt(abs(x)) - max(x, min(v, 1))^4/90 - 0.7*v/(1 + x^2)", 7);
  expect_same_ends_of_formulas(devices, "x > 1 ? -x - 40*(x - 1) : -x", 30, 25);
  expect_same_ends_of_formulas(devices, "(t < 3 ? p*t : 1) - x - x^3/9 - v/2", 7);
  if (!cosines_are_those_of_musl()) return;
  expect_same_ends_of_formulas(devices, "-sin(3*x) - 0.2*v*(2 + cos(3*x))", 7);
  // Angles beyond those that a device reduces, in all of its digits.
  expect_same_ends_of_formulas(devices, "-sin(1e7*x)", 1e-6);
  expect_same_ends_of_formulas(devices, "p*cos(3*t) - x^3 - v/5", 7);
  expect_same_ends_of_formulas(devices, "p*cos(3e7*t)/1e11 - x - v", 7);
}

/// Two places of rest, starts that are bound to leave, and a window with one of two places.
void expect_same_fates(const Devices& devices) {
  std::ptrdiff_t leave = 0;
  for (const auto& [parameters, window] :
       std::vector<std::pair<Parameters, Window>>{{{{"k1", -1}, {"c", 0.2}}, {{-3, -3}, {3, 3}}},
                                                  {{{"k1", 1}, {"k3", -1}, {"c", 0.5}}, {{-3, -3}, {3, 3}}},
                                                  {{{"k1", -1}, {"c", 0.3}}, {{0.2, -1}, {2, 1}}}}) {
    const Problem problem = make_problem("liver_cubic", {.parameters = parameters});
    const auto equilibria = find_equilibria(planar_field(problem, 0, window.size()), window);
    const auto grid = [&](const MotionRunner& runner, std::size_t at_once) {
      const std::vector<FatesOf> each(64, fates_of_starts(problem, window, equilibria, runner));
      return basins(each, window, 110, 91, {}, at_once).fate;
    };
    const std::vector<int> fates = grid(in_lanes(), 1);
    for (Device* device : devices) EXPECT_EQ(grid(motions_on(*device, 3000), 4000), fates);
    EXPECT_GT(std::ranges::count_if(fates, [](int fate) { return fate >= 0; }), 1000);
    leave += std::ranges::count(fates, int{unbounded});
  }
  EXPECT_GT(leave, 1000);
}

TEST(HostDevice, RunsMotionsWithTheBitsOfTheLanes) {
  HostDevice forwards, backwards(true);
  const Devices devices{&forwards, &backwards};
  expect_same_shared(devices);
  expect_same_fates(devices);
  expect_same_fates_of_formulas(devices);
  if (!cosines_are_those_of_musl()) return;
  expect_same_own_steps(devices);
  expect_same_adaptive(devices);
}

TEST(MotionRuns, RefuseWhatHasOtherBits) {
  HostDevice device;
  const MotionRunner runner = motions_on(device, 10);
  const AdaptiveSteps steps{.tolerances = {1e-9, 1e-9}, .most_attempts = 100, .steady = false};
  const Oscillator fast({.w = 1e6});
  if (cosines_are_those_of_musl())
    EXPECT_THROW(ends_of(runner.adaptive(steps), {{&fast, 10, {1, 0}}}), InputError);
  else
    EXPECT_THROW(runner.adaptive(steps), InputError);
  EXPECT_THROW(fates_of_starts(make_problem("van_der_pol"), {{-1, -1}, {1, 1}}, {}, runner), InputError);
  const auto fates = [&](const std::string& acceleration) {
    return fates_of_starts(formulas(acceleration), {{-1, -1}, {1, 1}}, {}, runner);
  };
  EXPECT_THROW(fates("-exp(x) - v"), InputError);
  EXPECT_THROW(fates("-x + cos(3)*t"), InputError);
  std::string many = "-x";
  for (int i = 2; i < 90; ++i) many += " + abs(x - " + std::to_string(i) + ")";
  EXPECT_THROW(fates(many), InputError);
  EXPECT_FALSE(runner.shared({.method = "radau_iia_5", .w = 1, .t_end = 1, .h = 0.1}));
  const auto exponential = std::get<AnySystem>(formulas("-exp(x) - v").system).formulas();
  EXPECT_THROW(runner.formula_steps("rk4", {exponential}), InputError);
  EXPECT_FALSE(runner.formula_steps("radau_iia_5", {exponential}));
}

TEST_F(Gpu, RunsSharedStepsWithTheBitsOfTheLanes) { expect_same_shared({device.get()}); }
TEST_F(Gpu, FindsBasinsWithTheBitsOfTheLanes) {
  expect_same_fates({device.get()});
  expect_same_fates_of_formulas({device.get()});
}
TEST_F(Gpu, RunsMotionsOfOwnCosinesWithTheBitsOfTheLanes) {
  if (!cosines_are_those_of_musl()) GTEST_SKIP() << "this build has other cosines";
  expect_same_adaptive({device.get()});
  expect_same_own_steps({device.get()});
}

/// Told to scripts/gpu-check: what a million motions take by the events of the device.
TEST_F(Gpu, TellsItsSpeed) {
  constexpr std::size_t many = 1'000'000, steps_of_period = 1000;
  std::vector<Oscillator> systems;
  for (std::size_t i = 0; i < many; ++i)
    systems.emplace_back(OscillatorParameters{.c = 0.05, .P = 5 + 3e-6 * static_cast<double>(i), .w = 1});
  const double period = 2 * std::numbers::pi;
  std::vector<OscillatorRun> runs;
  for (const Oscillator& system : systems) runs.push_back({&system, period, {0.5, 1}});
  const MotionRunner runner = motions_on(*device, many);
  double wall = 0;  // [s] of the last one, with first steps and copies
  const auto seconds_of = [&](const RunMotions& run) {
    ends_of(run, runs);  // warm
    static_cast<void>(device->seconds());
    const auto begin = std::chrono::steady_clock::now();
    ends_of(run, runs);
    wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return device->seconds();
  };
  const double fixed = seconds_of(
      runner.shared({.method = "rk4", .w = 1, .t_end = period, .h = period / double{steps_of_period}}));
  RecordProperty("rk4_steps_per_second", std::to_string(double{many} * steps_of_period / fixed));
  if (!cosines_are_those_of_musl()) return;
  const double adaptive =
      seconds_of(runner.adaptive({.tolerances = {1e-6, 1e-9}, .most_attempts = 1'000'000, .steady = false}));
  RecordProperty("adaptive_periods_per_wall_second", std::to_string(double{many} / wall));
  for (OscillatorRun& run : runs) run.h = period / double{steps_of_period};
  RecordProperty("rk4_own_steps_per_second",
                 std::to_string(double{many} * steps_of_period / seconds_of(runner.own_steps("rk4"))));
  RecordProperty("adaptive_periods_per_second", std::to_string(double{many} / adaptive));
}

}  // namespace
}  // namespace hmax
