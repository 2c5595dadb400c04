#include "limits/by_steps/period_maps.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <utility>

#include "analysis/dynamics/oscillator_lanes.hpp"
#include "catalogue/models/planar.hpp"
#include "core/errors.hpp"
#include "integrators/control.hpp"
#include "limits/by_steps/one_step_map.hpp"

namespace hmax {

namespace {

/// Steps of a period that are kept with their cosines; more are taken one motion at a time.
constexpr std::int64_t most_shared_steps = 100'000;

/// Oscillators, and the periods of their forces.
struct Driven {
  std::vector<Oscillator> systems;
  std::vector<double> periods;
  std::vector<double> sizes = {};  ///< of fixed steps

  [[nodiscard]] bool share_time() const {
    const double w = systems.front().parameters().w;
    return std::ranges::all_of(systems, [&](const Oscillator& each) { return each.parameters().w == w; }) &&
           std::ranges::all_of(periods, [&](double each) { return each == periods.front(); });
  }
};

/// Empty where a problem is no oscillator.
std::vector<Oscillator> oscillators(const std::function<Problem(std::size_t i)>& problem_at,
                                    std::size_t count) {
  std::vector<Oscillator> systems;
  for (std::size_t i = 0; i < count; ++i) {
    const Problem problem = problem_at(i);
    const auto* oscillator = std::get_if<Oscillator>(&problem.system);
    if (!oscillator) return {};
    systems.push_back(*oscillator);
  }
  return systems;
}

/// A period of a motion whose image is asked for.
struct PeriodRun : OscillatorRun {
  MapCall call;
};

/// Replaces states by their images until there are none left.
void run_periods(const Driven& driven, const MapCalls& calls, const RunMotions& run) {
  std::deque<PeriodRun> runs;
  std::vector<PeriodRun*> idle;
  const auto next = [&]() -> OscillatorRun* {
    const auto call = calls.next();
    if (!call) return nullptr;
    if (idle.empty()) idle.push_back(&runs.emplace_back());
    PeriodRun& begun = *idle.back();
    idle.pop_back();
    begun = {{&driven.systems[call->map], driven.periods[call->map], *call->state}, *call};
    if (!driven.sizes.empty()) begun.h = driven.sizes[call->map];
    return &begun;
  };
  const auto ended = [&](OscillatorRun& each) {
    auto& run_of_call = static_cast<PeriodRun&>(each);
    const MapCall call = run_of_call.call;
    *call.state = each.y;
    if (each.outcome != Outcome::reached_end)
      call.state->setConstant(std::numeric_limits<double>::quiet_NaN());
    idle.push_back(&run_of_call);
    calls.done(call);
  };
  run({next, ended});
}

/// The size of steps that divides the period; one that is no size stays, and steps_map() refuses it.
double size_of_steps(const FixedSteps& steps, double period) {
  if (!(steps.h > 0) || !std::isfinite(steps.h)) return steps.h;
  return period / static_cast<double>(fixed_step_count(period, steps.h));
}

}  // namespace

VectorFunction stroboscope(const Problem& problem, double period, const std::optional<FixedSteps>& steps,
                           std::int64_t most_steps) {
  return steps ? steps_map(steps->method, problem, size_of_steps(*steps, period), period)
               : stroboscope(problem, period, most_steps);
}

MapEnsemble period_maps(const std::function<Problem(std::size_t i)>& problem_at,
                        const std::vector<double>& periods, const std::optional<FixedSteps>& steps,
                        const MotionRunner& runner) {
  if (steps && !periods.empty()) stroboscope(problem_at(0), periods.front(), steps);  // may throw
  const auto driven = std::make_shared<Driven>(Driven{oscillators(problem_at, periods.size()), periods});
  RunMotions run;
  if (!driven->systems.empty() && !steps) {
    run = runner.adaptive({stroboscope_tolerances, most_period_steps, false});
  } else if (!driven->systems.empty()) {
    for (const double period : periods) driven->sizes.push_back(size_of_steps(*steps, period));
    if (driven->share_time() && fixed_step_count(periods.front(), steps->h) <= most_shared_steps)
      run = runner.shared({.method = steps->method.id,
                           .w = driven->systems.front().parameters().w,
                           .t_end = periods.front(),
                           .h = driven->sizes.front()});
    else if (runner.own_steps)
      run = runner.own_steps(steps->method.id);
  }
  if (run) return [driven, run](const MapCalls& calls) { run_periods(*driven, calls, run); };
  if (runner.is_device)
    throw InputError(
        "--device gpu runs periods of oscillators, adaptive ones or those of an explicit Runge-Kutta method; "
        "leave --device out");
  return one_by_one([=](std::size_t i) { return stroboscope(problem_at(i), periods[i], steps); });
}

}  // namespace hmax
