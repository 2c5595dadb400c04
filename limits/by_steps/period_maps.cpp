#include "limits/by_steps/period_maps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "analysis/dynamics/oscillator_lanes.hpp"
#include "catalogue/models/planar.hpp"
#include "integrators/control.hpp"
#include "limits/by_steps/one_step_map.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

/// Steps of a period that are kept with their cosines; more are taken one motion at a time.
constexpr std::int64_t most_shared_steps = 100'000;

/// Motions that are followed at a time: each lane has several, so that few lanes wait for the last run.
constexpr std::size_t motions_at_a_time = 64;

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

/// Their period maps by runs side by side.
MapEnsemble in_lanes(std::shared_ptr<const Driven> driven, SharedSteps run) {
  return {.apply =
              [driven = std::move(driven), run = std::move(run), runs = std::vector<OscillatorRun>()](
                  std::span<const std::size_t> maps, std::span<VectorXd> states) mutable {
                runs.clear();
                for (std::size_t i = 0; i < maps.size(); ++i)
                  runs.push_back({&driven->systems[maps[i]], driven->periods[maps[i]], states[i]});
                run(runs);
                const Vector2d lost = Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
                for (std::size_t i = 0; i < maps.size(); ++i)
                  states[i] = runs[i].outcome == Outcome::reached_end ? runs[i].y : lost;
              },
          .motions = motions_at_a_time};
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
  SharedSteps run;
  if (!driven->systems.empty() && !steps)
    run = [set](std::span<OscillatorRun> runs) {
      run_side_by_side(runs, stroboscope_tolerances, most_period_steps, {}, set);
    };
  else if (!driven->systems.empty() && driven->share_time() &&
           fixed_step_count(periods.front(), steps->h) <= most_shared_steps)
    run = shared_steps(steps->method.id, driven->systems.front().parameters().w, periods.front(),
                       size_of_steps(*steps, periods.front()), set);
  if (run) return in_lanes(driven, run);
  return one_by_one([=](std::size_t i) { return stroboscope(problem_at(i), periods[i], steps); });
}

}  // namespace hmax
