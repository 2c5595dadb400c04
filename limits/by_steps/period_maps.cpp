#include "limits/by_steps/period_maps.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <utility>

#include "analysis/dynamics/oscillator_lanes.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"
#include "integrators/breakpoints.hpp"
#include "integrators/control.hpp"
#include "limits/by_steps/one_step_map.hpp"

namespace hmax {

namespace {

/// Steps of a period that are kept with their cosines; more are taken one motion at a time.
constexpr std::int64_t most_shared_steps = 100'000;

/// Oscillators or formulas, and the periods of their forces.
struct Driven {
  std::vector<Oscillator> systems;
  std::vector<std::vector<FormulaPiece>> formulas;  ///< what a period of each is made of
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

/// The pieces of a period as run_by_pieces() has them, one where steps are fixed. Empty where a problem is
/// none of formulas of the plane.
std::vector<FormulaPiece> pieces_of(const Problem& problem, double period, bool fixed) {
  const auto* system = std::get_if<AnySystem>(&problem.system);
  const auto program = system && system->dim() == 2 ? system->formulas() : nullptr;
  if (!program) return {};
  // A copy: the derivatives beside it are not needed.
  const PlanarFormulas formulas{std::make_shared<const FormulaProgram>(*program), system->is_autonomous()};
  const Span<double> span{0, period};
  const auto breaks = fixed ? std::vector<double>{} : detail::breakpoints_in(*system, span);
  std::vector<FormulaPiece> pieces;
  for (const auto& piece : detail::pieces_of(formulas, span, breaks))
    pieces.push_back({piece.system, piece.span, period});
  return pieces;
}

/// Of all problems; empty where one has none.
std::vector<std::vector<FormulaPiece>> formulas(const std::function<Problem(std::size_t i)>& problem_at,
                                                const std::vector<double>& periods, bool fixed) {
  if (periods.empty()) return {};
  const auto first = pieces_of(problem_at(0), periods[0], fixed);
  if (first.empty()) return {};
  auto all = parallel_map(periods.size(), [&](std::size_t i) {
    return i == 0 ? first : pieces_of(problem_at(i), periods[i], fixed);
  });
  if (std::ranges::any_of(all, [](const auto& pieces) { return pieces.empty(); })) return {};
  return all;
}

FormulaPrograms programs_of(const Driven& driven) {
  FormulaPrograms programs;
  for (const auto& pieces : driven.formulas) programs.push_back(pieces.front().system.program);
  return programs;
}

/// A period of a motion whose image is asked for, or a piece of it.
struct PeriodRun : OscillatorRun {
  MapCall call;
  std::size_t number = 0;  ///< of the piece
};

/// Replaces states by their images until there are none left.
void run_periods(const Driven& driven, const MapCalls& calls, const RunMotions& run) {
  std::deque<PeriodRun> runs;
  std::vector<PeriodRun*> idle, halfway;
  const auto begin_piece = [&](PeriodRun& each) -> OscillatorRun* {
    each.piece = &driven.formulas[each.call.map][each.number];
    each.t_end = each.piece->span.t_end;
    return &each;
  };
  const auto next = [&]() -> OscillatorRun* {
    if (!halfway.empty()) {
      PeriodRun& each = *halfway.back();
      halfway.pop_back();
      return begin_piece(each);
    }
    const auto call = calls.next();
    if (!call) return nullptr;
    if (idle.empty()) idle.push_back(&runs.emplace_back());
    PeriodRun& begun = *idle.back();
    idle.pop_back();
    begun = {{driven.systems.empty() ? nullptr : &driven.systems[call->map], driven.periods[call->map],
              *call->state},
             *call};
    if (!driven.sizes.empty()) begun.h = driven.sizes[call->map];
    return driven.formulas.empty() ? &begun : begin_piece(begun);
  };
  const auto ended = [&](OscillatorRun& each) {
    auto& run_of_call = static_cast<PeriodRun&>(each);
    const MapCall call = run_of_call.call;
    const bool reached = each.outcome == Outcome::reached_end;
    if (reached && each.piece && ++run_of_call.number < driven.formulas[call.map].size()) {
      halfway.push_back(&run_of_call);
      return;
    }
    *call.state = each.y;
    if (!reached) call.state->setConstant(std::numeric_limits<double>::quiet_NaN());
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
                           std::int64_t most_steps, const Tolerances<double>& tolerances) {
  return steps ? steps_map(steps->method, problem, size_of_steps(*steps, period), period)
               : stroboscope(problem, period, most_steps, tolerances);
}

MapEnsemble period_maps(const std::function<Problem(std::size_t i)>& problem_at,
                        const std::vector<double>& periods, const std::optional<FixedSteps>& steps,
                        const MotionRunner& runner, const Tolerances<double>& tolerances) {
  if (steps && !periods.empty()) stroboscope(problem_at(0), periods.front(), steps);  // may throw
  const auto driven = std::make_shared<Driven>(Driven{oscillators(problem_at, periods.size()), {}, periods});
  if (driven->systems.empty()) driven->formulas = formulas(problem_at, periods, steps.has_value());
  const bool has_formulas = !driven->formulas.empty();
  const AdaptiveSteps adaptive{tolerances, most_period_steps, false};
  if (steps)
    for (const double period : periods) driven->sizes.push_back(size_of_steps(*steps, period));
  RunMotions run;
  if (has_formulas) {
    run = steps ? runner.formula_steps(steps->method.id, programs_of(*driven))
                : runner.formulas(adaptive, programs_of(*driven));
  } else if (!driven->systems.empty() && !steps) {
    run = runner.adaptive(adaptive);
  } else if (!driven->systems.empty()) {
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
        "--device gpu runs periods of oscillators and of files of formulas that begin at t0 = 0 or do not know t, "
        "adaptive ones or those of an explicit Runge-Kutta method; leave --device out");
  return one_by_one([=](std::size_t i) {
    return stroboscope(problem_at(i), periods[i], steps, most_period_steps, tolerances);
  });
}

}  // namespace hmax
