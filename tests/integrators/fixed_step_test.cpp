/// Fixed steps: their number, their times to the last bit, and how runs end.
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "integrators/integrate.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {
namespace {

using One = Eigen::Matrix<double, 1, 1>;
using Euler = Rk<tableaux::ExplicitEuler, One>;

/// y' = 1: y(t_end) - y(t0) is the sum of the steps taken.
const auto clock_system = system_of<One>([](double, const One&, One& dydt) { dydt[0] = 1; });

struct Trace {
  RunEnd<double> end;
  std::vector<double> times, steps;
  double elapsed;
};

Trace trace(Span<double> span, double h, std::int64_t max_steps = 1'000'000) {
  Trace trace;
  One y(0.0);
  trace.end = integrate(
      Euler{}, clock_system, span, y, FixedStep<double>(h),
      [&](auto& view) {
        trace.times.push_back(view.t1());
        trace.steps.push_back(view.h());
      },
      max_steps);
  trace.elapsed = y[0];
  return trace;
}

TEST(FixedStepCount, CoversTheLengthWithoutSlivers) {
  EXPECT_EQ(fixed_step_count(100.0, 0.15), 667);
  EXPECT_EQ(fixed_step_count(100.0, 0.6), 167);
  EXPECT_EQ(fixed_step_count(100.0, 0.1), 1000);
  EXPECT_EQ(fixed_step_count(100.0, 0.01), 10000);
  EXPECT_EQ(fixed_step_count(100.0, 0.00005), 2000000);
  EXPECT_EQ(fixed_step_count(1.0, 1.0 / 3), 3);
  EXPECT_EQ(fixed_step_count(0.3, 0.1), 3);
  EXPECT_EQ(fixed_step_count(1.0F, 0.1F), 10);
  EXPECT_EQ(fixed_step_count(1000.0F, 0.1F), 10000);
  EXPECT_EQ(fixed_step_count(1.0, 7.0), 1);
  EXPECT_EQ(fixed_step_count(1.0, 1e300), 1) << "a step larger than the span is cut, not skipped";
  EXPECT_EQ(fixed_step_count(1.0, 1e-300), std::numeric_limits<std::int64_t>::max());
}

TEST(FixedStep, TimesAreMultiplesOfTheStepToTheLastBit) {
  for (const double h : {2.0, 0.6, 0.2, 0.15, 0.1, 0.05, 1.0 / 3, 0.005}) {
    const double t0 = 0.25, t_end = 100.25;
    const Trace run = trace({t0, t_end}, h);
    EXPECT_EQ(run.end.outcome, Outcome::reached_end);
    EXPECT_EQ(run.end.t, t_end);
    EXPECT_EQ(run.end.stats.steps, static_cast<std::int64_t>(std::ceil(100 / h - 1e-9)));
    ASSERT_EQ(run.times.size(), static_cast<std::size_t>(run.end.stats.steps));
    for (std::size_t n = 0; n + 1 < run.times.size(); ++n) {
      ASSERT_EQ(run.times[n], t0 + static_cast<double>(n + 1) * h);
      ASSERT_EQ(run.steps[n], h);
    }
    EXPECT_EQ(run.times.back(), t_end);
    EXPECT_GT(run.steps.back(), 1e-3 * h) << "a sliver";
    EXPECT_LE(run.steps.back(), h * (1 + 1e-12));
    EXPECT_NEAR(run.elapsed, 100, 1e-10);
  }
}

TEST(FixedStep, CutsTheLastStepShort) {
  const Trace run = trace({0, 1}, 0.3);
  ASSERT_EQ(run.steps.size(), 4U);
  EXPECT_NEAR(run.steps.back(), 0.1, 1e-15);
  EXPECT_NEAR(run.elapsed, 1, 1e-15);
}

TEST(FixedStep, LargerThanTheSpanIsOneStepOfTheSpan) {
  for (const double h : {1.0 + 1e-7, 1.5, 1e10, 1e300}) {
    const Trace run = trace({2, 3}, h);
    EXPECT_EQ(run.end.outcome, Outcome::reached_end) << h;
    EXPECT_EQ(run.end.stats.steps, 1) << h;
    EXPECT_EQ(run.steps.back(), 1) << h;
    EXPECT_EQ(run.elapsed, 1) << h;
  }
}

TEST(FixedStep, NeverPassesOrMissesTheEndByMoreThanRounding) {
  // Spans that h divides up to one part in 1e5 ... 1e12.
  for (double off = 1e-5; off > 1e-12; off /= 10)
    for (const double sign : {-1.0, 1.0}) {
      const double t_end = 1 + sign * off;
      EXPECT_NEAR(trace({0, t_end}, 0.25).elapsed, t_end, 1e-15) << t_end;
    }
}

TEST(FixedStep, FarFromZeroLeavesNoSliverEither) {
  // t_end is a multiple of h only as far as doubles near 1e9 can tell.
  const Trace run = trace({1e9, 1e9 + 0.3}, 0.1);
  EXPECT_EQ(run.end.stats.steps, 3);
  EXPECT_NEAR(run.steps.back(), 0.1, 1e-6);
}

TEST(FixedStep, TakesNoStepOverAnEmptySpan) {
  const Trace run = trace({5, 5}, 0.1);
  EXPECT_EQ(run.end.outcome, Outcome::reached_end);
  EXPECT_EQ(run.end.t, 5);
  EXPECT_EQ(run.end.stats.steps, 0);
  EXPECT_EQ(run.elapsed, 0);
}

TEST(FixedStep, TooSmallForTheBudgetSaysSo) {
  const Trace run = trace({1, 2}, 1e-3, 100);
  EXPECT_EQ(run.end.outcome, Outcome::too_many_steps);
  EXPECT_EQ(run.end.stats.steps, 100);
  EXPECT_EQ(run.end.t, 1 + 100 * 1e-3);
  EXPECT_EQ(trace({0, 1}, 1e-300, 100).end.outcome, Outcome::too_many_steps);
}

TEST(FixedStep, TooSmallToChangeTheTimeSaysSo) {
  for (const double h : {1e-20, 1e-300, std::numeric_limits<double>::denorm_min()}) {
    const Trace run = trace({1, 2}, h, 100);
    EXPECT_EQ(run.end.outcome, Outcome::step_too_small) << h;
    EXPECT_EQ(run.end.t, 1) << h;
  }
}

TEST(FixedStep, ThatIsNoStepEndsAtOnce) {
  // Upper floors refuse these in words; the loop must not hang.
  for (const double h : {0.0, -0.1, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(trace({1, 2}, h, 100).end.outcome, Outcome::step_too_small) << h;
}

TEST(FixedStep, UsesTheWholeBudget) {
  EXPECT_EQ(trace({0, 1}, 0.25, 4).end.outcome, Outcome::reached_end);
  EXPECT_EQ(trace({0, 1}, 0.25, 3).end.outcome, Outcome::too_many_steps);
}

TEST(FixedStep, ReportsWhenARunDivergesAndKeepsTheLastBoundedState) {
  // y_n = (1 - 10)^n: |y_n|^2 <= max up to n = 161 = floor(log(max) / (2 log 9)).
  const auto system = system_of<One>([](double, const One& y, One& dydt) { dydt[0] = -10 * y[0]; });
  One y(1.0);
  const auto end = integrate(Euler{}, system, Span<double>{0, 1000}, y, FixedStep<double>(1));
  EXPECT_EQ(end.outcome, Outcome::diverged);
  EXPECT_EQ(end.t, 162);
  EXPECT_EQ(end.stats.steps, 161);
  EXPECT_NEAR(y[0] / -std::pow(9.0, 161), 1, 1e-12);
}

TEST(FixedStep, StopsAtTheFirstStateThatIsNotANumber) {
  const auto system = system_of<One>([](double t, const One&, One& dydt) {
    dydt[0] = t < 2.5 ? 1 : std::numeric_limits<double>::quiet_NaN();
  });
  One y(0.0);
  const auto end = integrate(Euler{}, system, Span<double>{0, 10}, y, FixedStep<double>(1));
  EXPECT_EQ(end.outcome, Outcome::diverged);
  EXPECT_EQ(end.t, 4);
  EXPECT_EQ(y[0], 3);
}

TEST(FixedStep, RefusesAStartThatIsNotBounded) {
  for (const double start : {std::numeric_limits<double>::quiet_NaN(), 1e200}) {
    One y(start);
    const auto end = integrate(Euler{}, clock_system, Span<double>{3, 4}, y, FixedStep<double>(0.1));
    EXPECT_EQ(end.outcome, Outcome::diverged);
    EXPECT_EQ(end.t, 3);
    EXPECT_EQ(end.stats.steps, 0);
  }
}

}  // namespace
}  // namespace hmax
