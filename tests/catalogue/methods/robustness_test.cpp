/// Every adaptive method of the catalogue, also those of Boost.Odeint and SUNDIALS, on problems that break
/// assumptions: whatever happens, a run ends soon, with a clear outcome and a state that is finite. And from
/// a start at rest, and over right-hand sides that jump.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "tests/integrators/forced.hpp"

namespace hmax {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t attempts = 200'000;

/// y' = f(t, y) of one component with df/dy, all of it declared stiff, so that methods of every family take
/// it.
template <class Real>
struct Scalar {
  using State = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  using Jacobian = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  Real (*f)(Real t, Real y);
  Real (*df)(Real t, Real y);

  [[nodiscard]] static Eigen::Index dim() { return 1; }
  void rhs(Real t, const State& y, State& dydt) const { dydt[0] = f(t, y[0]); }
  void jacobian(Real t, const State& y, Jacobian& J) const { J.setConstant(1, 1, df(t, y[0])); }
  void rhs_stiff(Real t, const State& y, State& dydt) const { rhs(t, y, dydt); }
  void rhs_nonstiff(Real, const State&, State& dydt) const { dydt[0] = 0; }
  void jacobian_stiff(Real t, const State& y, Jacobian& J) const { jacobian(t, y, J); }
};

/// @param f, df  generic lambdas without capture
template <class F, class Df>
Problem scalar(double y0, F f, Df df) {
  return {.id = "scalar",
          .states = {"y"},
          .y0 = Eigen::VectorXd::Constant(1, y0),
          .system = AnySystem(Scalar<double>{f, df}),
          .extended = ExtendedSystem(Scalar<long double>{f, df})};
}

RunSpec adaptive(double t_end, double tolerance) {
  return {.t_end = t_end, .adaptive = true, .rtol = tolerance, .atol = tolerance, .max_steps = attempts};
}

/// Methods of low order need more steps than a test should take at tight tolerances.
double tolerance_for(const Method& method) { return method.error_order <= 2 ? 1e-3 : 1e-6; }

/// The root of y + s y^3 = right, by bisection.
double cubic_root(double s, double right) {
  double low = -10, high = 10;
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    (middle + s * middle * middle * middle < right ? low : high) = middle;
  }
  return low;
}

// Far from the solution f is large, and so is its rounding: that is no sign that a stage is solved.
TEST(StepsFarBeyondTheModel, EndAtTheRootOfTheirEquationsOrSayThatTheyDoNot) {
  const Problem cubic = scalar(
      4, [](auto, auto y) { return -y * y * y; }, [](auto, auto y) { return -3 * y * y; });
  const std::map<std::string, double> roots{{"implicit_euler", cubic_root(100, 4)},
                                            {"imex_euler", cubic_root(100, 4)},
                                            {"trapezoidal", cubic_root(50, 4 - 50 * 64)},
                                            {"implicit_midpoint", 2 * cubic_root(50, 4) - 4}};
  int solved = 0;
  for (const Method& method : methods()) {
    if (!method.fixed_step || !method.needs_jacobian || method.needs_second_order) continue;
    if (method.family == "rosenbrock") continue;  // whose equations are linear
    const RunRecord record = method.bind(cubic).run({.t_end = 100, .h = 100}, {});
    if (record.outcome != Outcome::reached_end) continue;
    EXPECT_LE(std::abs(record.y[0]), 4.001) << method.id;
    const auto root = roots.find(method.id);
    if (root == roots.end()) continue;
    ++solved;
    EXPECT_NEAR(record.y[0], root->second, 1e-9) << method.id;
  }
  EXPECT_GE(solved, 3);
}

class EveryAdaptiveMethod : public testing::TestWithParam<std::string> {
 protected:
  Method method = find_method(GetParam());
  bool own = method.engine == own_engine;

  RunRecord run(const Problem& problem, const RunSpec& spec, const Sink& sink = {}) const {
    return method.bind(problem).run(spec, sink);
  }
};

std::vector<std::string> adaptive_methods() {
  std::vector<std::string> ids;
  for (const Method& method : methods())
    if (method.adaptive()) ids.push_back(method.id);
  return ids;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryAdaptiveMethod, testing::ValuesIn(adaptive_methods()),
                         [](const auto& tested) { return tested.param; });

TEST_P(EveryAdaptiveMethod, EndsBeforeARegionWhereFIsNotANumber) {
  const Problem after_half = scalar(
      1, [](auto t, auto y) { return std::sqrt(decltype(t)(0.5) - t) - y; },
      [](auto, auto y) { return y * 0 - 1; });
  const RunRecord record = run(after_half, adaptive(1, tolerance_for(method)));
  EXPECT_NE(record.outcome, Outcome::reached_end);
  EXPECT_NE(record.outcome, Outcome::too_many_steps);
  if (own) {
    EXPECT_NE(record.outcome, Outcome::diverged);
    EXPECT_GT(record.t, 0.5 - 1e-6);
  }
  EXPECT_GT(record.t, 0.4);
  EXPECT_LE(record.t, 0.5 + 1e-9);
  EXPECT_TRUE(record.y.allFinite());
}

TEST_P(EveryAdaptiveMethod, EndsBeforeAStateWhereFIsNotANumber) {
  const Problem wall = scalar(
      0, [](auto, auto y) { return y < 2 ? decltype(y)(1) : static_cast<decltype(y)>(nan); },
      [](auto, auto y) { return y * 0; });
  const RunRecord record = run(wall, adaptive(3, tolerance_for(method)));
  EXPECT_TRUE(!own || record.outcome == Outcome::newton_failed || record.outcome == Outcome::step_too_small);
  EXPECT_NE(record.outcome, Outcome::reached_end);
  EXPECT_NEAR(record.t, 2, own ? 1e-6 : 0.2);
  EXPECT_TRUE(record.y.allFinite());
}

TEST_P(EveryAdaptiveMethod, PassesADiscontinuity) {
  // The estimate of fehlberg_78 compares f at both ends of the step only and sees little of what is between;
  // sdirk_4 has no stage in the first quarter of a step, where this jump happens to fall.
  const Problem jump = scalar(
      0, [](auto t, auto y) { return (t < decltype(t)(0.5) ? 0 : 1) - y; },
      [](auto, auto y) { return y * 0 - 1; });
  const double tolerance = tolerance_for(method);
  const RunRecord record = run(jump, adaptive(1, tolerance));
  EXPECT_EQ(record.outcome, Outcome::reached_end);
  // Foreign engines keep their own rules for errors, and some see as little: they are to end, near the
  // solution.
  const bool sees_little = method.id == "fehlberg_78" || method.id == "sdirk_4" || method.engine != "hmax";
  // The longest step is a tenth of the span: what a quarter of it hides of the jump by 1.
  const double bound = sees_little ? 0.1 / 4 : 100 * tolerance;
  EXPECT_NEAR(record.y[0], 1 - std::exp(-0.5), bound);
}

TEST_P(EveryAdaptiveMethod, ReachesAnEndAHairAfterTheStart) {
  const Problem oscillator = make_problem("liver_forced");
  for (const double t_end : {1e-14, 1e-300}) {
    const RunRecord record = run(oscillator, adaptive(t_end, 1e-6));
    // SUNDIALS squares lengths of time, and says that 1e-300 s are too short for it.
    if (method.engine.starts_with("SUNDIALS") && t_end < 1e-150)
      EXPECT_TRUE(record.outcome == Outcome::reached_end || !record.note.empty()) << t_end;
    else
      EXPECT_EQ(record.outcome, Outcome::reached_end) << t_end;
    EXPECT_LT((record.y - oscillator.y0).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST_P(EveryAdaptiveMethod, EndsAtTolerancesOfOneAndOfRounding) {
  const Problem oscillator = make_problem("liver_forced");
  const RunRecord loose = run(oscillator, adaptive(100, 1));
  EXPECT_TRUE(loose.y.allFinite());
  const RunRecord tight = run(oscillator, adaptive(1, 1e-15));
  EXPECT_TRUE(tight.y.allFinite());
  if (tight.outcome == Outcome::reached_end) {
    const RunRecord looser = run(oscillator, adaptive(1, 1e-9));
    EXPECT_LT((tight.y - looser.y).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST_P(EveryAdaptiveMethod, StopsAtAPole) {
  const Problem pole = scalar(
      1, [](auto, auto y) { return y * y; }, [](auto, auto y) { return 2 * y; });
  const RunRecord record = run(pole, adaptive(2, tolerance_for(method)));
  EXPECT_NE(record.outcome, Outcome::reached_end);
  EXPECT_NEAR(record.t, 1, 0.05);
}

TEST_P(EveryAdaptiveMethod, SaysSoWhenTheJacobianIsNotANumber) {
  if (!method.needs_jacobian) GTEST_SKIP() << "uses no Jacobian";
  const Problem broken = scalar(
      1, [](auto, auto y) { return -y; }, [](auto, auto y) { return y * static_cast<decltype(y)>(nan); });
  const RunRecord record = run(broken, adaptive(1, tolerance_for(method)));
  EXPECT_EQ(record.outcome, Outcome::newton_failed);
  EXPECT_TRUE(record.y.allFinite());
}

TEST_P(EveryAdaptiveMethod, IsNotSilentlyWrongWithAWrongJacobian) {
  if (!method.needs_jacobian) GTEST_SKIP() << "uses no Jacobian";
  const Problem wrong = scalar(
      1, [](auto, auto y) { return -y; }, [](auto, auto y) { return y * 0 + 3; });
  const double tolerance = tolerance_for(method);
  const RunRecord record = run(wrong, adaptive(1, tolerance));
  if (record.outcome == Outcome::reached_end)
    EXPECT_NEAR(record.y[0], std::exp(-1), 100 * tolerance);
  else
    EXPECT_NE(record.outcome, Outcome::diverged);
}

template <class System>
Problem at_rest(const System& system) {
  return {.id = "forced", .states = {"y"}, .y0 = Eigen::VectorXd::Zero(1), .system = AnySystem(system)};
}
RunSpec with(Controllers control, double t_end) {
  return {.t_end = t_end,
          .adaptive = true,
          .rtol = 1e-5,
          .atol = 1e-7,
          .control = control,
          .max_steps = 5'000'000};
}

TEST_P(EveryAdaptiveMethod, SeesForcesThatBeginAtZeroInEveryUnitOfTime) {
  // Stages of SUNDIALS are solved loosely.
  const double share = own ? 3e-3 : 1e-2, size = own ? 1e-4 : 2e-4;
  for (const double unit : {1e-9, 1e-3, 1.0, 1e3, 1e9})
    for (const forced::Forcing& forcing : forced::forcings())
      for (const Controllers control : {Controllers::deadband, Controllers::matlab}) {
        if (!own && control == Controllers::matlab) continue;
        const RunRecord record = run(at_rest(forced::Forced{forcing.g, unit}), with(control, 10 * unit));
        EXPECT_EQ(record.outcome, Outcome::reached_end) << forcing.name << " " << unit;
        // Motions are of the size one; the least that is left of one is 0.006.
        EXPECT_NEAR(record.y[0], forcing.end, share * std::abs(forcing.end) + size)
            << forcing.name << " " << unit;
      }
}

TEST_P(EveryAdaptiveMethod, GoesOverJumpsThatTheModelNames) {
  for (const double height : {1.0, 1e6})
    for (const bool at_once : {true, false})
      for (const Controllers control : {Controllers::deadband, Controllers::matlab}) {
        if (!own && control == Controllers::matlab) continue;
        const forced::Switched system{.height = height, .at_once = at_once};
        std::vector<double> ends;
        const RunRecord record =
            run(at_rest(system), with(control, 10), [&](double t, const auto&) { ends.push_back(t); });
        EXPECT_EQ(record.outcome, Outcome::reached_end) << height << at_once << record.note;
        EXPECT_NEAR(record.y[0] / height, system.end() / height, 5e-4) << height << at_once;
        for (const double jump : {3.0, 7.0})
          EXPECT_TRUE(std::ranges::any_of(ends, [&](double t) { return std::abs(t - jump) < 1e-13 * jump; }))
              << jump;
        // Up to the jump nothing acts: no step is rejected for the sake of it.
        EXPECT_LT(std::ranges::count_if(ends, [](double t) { return t <= 3; }), 25);
      }
}

TEST_P(EveryAdaptiveMethod, KeepsToTheFirstAndTheLongestStepOfTheUser) {
  std::vector<double> times;
  const RunSpec spec{
      .t_end = 10, .adaptive = true, .rtol = 1e-3, .atol = 1e-3, .h_first = 0.01, .h_max = 0.25};
  run(at_rest(forced::Forced{forced::forcings()[1].g}), spec,
      [&](double t, const auto&) { times.push_back(t); });
  ASSERT_GT(times.size(), 10U);
  EXPECT_LE(times[1], 0.01 * (1 + 1e-12));
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_LE(times[i] - times[i - 1], 0.25 * 1.0101) << i;
}

}  // namespace
}  // namespace hmax
