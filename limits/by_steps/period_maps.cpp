#include "limits/by_steps/period_maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <list>
#include <memory>
#include <utility>

#include "analysis/dynamics/oscillator_lanes.hpp"
#include "catalogue/models/planar.hpp"
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

PeriodRun run_of(const Driven& driven, const MapCall& call) {
  return {{&driven.systems[call.map], driven.periods[call.map], *call.state}, call};
}

void answer(const MapCalls& calls, const MapCall& call, const OscillatorRun& run) {
  *call.state = run.y;
  if (run.outcome != Outcome::reached_end) call.state->setConstant(std::numeric_limits<double>::quiet_NaN());
  calls.done(call);
}

/// Adaptive periods, each lane at its own time.
void run_adaptive(const Driven& driven, const MapCalls& calls, InstructionSet set) {
  std::list<PeriodRun> runs;
  const LaneClient client{.next = [&]() -> OscillatorRun* {
                            const auto call = calls.next();
                            return call ? &runs.emplace_back(run_of(driven, *call)) : nullptr;
                          },
                          .ended =
                              [&](OscillatorRun& run) {
                                const MapCall call = static_cast<PeriodRun&>(run).call;
                                answer(calls, call, run);
                                runs.remove_if([&](const PeriodRun& each) { return &each == &run; });
                              }};
  run_side_by_side(client, stroboscope_tolerances, most_period_steps, false, set);
}

/// Periods of the same steps, some at a time.
void run_shared(const Driven& driven, const MapCalls& calls, const SharedSteps& run) {
  constexpr std::size_t at_a_time = 32;
  std::vector<OscillatorRun> runs;
  std::vector<MapCall> taken;
  do {
    runs.clear();
    taken.clear();
    while (taken.size() < at_a_time) {
      const auto call = calls.next();
      if (!call) break;
      taken.push_back(*call);
      runs.push_back(run_of(driven, *call));
    }
    run(runs);
    for (std::size_t i = 0; i < runs.size(); ++i) answer(calls, taken[i], runs[i]);
  } while (!runs.empty());
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
                        InstructionSet set) {
  if (steps && !periods.empty()) stroboscope(problem_at(0), periods.front(), steps);  // may throw
  const auto driven =
      std::make_shared<const Driven>(Driven{oscillators(problem_at, periods.size()), periods});
  if (!driven->systems.empty() && !steps)
    return [driven, set](const MapCalls& calls) { run_adaptive(*driven, calls, set); };
  SharedSteps run;
  if (!driven->systems.empty() && driven->share_time() &&
      fixed_step_count(periods.front(), steps->h) <= most_shared_steps)
    run = shared_steps(steps->method.id, driven->systems.front().parameters().w, periods.front(),
                       size_of_steps(*steps, periods.front()), set);
  if (run) return [driven, run](const MapCalls& calls) { run_shared(*driven, calls, run); };
  return one_by_one([=](std::size_t i) { return stroboscope(problem_at(i), periods[i], steps); });
}

}  // namespace hmax
