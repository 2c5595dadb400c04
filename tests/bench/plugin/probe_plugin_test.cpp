/// Limits of steppers behind the plugin interface, beside what is known of them in closed form.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/foreign_steps/step_probe.hpp"
#include "bench/plugin/plugin_stepper.hpp"
#include "results/errors.hpp"

namespace hmax {
namespace {

ProbedLimit probed(const std::string& entry, ProbeSettings settings, const std::string& file = TESTED_PLUGIN) {
  PluginStepper engine(parse_plugin(file + ":" + entry));
  settings.seconds_a_run = 0.3;
  return probe_steps(engine, settings);
}

std::string status_of(const ProbedLimit& found) {
  std::string all;
  for (const std::string& remark : found.status) all += remark + "; ";
  return all;
}

double limit_of_chain(double n) { return 1 / (100 * std::sin(n * std::numbers::pi / (2 * n + 2))); }

TEST(ProbePlugin, SymplecticEulerOnAChainHasItsKnownLimit) {
  const ProbedLimit found = probed("chain", {.h0 = 1e-4, .h1 = 0.1});
  EXPECT_NEAR(found.h_max, limit_of_chain(10), 5e-4 * found.h_max);
  EXPECT_NEAR(found.observed, found.h_max, 5e-3 * found.h_max);
  EXPECT_LT(std::abs(found.gap), 5e-3);
  EXPECT_EQ(found.state, ProbedState::equilibrium);
  EXPECT_TRUE(found.status.empty()) << status_of(found);
  ASSERT_TRUE(found.critical);
  EXPECT_LT(found.critical->multiplier.real(), -1);
  EXPECT_NEAR(found.critical->multiplier.imag(), 0, 1e-6);
  // The fastest mode of a chain moves its middle most.
  ASSERT_FALSE(found.moving.empty());
  EXPECT_TRUE(found.moving.front() % 10 == 4 || found.moving.front() % 10 == 5) << found.moving.front();
}

TEST(ProbePlugin, ExplicitEulerOnADampedOscillatorHasItsKnownLimit) {
  const ProbedLimit found = probed("explicit_euler", {.h0 = 1e-3, .h1 = 1});
  EXPECT_NEAR(found.h_max, 0.02, 1e-5);
  EXPECT_NEAR(found.observed, 0.02, 1e-4);
  ASSERT_TRUE(found.critical);
  EXPECT_NE(found.critical->multiplier.imag(), 0);
}

TEST(ProbePlugin, SinglePrecisionIsNoInstability) {
  const ProbedLimit found = probed("float_chain", {.h0 = 1e-4, .h1 = 0.1});
  EXPECT_NEAR(found.h_max, limit_of_chain(10), 5e-3 * found.h_max);
  EXPECT_NEAR(found.observed, found.h_max, 5e-3 * found.h_max);
}

TEST(ProbePlugin, RotationsAreDisturbedInTheirTangentSpace) {
  const ProbedLimit found = probed("gimbal", {.h0 = 1e-3, .h1 = 1});
  EXPECT_NEAR(found.h_max, 0.05, 5e-5);
  EXPECT_NEAR(found.observed, 0.05, 2.5e-4);
  EXPECT_EQ(found.dim, 7);
}

TEST(ProbePlugin, TwelveHundredNumbersTakeProductsAlone) {
  const ProbedLimit found = probed("chain:600", {.h0 = 1e-3, .h1 = 0.05, .rows = 6});
  EXPECT_EQ(found.dim, 1200);
  EXPECT_NEAR(found.h_max, limit_of_chain(600), 5e-3 * found.h_max);
  EXPECT_NEAR(found.observed, found.h_max, 5e-3 * found.h_max);
}

TEST(ProbePlugin, AMethodThatIsStableAtEveryStepIsUnbounded) {
  const ProbedLimit found = probed("implicit_euler", {.h0 = 1e-2, .h1 = 100});
  EXPECT_TRUE(std::isinf(found.h_max));
  EXPECT_TRUE(std::isinf(found.observed));
  EXPECT_TRUE(std::isnan(found.gap));
}

TEST(ProbePlugin, AnUnstableModelHasNoLimit) {
  const ProbedLimit found = probed("unstable", {.h0 = 1e-3, .h1 = 0.1});
  EXPECT_TRUE(std::isnan(found.h_max));
  EXPECT_NE(status_of(found).find("the model itself is unstable"), std::string::npos) << status_of(found);
}

TEST(ProbePlugin, AlongAMotionNeighboursDecide) {
  // At rest 2 / 10; with 0.2 m the stiffness is up to 13 times that at rest.
  const ProbedLimit rest = probed("stiffening:0", {.h0 = 1e-3, .h1 = 1});
  EXPECT_NEAR(rest.h_max, 0.2, 2e-4);
  const ProbedLimit motion = probed("stiffening:0.2", {.h0 = 1e-3, .h1 = 1, .motion = 8, .rows = 8});
  EXPECT_EQ(motion.state, ProbedState::motion);
  EXPECT_LT(motion.h_max, 0.2);
  EXPECT_GT(motion.h_max, 0.02);
  EXPECT_NEAR(motion.observed, motion.h_max, 0.1 * motion.h_max);
  const ProbedLimit start = probed("stiffening:0.2", {.h0 = 1e-3, .h1 = 1});
  EXPECT_EQ(start.state, ProbedState::initial);
  EXPECT_NE(status_of(start).find("--motion T follows the motion"), std::string::npos);
}

TEST(ProbePlugin, HiddenStateIsNamed) {
  const ProbedLimit warm = probed("warm_start", {.h0 = 1e-3, .h1 = 1});
  EXPECT_NE(status_of(warm).find("a step depends on hidden state"), std::string::npos) << status_of(warm);
  const ProbedLimit counting = probed("counting", {.h0 = 1e-3, .h1 = 1, .observe = false});
  EXPECT_NE(status_of(counting).find("steps are not reproducible"), std::string::npos) << status_of(counting);
}

TEST(ProbePlugin, TheExampleHasItsKnownLimit) {
  // m = 0.01, k = 1000, c = 0.05; h = (gamma + sqrt(gamma^2 + 4 omega^2)) / omega^2 of the fastest mode.
  const double part = 4 * std::pow(std::sin(20 * std::numbers::pi / 42), 2), omega2 = 1e5 * part, gamma = 5 * part;
  const ProbedLimit found = probed("chain", {.h0 = 1e-4, .h1 = 0.1}, EXAMPLE_STEPPER);
  EXPECT_NEAR(found.h_max, (gamma + std::sqrt(gamma * gamma + 4 * omega2)) / omega2, 5e-4 * found.h_max);
  EXPECT_LT(std::abs(found.gap), 5e-3);
  EXPECT_TRUE(found.status.empty()) << status_of(found);
}

TEST(ProbePlugin, BadStartsAndStepsAreRefused) {
  const auto error = [](const std::string& entry, ProbeSettings settings) {
    try {
      probed(entry, settings);
    } catch (const InputError& refused) {
      return std::string(refused.what());
    }
    return std::string();
  };
  EXPECT_EQ(error("start:nan", {.h0 = 1e-3, .h1 = 1}), "number 1 of the state at the start is not finite");
  EXPECT_EQ(error("chain", {.h0 = 1, .h1 = 0.1}),
            "step sizes are from --h0 1 to --h1 0.1; give two positive numbers, the smaller one first");
  EXPECT_EQ(error("chain", {.h0 = 1e-3, .h1 = 0.1, .motion = 0.01}),
            "--motion 0.01 is shorter than a step of --h1; give its length in seconds");
  EXPECT_EQ(error("crash", {.h0 = 0.1, .h1 = 1}), "a step of h0 from the start is not finite; take a smaller --h0");
}

}  // namespace
}  // namespace hmax
