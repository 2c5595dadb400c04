/// Every adaptive method of the catalogue, also those of Boost.Odeint and SUNDIALS, from a start at rest and
/// over right-hand sides that jump.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "tests/integrators/forced.hpp"

namespace hmax {
namespace {

Problem at_rest(const AnySystem& system) {
  return {.id = "forced", .states = {"y"}, .y0 = Eigen::VectorXd::Zero(1), .system = system};
}

class AdaptiveMethod : public testing::TestWithParam<std::string> {
 protected:
  Method method = find_method(GetParam());
  bool own = method.engine == own_engine;
  [[nodiscard]] RunRecord run(const AnySystem& system, RunSpec spec, const Sink& sink = {}) const {
    spec.adaptive = true;
    spec.max_steps = 5'000'000;
    return method.bind(at_rest(system)).run(spec, sink);
  }
};

std::vector<std::string> started_methods() {
  std::vector<std::string> ids;
  for (const Method& method : methods())
    if (method.adaptive()) ids.push_back(method.id);
  return ids;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, AdaptiveMethod, testing::ValuesIn(started_methods()),
                         [](const auto& tested) { return tested.param; });

TEST_P(AdaptiveMethod, SeesForcesThatBeginAtZeroInEveryUnitOfTime) {
  // Stages of SUNDIALS are solved loosely.
  const double share = own ? 3e-3 : 1e-2, size = own ? 1e-4 : 2e-4;
  for (const double unit : {1e-9, 1e-3, 1.0, 1e3, 1e9})
    for (const forced::Forcing& forcing : forced::forcings())
      for (const Controllers control : {Controllers::deadband, Controllers::matlab}) {
        if (!own && control == Controllers::matlab) continue;
        const RunRecord record = run(AnySystem(forced::Forced{forcing.g, unit}),
                                     {.t_end = 10 * unit, .rtol = 1e-5, .atol = 1e-7, .control = control});
        EXPECT_EQ(record.outcome, Outcome::reached_end) << forcing.name << " " << unit;
        // Motions are of the size one; the least that is left of one is 0.006.
        EXPECT_NEAR(record.y[0], forcing.end, share * std::abs(forcing.end) + size)
            << forcing.name << " " << unit;
      }
}

TEST_P(AdaptiveMethod, GoesOverJumpsThatTheModelNames) {
  for (const double height : {1.0, 1e6})
    for (const bool at_once : {true, false})
      for (const Controllers control : {Controllers::deadband, Controllers::matlab}) {
        if (!own && control == Controllers::matlab) continue;
        const forced::Switched system{.height = height, .at_once = at_once};
        std::vector<double> ends;
        const RunRecord record =
            run(AnySystem(system), {.t_end = 10, .rtol = 1e-5, .atol = 1e-7, .control = control},
                [&](double t, const auto&) { ends.push_back(t); });
        EXPECT_EQ(record.outcome, Outcome::reached_end) << height << at_once << record.note;
        EXPECT_NEAR(record.y[0] / height, system.end() / height, 5e-4) << height << at_once;
        for (const double jump : {3.0, 7.0})
          EXPECT_TRUE(std::ranges::any_of(ends, [&](double t) { return std::abs(t - jump) < 1e-13 * jump; }))
              << jump;
        // Up to the jump nothing acts: no step is rejected for the sake of it.
        EXPECT_LT(std::ranges::count_if(ends, [](double t) { return t <= 3; }), 25);
      }
}

TEST_P(AdaptiveMethod, KeepsToTheFirstAndTheLongestStepOfTheUser) {
  std::vector<double> times;
  RunSpec spec{.t_end = 10, .adaptive = true, .rtol = 1e-3, .atol = 1e-3, .h_first = 0.01, .h_max = 0.25};
  const AnySystem half_a_sine(forced::Forced{forced::forcings()[1].g});
  method.bind(at_rest(half_a_sine)).run(spec, [&](double t, const auto&) { times.push_back(t); });
  ASSERT_GT(times.size(), 10U);
  EXPECT_LE(times[1], 0.01 * (1 + 1e-12));
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_LE(times[i] - times[i - 1], 0.25 * 1.0101) << i;
}

}  // namespace
}  // namespace hmax
