#include "catalogue/models/planar.hpp"

#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "bench/timing/reference.hpp"
#include "catalogue/device/host_device.hpp"
#include "catalogue/device/motion_runs.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "problems/oscillator/liver_problems.hpp"
#include "tests/results/scratch.hpp"

namespace hmax {
namespace {

using Eigen::Vector2d;

Problem liver(const std::vector<std::pair<std::string, double>>& set, const std::string& id = "liver_cubic") {
  return make_problem(id, {.parameters = set});
}

std::vector<Equilibrium> equilibria_of(const Problem& problem, const Window& window) {
  return find_equilibria(planar_field(problem, 0, window.size()), window);
}

TEST(Planar, FormulasAreClassifiedWithoutAJacobianOfTheirs) {
  const Scratch scratch;
  write_text(scratch / "well.toml",
             "[equations]\nx = \"v\"\nv = \"(x - x^3 - c*v)\"\n[parameters]\nc = 0\n[initial]\nx = 0.5\nv = "
             "0\n");
  const auto types = [&](double c) {
    std::vector<std::string> names;
    const Problem problem = make_problem(scratch / "well.toml", {.parameters = {{"c", c}}});
    for (const Equilibrium& e : equilibria_of(problem, {{-2, -2}, {2, 2}})) {
      names.emplace_back(name_of(e.type));
      EXPECT_NEAR(std::abs(e.state(0)), names.size() == 2 ? 0 : 1, 1e-13);
    }
    return names;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(types(0), (Names{"centre", "saddle", "centre"}));
  EXPECT_EQ(types(0.5), (Names{"stable_focus", "saddle", "stable_focus"}));
  EXPECT_EQ(types(-0.5), (Names{"unstable_focus", "saddle", "unstable_focus"}));
  EXPECT_EQ(types(3), (Names{"stable_node", "saddle", "stable_node"}));
}

TEST(Planar, KnowsWhatIsDriven) {
  EXPECT_TRUE(is_driven(liver({}, "liver_forced")));
  EXPECT_FALSE(is_driven(liver({{"P", 0}}, "liver_forced")));
  EXPECT_FALSE(is_driven(liver({{"w", 0}}, "liver_forced")));  // pushed, but always alike
  EXPECT_FALSE(is_driven(make_problem("van_der_pol")));
  const Scratch scratch;
  write_text(scratch / "still.toml", "[equations]\na = \"b\"\nb = \"-a\"\n[initial]\na = 1\nb = 0\n");
  write_text(scratch / "driven.toml",
             "[equations]\na = \"b\"\nb = \"-a + a*b*sin(2*pi*t)\"\n[initial]\na = 1\nb = 0\n");
  EXPECT_FALSE(is_driven(make_problem(scratch / "still.toml")));
  EXPECT_TRUE(is_driven(make_problem(scratch / "driven.toml")));
}

TEST(Planar, AFrozenProblemIsTheFieldOfItsInstant) {
  const Scratch scratch;
  write_text(scratch / "driven.toml",
             "[equations]\nx = \"v\"\nv = \"(0.5*cos(0.5*t) - 2*v - 0.7*x - 0.8*x^3)/1.45\"\n[initial]\nx = "
             "0.5\nv = 1\n");
  const Vector2d y(0.3, -0.4), expected(-0.4, (0.5 * std::cos(1.5) + 0.8 - 0.21 - 0.8 * 0.027) / 1.45);
  for (const Problem& problem : {liver({}, "liver_forced"), make_problem(scratch / "driven.toml")}) {
    const Problem still = frozen(problem, 3);
    EXPECT_FALSE(is_driven(still));
    for (const PlanarField& field :
         {planar_field(problem, 3, {1, 1}), planar_field(still, 0, {1, 1}), planar_field(still, 7, {1, 1})})
      EXPECT_LT((field.rhs(y) - expected).norm(), 1e-15) << problem.id;
    EXPECT_LT((planar_field(reversed(still), 0, {1, 1}).rhs(y) + expected).norm(), 1e-15) << problem.id;
  }
}

TEST(Planar, AnOrbitGoesThereAndBackAgain) {
  const Problem problem = liver({{"c", 0.4}});
  const Window window{{-2, -2}, {2, 2}};
  const Table there = orbit(problem, {0.5, 1}, 5, window, 1e9);
  const Vector2d end(there.values[0].back(), there.values[1].back());
  const Table back = orbit(reversed(problem), end, 5, window, 1e9);
  EXPECT_NEAR(back.values[0].back(), 0.5, 1e-4);
  EXPECT_NEAR(back.values[1].back(), 1, 1e-4);
  // So dense that the line between two points is the curve.
  for (std::size_t i = 1; i < there.values[0].size(); ++i)
    EXPECT_LT(
        std::hypot(there.values[0][i] - there.values[0][i - 1], there.values[1][i] - there.values[1][i - 1]),
        0.1);
}

/// A linear motion has one shape in any size.
TEST(Planar, OrbitsOfNanometresAreThoseOfMetres) {
  const Problem problem = liver({{"c", 0.4}, {"k3", 0}});
  const auto end_of = [&](double size) -> Vector2d {
    const Vector2d reach(2 * size, 2 * size);
    const Table way = orbit(problem, {0.5 * size, size}, 5, {-reach, reach}, 1e9);
    return Vector2d(way.values[0].back(), way.values[1].back()) / size;
  };
  EXPECT_LT((end_of(1e-9) - end_of(1)).norm(), 1e-5);
  EXPECT_EQ(tolerances_at(orbit_tolerances, 2).atol, orbit_tolerances.atol);
  EXPECT_EQ(tolerances_at(orbit_tolerances, 0).atol, orbit_tolerances.atol);
  EXPECT_EQ(tolerances_at(orbit_tolerances, 2.3e-9).atol, 2e-17);
  // States in a narrow window may be large.
  const Vector2d one(1, 1), narrow(1e-9, 1e-9);
  EXPECT_EQ(tolerances_in({one - narrow, one + narrow}, orbit_tolerances).atol, orbit_tolerances.atol);
}

TEST(Planar, AnOrbitThatRunsAwayEndsNearTheWindow) {
  const Table runaway = orbit(liver({{"c", -2}, {"k3", 0}}), {0.5, 1}, 100, {{-1, -1}, {1, 1}}, 1e9);
  EXPECT_LT(std::hypot(runaway.values[0].back(), runaway.values[1].back()), 20);
}

TEST(Planar, TheDefaultWindowHoldsTheEquilibriaOfTheDoubleWell) {
  const Window window = default_window(liver({{"k1", -1}, {"c", 0.3}}));
  EXPECT_LT(window.lower(0), -std::sqrt(1 / 0.8));
  EXPECT_GT(window.upper(0), std::sqrt(1 / 0.8));
  // What runs away does not take the window along.
  EXPECT_LT(default_window(liver({{"c", -0.2}})).upper(0), 20);
  EXPECT_LT(default_window(liver({{"c", -2}})).upper(0), 30);
}

TEST(Planar, TheWindowOfADrivenOscillatorHoldsItsResonance) {
  // ((k1 - m w^2 + 3/4 k3 A^2)^2 + (c w)^2) A^2 = P^2 at A = 10: (1e-4 + 1e-4) 100 = 0.02; the rest under the
  // force of the start is at 0.14.
  const Window window = window_of_motions(
      liver({{"m", 1}, {"k1", 1}, {"k3", 4e-4 / 3}, {"c", 0.01}, {"w", 1}, {"P", std::sqrt(0.02)}},
            "liver_forced"),
      {}, 1);
  for (const int i : {0, 1}) {
    EXPECT_LT(window.lower(i), -10);
    EXPECT_GT(window.lower(i), -15);
    EXPECT_GT(window.upper(i), 10);
    EXPECT_LT(window.upper(i), 15);
  }
}

TEST(Planar, RefusesWhatHasNotTwoStates) {
  for (const char* id : {"lorenz", "dahlquist", "kepler"})
    EXPECT_THROW(require_planar(make_problem(id)), InputError) << id;
  EXPECT_NO_THROW(require_planar(make_problem("van_der_pol")));
}

TEST(Planar, TheStroboscopeIsTheMotionOverOnePeriod) {
  const Problem problem = liver({}, "liver_forced");
  const double period = drive_period(problem, {});
  EXPECT_NEAR(period, 4 * std::acos(-1.0), 1e-14);
  const Reference reference = make_reference(problem, 3 * period);
  const VectorFunction next = stroboscope(problem, period);
  const Eigen::VectorXd third = next(next(next(problem.y0)));
  EXPECT_LT((third - reference.at(3 * period)).norm(), 1e-9);
  EXPECT_THROW(drive_period(problem, period / 2), InputError);
  EXPECT_EQ(drive_period(problem, 2 * period), 2 * period);
}

/// The fates of a grid of starts, those outside what a number holds among them, by single runs.
void expect_the_fates_of_single_runs(const Problem& problem, const Window& window) {
  const auto equilibria = equilibria_of(problem, window);
  const auto fate_of = fate_of_starts(problem, window, equilibria);
  std::vector<Vector2d> starts{{1e200, 0}, {std::nan(""), 0}, {1e9, 1e9}};
  for (const Equilibrium& e : equilibria) starts.push_back(e.state);
  for (int i = 0; i < 23; ++i)
    for (int j = 0; j < 19; ++j)
      starts.push_back(window.lower + Vector2d((i + 0.5) / 23, (j + 0.5) / 19).cwiseProduct(window.size()));
  std::vector<int> expected;
  for (const Vector2d& start : starts) expected.push_back(fate_of(start));
  for (const InstructionSet set : instruction_sets()) {
    std::size_t ended = 0;
    const FatesOf fates_of = fates_of_starts(problem, window, equilibria, in_lanes(set), [&] { ++ended; });
    std::vector<int> fates(starts.size(), 77);
    fates_of(starts, fates);
    EXPECT_EQ(fates, expected) << to_string(set);
    EXPECT_EQ(ended, starts.size()) << to_string(set);
    // A start has its fate whoever runs beside it: fewer starts than lanes, in the opposite order.
    std::vector<Vector2d> few(starts.rend() - 17, starts.rend());
    std::vector<int> fates_of_few(few.size(), 77);
    fates_of(few, fates_of_few);
    EXPECT_EQ(fates_of_few, std::vector<int>(expected.rend() - 17, expected.rend())) << to_string(set);
  }
}

/// Motions for which only an interruption is an end: some 20 million steps each.
TEST(Fates, AreUndecidedOnceInterrupted) {
  const std::atomic<bool> interrupted = true;
  HostDevice device;
  std::vector<MotionRunner> runners{in_lanes(), motions_on(device, 64)};
  for (MotionRunner& runner : runners) runner.interrupted = &interrupted;
  const Window window{{-3, -3}, {3, 3}};
  const std::vector<Vector2d> starts(9, Vector2d(2, 1));
  const std::vector<std::pair<std::string, double>> slow{{"k1", -1}, {"k3", 1}, {"c", 1e5}};
  for (const Problem& problem :
       {liver(slow), frozen(liver(slow, "liver_forced"), 0),
        make_problem({.name = "slow", .equations = {{"x", "v"}, {"v", "x - x^3 - 1e5*v"}}, .y0 = {1, 0}},
                     "my.toml")}) {
    for (const MotionRunner& runner : runners) {
      std::vector<int> fates(starts.size(), 77);
      fates_of_starts(problem, window, equilibria_of(problem, window), runner)(starts, fates);
      EXPECT_EQ(fates, std::vector<int>(starts.size(), undecided)) << problem.id;
    }
  }
  const Problem alone = liver(slow);
  EXPECT_EQ(fate_of_starts(alone, window, equilibria_of(alone, window), &interrupted)({2, 1}), undecided);
}

TEST(Fates, AreThoseOfSingleRuns) {
  expect_the_fates_of_single_runs(liver({{"k1", -1}, {"c", 0.2}}), {{-3, -3}, {3, 3}});
  // Soft springs that run away, and a force that is constant in time.
  expect_the_fates_of_single_runs(liver({{"k1", 1}, {"k3", -1}, {"c", 0.5}}), {{-3, -3}, {3, 3}});
  expect_the_fates_of_single_runs(frozen(liver({{"k1", -1}, {"c", 0.4}}, "liver_forced"), 0),
                                  {{-3, -3}, {3, 3}});
  expect_the_fates_of_single_runs(
      make_problem({.name = "well", .equations = {{"x", "v"}, {"v", "x - x^3 - v/5"}}, .y0 = {1, 0}},
                   "my.toml"),
      {{-3, -3}, {3, 3}});
  // A window with one of two places of rest: starts that settle outside are undecided.
  expect_the_fates_of_single_runs(liver({{"k1", -1}, {"c", 0.3}}), {{0.2, -1}, {2, 1}});
}

}  // namespace
}  // namespace hmax
