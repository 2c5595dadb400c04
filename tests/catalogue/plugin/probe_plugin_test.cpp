/// Limits of steppers behind the plugin interface, beside what is known of them in closed form.
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/foreign_steps/own_step.hpp"
#include "analysis/foreign_steps/step_probe.hpp"
#include "catalogue/plugin/plugin_stepper.hpp"
#include "core/errors.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

ProbedLimit probed(const std::string& entry, ProbeSettings settings,
                   const std::string& file = TESTED_PLUGIN) {
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

TEST(ProbePlugin, SharesOfTheLimitAreItsDerivatives) {
  // k h^2 + 2 c h = 4 of the first spring.
  PluginStepper engine(parse_plugin(std::string(TESTED_PLUGIN) + ":parted:100,2,50,1,25,0"));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-3, .h1 = 1, .observe = false});
  const double h = (std::sqrt(4 + 400) - 2) / 100;
  EXPECT_NEAR(found.h_max, h, 2e-4 * h);
  ASSERT_EQ(found.shares.size(), 3);
  const double k = 100 * h * h, c = 2 * h;
  EXPECT_NEAR(found.shares[0].of_stiffness, k / (k + c), 5e-3);
  EXPECT_NEAR(found.shares[0].of_damping, c / (k + c), 5e-3);
  EXPECT_NEAR(found.shares[0].sum(), 1, 1e-3);
  EXPECT_NEAR(found.shares[1].sum(), 0, 1e-6);
  EXPECT_NEAR(found.shares[2].sum(), 0, 1e-6);
}

TEST(ProbePlugin, SpringsThatAreAlikeShareTheLimit) {
  PluginStepper engine(parse_plugin(std::string(TESTED_PLUGIN) + ":parted:100,0,100,0,100,0,1,0"));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-3, .h1 = 1, .observe = false});
  ASSERT_EQ(found.shares.size(), 4);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found.shares[i].sum(), 1.0 / 3, 2e-3) << i;
  EXPECT_NEAR(found.shares[3].sum(), 0, 1e-6);
  const std::optional<OwnStep> own = examine_own_step(engine, found, {});
  ASSERT_TRUE(own && own->owner);
  EXPECT_EQ(own->owner->alike, 3);
  EXPECT_NEAR(own->owner->share_of_alike, 1, 2e-3);
  // At 0.1 a spring of 4 / 0.01 is at its limit, whether alone or with the others.
  EXPECT_NEAR(own->owner->stiffness.alone, 400, 1);
  EXPECT_NEAR(own->owner->stiffness.together, 400, 1);
  EXPECT_TRUE(std::isnan(own->owner->damping.alone));
  EXPECT_EQ(own->stable, true);
  EXPECT_EQ(own->substeps, 1);
  EXPECT_EQ(own->settles, true);
  EXPECT_NEAR(own->stiffness_shown, 1, 1e-3);
}

TEST(ProbePlugin, AStepThatIsTooLongNeedsSubsteps) {
  PluginStepper engine(parse_plugin(std::string(TESTED_PLUGIN) + ":parted:2500,0,1,0"));
  const ProbedLimit found = probe_steps(engine, {.h0 = 1e-3, .h1 = 1, .observe = false});
  EXPECT_NEAR(found.h_max, 0.04, 1e-5);
  const std::optional<OwnStep> own = examine_own_step(engine, found, {});
  ASSERT_TRUE(own && own->owner);
  EXPECT_EQ(own->stable, false);
  EXPECT_EQ(own->substeps, 3);
  EXPECT_EQ(own->settles, false);
  EXPECT_EQ(own->owner->part.name, "first");
  EXPECT_NEAR(own->owner->stiffness.alone, 400, 1);
  // Of two limits that contradict each other the smaller one counts.
  ProbedLimit torn = found;
  torn.contradiction = true;
  torn.observed = 0.03;
  EXPECT_EQ(examine_own_step(engine, torn, {})->substeps, 4);
  torn.observed = 0.05;
  EXPECT_EQ(examine_own_step(engine, torn, {})->substeps, 3);
  torn.h_max = std::numeric_limits<double>::infinity();
  EXPECT_EQ(examine_own_step(engine, torn, {})->stable, std::nullopt);
  // The engine is as it was.
  EXPECT_NEAR(probe_steps(engine, {.h0 = 1e-3, .h1 = 1, .observe = false}).h_max, 0.04, 1e-5);
  // Where another spring is too stiff as well, no stiffness helps.
  PluginStepper both(parse_plugin(std::string(TESTED_PLUGIN) + ":parted:2500,0,1600,0"));
  EXPECT_EQ(largest_factor(both, {0}, false, 0.1, {}), 0);
  EXPECT_NEAR(largest_factor(both, {0, 1}, false, 0.1, {}), 400.0 / 2500, 1e-3);
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

/// Counts what an engine is asked to do.
class CountedStepper final : public ForeignStepper {
 public:
  CountedStepper(const std::string& entry, bool tells)
      : engine_(parse_plugin(std::string(TESTED_PLUGIN) + ":" + entry)), tells_(tells) {}
  [[nodiscard]] std::string name() const override { return engine_.name(); }
  [[nodiscard]] Eigen::Index dim() const override { return engine_.dim(); }
  [[nodiscard]] bool has_hidden_state() const override { return engine_.has_hidden_state(); }
  [[nodiscard]] Eigen::SparseMatrix<double> pattern() const override {
    return tells_ ? engine_.pattern() : Eigen::SparseMatrix<double>();
  }
  Eigen::VectorXd state() override { return engine_.state(); }
  void set_state(const Eigen::VectorXd& y) override { engine_.set_state(y); }
  bool step(double h, std::int64_t count) override { return steps += count, engine_.step(h, count); }
  void save(int slot) override { engine_.save(slot); }
  void restore(int slot) override { engine_.restore(slot); }
  Eigen::VectorXd after(int slot, const Eigen::VectorXd& y, double h, std::int64_t count) override {
    return steps += count, engine_.after(slot, y, h, count);
  }
  std::int64_t steps = 0;

 private:
  PluginStepper engine_;
  bool tells_;
};

TEST(ProbePlugin, APatternSavesNineStepsOfTen) {
  const auto probed_with = [](const std::string& entry, bool tells) {
    CountedStepper engine(entry, tells);
    // As large states are treated, above 1000 numbers.
    const ProbedLimit found = probe_steps(engine, {.h0 = 1e-3,
                                                   .h1 = 0.05,
                                                   .rows = 6,
                                                   .observe = false,
                                                   .spectrum = {.eigenvalues_to = 210, .matrix_to = 210}});
    return std::pair(found, engine.steps);
  };
  // Of large states a pattern stands in for products with the derivative; of others, the first matrix tells
  // it.
  const auto [declared, few] = probed_with("coupled:150", true);
  const auto [products, many] = probed_with("coupled:150", false);
  EXPECT_NEAR(declared.h_max, limit_of_chain(150), 1e-3 * declared.h_max);
  EXPECT_NEAR(products.h_max, declared.h_max, 5e-3 * declared.h_max);
  EXPECT_LT(10 * few, many);
  const auto [again, fewer] = probed_with("coupled:100", true);
  const auto [learned, some] = probed_with("coupled:100", false);
  EXPECT_EQ(again.h_max, learned.h_max);
  EXPECT_LT(fewer, some);
  EXPECT_LT(some, 200 * 2 + fewer + 10);
}

TEST(ProbePlugin, AWrongPatternIsNamedAndNotUsed) {
  for (const std::string size : {"100", "150"}) {
    const ProbedLimit found =
        probed("coupled:" + size + ":missing", {.h0 = 1e-3,
                                                .h1 = 0.05,
                                                .rows = 6,
                                                .observe = false,
                                                .spectrum = {.eigenvalues_to = 210, .matrix_to = 210}});
    EXPECT_NEAR(found.h_max, limit_of_chain(std::stod(size)), 5e-3 * found.h_max);
    EXPECT_TRUE(says(status_of(found), "the declared pattern of the step is wrong and not used: number "));
  }
  const ProbedLimit found =
      probed("coupled:100:missing", {.h0 = 1e-3, .h1 = 0.05, .rows = 6, .observe = false});
  // The last two masses act on each other.
  EXPECT_TRUE(
      status_of(found).find("number 199 after a step depends on number 98 before it") != std::string::npos ||
      status_of(found).find("number 198 after a step depends on number 99 before it") != std::string::npos)
      << status_of(found);
}

TEST(ProbePlugin, AStepOfFourStagesReachesFourCouplings) {
  for (const std::string reach : {"1", "4"}) {
    const ProbedLimit found = probed("reaching:60:" + reach, {.h0 = 1e-3, .h1 = 0.05, .observe = false});
    EXPECT_NEAR(found.h_max, std::sqrt(2.0) * limit_of_chain(60), 1e-3 * found.h_max) << reach;
    EXPECT_EQ(status_of(found).find("or a longer reach") == std::string::npos, reach == "4")
        << status_of(found);
  }
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
  EXPECT_TRUE(says(status_of(found), "the model itself is unstable"));
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
  EXPECT_TRUE(says(status_of(start), "give the length of a motion to follow it"));
}

TEST(ProbePlugin, HiddenStateIsNamed) {
  const ProbedLimit warm = probed("warm_start", {.h0 = 1e-3, .h1 = 1});
  EXPECT_TRUE(says(status_of(warm), "a step depends on hidden state"));
  const ProbedLimit counting = probed("counting", {.h0 = 1e-3, .h1 = 1, .observe = false});
  EXPECT_TRUE(says(status_of(counting), "steps are not reproducible"));
}

TEST(ProbePlugin, TheExampleHasItsKnownLimit) {
  // m = 0.01, k = 1000, c = 0.05; h = (gamma + sqrt(gamma^2 + 4 omega^2)) / omega^2 of the fastest mode.
  const double part = 4 * std::pow(std::sin(20 * std::numbers::pi / 42), 2), omega2 = 1e5 * part,
               gamma = 5 * part;
  const ProbedLimit found = probed("chain", {.h0 = 1e-4, .h1 = 0.1}, EXAMPLE_STEPPER);
  EXPECT_NEAR(found.h_max, (gamma + std::sqrt(gamma * gamma + 4 * omega2)) / omega2, 5e-4 * found.h_max);
  EXPECT_LT(std::abs(found.gap), 5e-3);
  EXPECT_TRUE(found.status.empty()) << status_of(found);
}

TEST(ProbePlugin, AStateOfRestThatDependsOnTheStepIsFollowed) {
  const ProbedLimit found = probed("shifting", {.h0 = 1e-4, .h1 = 1});
  EXPECT_EQ(found.state, ProbedState::equilibrium);
  // At rest x = 0.01 + 0.2 h, and h sqrt(100 + 3e4 x^2) = 2.
  double h = 0.1;
  for (int i = 0; i < 100; ++i) h = 2 / std::sqrt(100 + 3e4 * std::pow(0.01 + 0.2 * h, 2));
  EXPECT_NEAR(found.h_max, h, 5e-4 * h);
  // Runs start at the rest of one step size near the limit, and swing about that of others.
  EXPECT_LT(std::abs(found.gap), 2e-2);
  EXPECT_TRUE(says(status_of(found), "each step size is probed at its own"));
}

TEST(ProbePlugin, ChangesThatDoNotAddUpAreAKink) {
  const ProbedLimit found = probed("bounded", {.h0 = 1e-3, .h1 = 1, .observe = false});
  EXPECT_EQ(found.smoothness, StepSmoothness::kink);
}

TEST(ProbePlugin, FloatsFarFromZeroKeepTheirSprings) {
  // At 1000 the last place is 6e-5: balanced scales without a floor moved the positions by less, and nothing
  // grew.
  const ProbedLimit found = probed("far_float", {.h0 = 1e-4, .h1 = 1});
  EXPECT_NEAR(found.h_max, 0.2, 5e-3 * 0.2);
  EXPECT_NEAR(found.observed, 0.2, 2e-2 * 0.2);
}

/// 10 (2 / k + h^2) with k = 100.
double rest_of_softened(double h) { return 10 * (0.02 + h * h); }

TEST(ProbePlugin, StatesOfRestAndSlowMotionsAreThoseOfEachStepSize) {
  const double h0 = 1e-3;
  const ProbedLimit found = probed("softened:k=100", {.h0 = h0, .h1 = 0.3});
  EXPECT_TRUE(std::isinf(found.h_max));
  ASSERT_EQ(found.rows.size(), 12U);
  const auto rate_at = [](double h) {
    const double a = 100 * h * h / (1 + 100 * h * h), b = 1 - a / 2;
    return std::log(std::complex<double>(b, std::sqrt(b * (1 - b)))) / h;
  };
  for (const StepSpectrum& row : found.rows) {
    EXPECT_EQ(row.settles, true) << row.h;
    ASSERT_EQ(row.settled.size(), 2) << row.h;
    EXPECT_NEAR(row.settled[0], rest_of_softened(row.h), 1e-6) << row.h;
    EXPECT_NEAR(row.settled_moves, rest_of_softened(row.h) / rest_of_softened(h0) - 1, 1e-5) << row.h;
    ASSERT_EQ(row.modes.size(), 1U) << row.h;
    const ShownMode& mode = row.modes.front();
    EXPECT_NEAR(mode.omega, std::abs(rate_at(h0)), 1e-4) << row.h;
    EXPECT_NEAR(mode.omega_shown, std::abs(rate_at(row.h)), 1e-4) << row.h;
    EXPECT_NEAR(mode.zeta_shown, -rate_at(row.h).real() / std::abs(rate_at(row.h)), 1e-4) << row.h;
  }
  EXPECT_TRUE(says(status_of(found), "no growth up to h1 = 0.3 s; there the slowest mode is"))
      << status_of(found);
}

TEST(ProbePlugin, DecaysAreSlowMotionsWhereNothingOscillates) {
  const ProbedLimit found = probed("decays", {.h0 = 1e-3, .h1 = 0.5});
  const StepSpectrum& last = found.rows.back();
  EXPECT_EQ(last.settles, true);
  EXPECT_EQ(last.settled_moves, 0);
  ASSERT_EQ(last.modes.size(), 2U);
  for (const auto& [k, rate] : {std::pair(0U, 1.0), {1U, 5.0}}) {
    EXPECT_NEAR(last.modes[k].omega, std::log1p(1e-3 * rate) / 1e-3, 1e-4);
    EXPECT_NEAR(last.modes[k].omega_shown, std::log1p(0.5 * rate) / 0.5, 1e-4);
    EXPECT_EQ(last.modes[k].zeta_shown, 1);
  }
}

TEST(ProbePlugin, NothingSettlesWhereAMotionGrows) {
  const ProbedLimit found = probed("chain", {.h0 = 1e-3, .h1 = 0.05, .observe = false});
  for (const StepSpectrum& row : found.rows) {
    EXPECT_EQ(row.settles, row.h < found.h_max) << row.h;
    if (!*row.settles) continue;
    // Symplectic Euler: cos(omega_shown h) = 1 - (omega h)^2 / 2 with the slowest 200 sin(pi / 22).
    const double turn = 200 * std::sin(std::numbers::pi / 22) * row.h;
    EXPECT_NEAR(row.modes.front().omega_shown, std::acos(1 - turn * turn / 2) / row.h, 2e-3) << row.h;
    EXPECT_NEAR(row.modes.front().zeta_shown, 0, 1e-5) << row.h;
  }
}

TEST(ProbePlugin, BadStartsAndStepsAreRefused) {
  const auto error = [](const std::string& entry, ProbeSettings settings) {
    return error_of<InputError>([&] { probed(entry, settings); });
  };
  EXPECT_EQ(error("start:nan", {.h0 = 1e-3, .h1 = 1}), "number 1 of the state at the start is not finite");
  EXPECT_EQ(error("chain", {.h0 = 1, .h1 = 0.1}),
            "step sizes are from h0 1 to h1 0.1; give two positive numbers, the smaller one first");
  EXPECT_EQ(error("chain", {.h0 = 1e-3, .h1 = 0.1, .motion = 0.01}),
            "motion 0.01 is shorter than a step of h1; give its length in seconds");
  EXPECT_EQ(error("crash", {.h0 = 0.1, .h1 = 1}),
            "a step of h0 from the start cannot be done or is not finite; take a smaller h0");
}

}  // namespace
}  // namespace hmax
