#include "limits/by_steps/period_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <tuple>
#include <utility>

#include "catalogue/models/planar.hpp"
#include "core/cosines.hpp"
#include "integrators/control.hpp"
#include "integrators/ensemble/lane_rk.hpp"
#include "integrators/ensemble/lane_runs.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/integrate.hpp"
#include "limits/by_steps/one_step_map.hpp"
#include "problems/oscillator/oscillator_lanes.hpp"

namespace hmax {

namespace {

using Eigen::Vector2d;

/// Steps of a period that are kept with their cosines; more are taken one motion at a time.
constexpr std::int64_t most_shared_steps = 100'000;

/// Two registers of the widest kind for each number: a diagram has some hundred motions, and those that are
/// followed for longest are few.
constexpr std::size_t lane_count = 16;
using Systems = OscillatorLanes<lane_count>;

/// The image of a call, or that there is none.
void answer(MapCalls& calls, const MapCall& call, const Vector2d& y, bool reached) {
  *call.y = reached ? y : Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  calls.done(call);
}

// ---- adaptive steps, each lane at its own time

using Lanes = LaneRk<tableaux::Dop853, Vector2d, lane_count>;
using Coefficients = StaticCoefficients<tableaux::Dop853>;

/// The place of each stage among the different times c_i, i > 0, of a step; their number at last.
constexpr auto node_of_stage = [] {
  std::array<std::size_t, Coefficients::stages() + 1> place{};
  std::size_t& count = place[Coefficients::stages()];
  for (std::size_t i = 1; i < Coefficients::stages(); ++i)
    place[i] = Coefficients::first_at_node_of(i) == i ? count++ : place[Coefficients::first_at_node_of(i)];
  return place;
}();
constexpr std::size_t nodes = node_of_stage.back();
using Forces =
    std::array<double, nodes * lane_count>;  ///< [node][lane]; w t, its cosine, and at last the force

[[gnu::always_inline]] inline void attempt(Lanes& lanes, const Systems& systems, InstructionSet set) {
  alignas(64) Forces angles, forces;
  const std::size_t used = lanes.used();
  Coefficients::for_each_later_stage([&](auto i) __attribute__((always_inline)) {
    if constexpr (Coefficients::first_at_node_of(i) == i)
      for (std::size_t lane = 0; lane < used; ++lane)
        angles[node_of_stage[i] * used + lane] = systems.angle(lane, lanes.stage_time(i, lane));
  });
  cosines(std::span(angles).first(nodes * used), forces, set);
  for (std::size_t node = 0; node < nodes; ++node)
    for (std::size_t lane = 0; lane < used; ++lane)
      forces[node * used + lane] = systems.force(lane, forces[node * used + lane]);
  lanes.attempt([&](auto i, std::size_t lane, const Vector2d& y, Vector2d& dydt) __attribute__((
      always_inline)) { systems.rhs_at(lane, forces[node_of_stage[i] * used + lane], y, dydt); });
  lanes.weigh(RmsNorm<double>{stroboscope_tolerances.rtol, stroboscope_tolerances.atol});
}

// ---- fixed steps, all lanes at one time

/// A step of all lanes: its size and cos(w t) at each stage.
template <class Method>
struct SharedStep {
  double h;
  std::array<double, Method::tableau.stages> cosine;
};

/// The steps of one period as ExplicitRk takes them: it is run with a system that writes down what it is
/// asked.
template <class Method>
class StepsOfPeriod {
 public:
  using State = Vector2d;
  explicit StepsOfPeriod(double w) : w_(w) {}

  static constexpr Eigen::Index dim() { return 2; }
  [[nodiscard]] double at(double t) const { return std::cos(w_ * t); }
  void rhs_at(double cosine, const State& /*y*/, State& dydt) const {
    seen_->push_back(cosine);
    dydt.setZero();
  }
  void rhs(double t, const State& y, State& dydt) const { rhs_at(at(t), y, dydt); }

  std::vector<SharedStep<Method>> steps(double period, double h) const {
    constexpr std::size_t stages = Method::tableau.stages;
    constexpr std::size_t first = StaticCoefficients<Method>::fsal ? 1 : 0;
    std::vector<SharedStep<Method>> steps;
    Vector2d y = Vector2d::Zero();
    integrate(Rk<Method, Vector2d>{}, *this, Span<double>{0, period}, y, FixedStep<double>(h),
              [&](const auto& view) {
                SharedStep<Method>& step = steps.emplace_back(SharedStep<Method>{view.h(), {}});
                std::copy(seen_->end() - std::ptrdiff_t(stages - first), seen_->end(),
                          step.cosine.begin() + first);
              });
    return steps;
  }

 private:
  double w_;
  std::shared_ptr<std::vector<double>> seen_ = std::make_shared<std::vector<double>>();
};

template <class Method>
struct SharedRun {
  LaneRk<Method, Vector2d, lane_count> lanes;
  Systems systems;
  alignas(64) std::array<double, lane_count> bounded;  ///< 1 while every state has been, else 0
};

/// One period of every lane.
template <class Method>
[[gnu::always_inline]] inline void advance(SharedRun<Method>& run,
                                           std::span<const SharedStep<Method>> steps) {
  const std::size_t used = run.lanes.used();
  for (const SharedStep<Method>& step : steps) {
    for (std::size_t lane = 0; lane < used; ++lane) run.lanes.set_step(lane, 0, step.h);
    run.lanes.attempt([&](auto i, std::size_t lane, const Vector2d& y, Vector2d& dydt) __attribute__((
        always_inline)) { run.systems.rhs_at(lane, run.systems.force(lane, step.cosine[i]), y, dydt); });
    for (std::size_t lane = 0; lane < used; ++lane) {
      run.bounded[lane] = is_bounded(run.lanes.candidate(lane)) ? run.bounded[lane] : 0;
      run.lanes.accept(lane);
    }
  }
}

// ---- both for each instruction set
// The attribute compiles these bodies alone, with all they call, for their instruction set: inline functions
// that other code shares keep the instructions that every processor has.

[[gnu::flatten]] void attempt_portable(Lanes& lanes, const Systems& systems) {
  attempt(lanes, systems, InstructionSet::portable);
}
template <class Method>
[[gnu::flatten]] void advance_portable(SharedRun<Method>& run, std::span<const SharedStep<Method>> steps) {
  advance(run, steps);
}
#ifdef __x86_64__
[[gnu::flatten, gnu::target("avx2")]] void attempt_avx2(Lanes& lanes, const Systems& systems) {
  attempt(lanes, systems, InstructionSet::avx2);
}
template <class Method>
[[gnu::flatten, gnu::target("avx2")]] void advance_avx2(SharedRun<Method>& run,
                                                        std::span<const SharedStep<Method>> steps) {
  advance(run, steps);
}
[[gnu::flatten, gnu::target("avx512f,avx512vl")]] void attempt_avx512(Lanes& lanes, const Systems& systems) {
  attempt(lanes, systems, InstructionSet::avx512);
}
template <class Method>
[[gnu::flatten, gnu::target("avx512f,avx512vl")]] void advance_avx512(
    SharedRun<Method>& run, std::span<const SharedStep<Method>> steps) {
  advance(run, steps);
}
#endif

using Attempt = void (*)(Lanes&, const Systems&);
template <class Method>
using Advance = void (*)(SharedRun<Method>&, std::span<const SharedStep<Method>>);

Attempt attempt_of([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::avx512) return attempt_avx512;
  if (set == InstructionSet::avx2) return attempt_avx2;
#endif
  return attempt_portable;
}

template <class Method>
Advance<Method> advance_of([[maybe_unused]] InstructionSet set) {
#ifdef __x86_64__
  if (set == InstructionSet::avx512) return advance_avx512<Method>;
  if (set == InstructionSet::avx2) return advance_avx2<Method>;
#endif
  return advance_portable<Method>;
}

/// The oscillators of an ensemble, and the periods of their forces.
struct Driven {
  std::vector<Oscillator> systems;
  std::vector<double> periods;

  [[nodiscard]] bool share_time() const {
    return std::ranges::all_of(systems,
                               [&](const Oscillator& each) {
                                 return each.parameters().w == systems.front().parameters().w;
                               }) &&
           std::ranges::all_of(periods, [&](double each) { return each == periods.front(); });
  }
};

/// Adaptive periods, as LaneRuns asks for them: what period_map() does.
class AdaptivePeriods {
 public:
  using Control = Adaptive<double, DeadbandController>;

  AdaptivePeriods(std::shared_ptr<const Driven> driven, InstructionSet set)
      : driven_(std::move(driven)), attempt_(attempt_of(set)) {}

  void operator()(MapCalls& calls) {
    calls_ = &calls;
    LaneRuns<Lanes, Control> runs(most_period_steps);
    runs(*this, lanes_, driven_->systems.front());
  }

  std::optional<Control> begin(std::size_t lane) {
    while (const auto call = calls_->next()) {
      const Vector2d y = *call->y;
      if (!is_bounded(y)) {
        answer(*calls_, *call, y, false);
        continue;
      }
      const Oscillator& system = driven_->systems[call->map];
      Vector2d slope;
      system.rhs(0, y, slope);
      lanes_.start(lane, y, slope);
      systems_.set(lane, system);
      Control control(stroboscope_tolerances, tableaux::Dop853::error_order);
      control.start(lanes_, system, {0, driven_->periods[call->map]}, y);
      call_[lane] = *call;
      return control;
    }
    return std::nullopt;
  }
  void attempt() { attempt_(lanes_, systems_); }
  static bool is_over(std::size_t /*lane*/, const Vector2d& /*y*/) { return false; }
  void move(std::size_t from, std::size_t to) {
    call_[to] = call_[from];
    systems_.set(to, driven_->systems[call_[to].map]);
  }
  void end(std::size_t lane, Outcome outcome, const Vector2d& y) {
    answer(*calls_, call_[lane], y, outcome == Outcome::reached_end);
  }

 private:
  std::shared_ptr<const Driven> driven_;
  Attempt attempt_;
  Lanes lanes_;
  Systems systems_;
  std::array<MapCall, lane_count> call_{};  ///< that each lane answers
  MapCalls* calls_ = nullptr;
};

/// Periods of fixed steps: as many as there are lanes begin and end together.
template <class Method>
class SharedPeriods {
 public:
  SharedPeriods(std::shared_ptr<const Driven> driven, double h, InstructionSet set)
      : driven_(std::move(driven)),
        advance_(advance_of<Method>(set)),
        steps_(StepsOfPeriod<Method>(driven_->systems.front().parameters().w)
                   .steps(driven_->periods.front(), h)) {}

  void operator()(MapCalls& calls) {
    std::array<MapCall, lane_count> taken;
    while (const std::size_t count = take(calls, taken)) {
      run_.lanes.use(count);
      run_.bounded.fill(1);
      advance_(run_, steps_);
      for (std::size_t lane = 0; lane < count; ++lane)
        answer(calls, taken[lane], run_.lanes.state(lane), run_.bounded[lane] != 0);
    }
  }

 private:
  /// The next calls, in the first lanes. Beside them copies run, which nobody looks at: what has been there
  /// before could have become subnormal, and slow.
  std::size_t take(MapCalls& calls, std::array<MapCall, lane_count>& taken) {
    std::size_t count = 0;
    while (count < lane_count) {
      const auto call = calls.next();
      if (!call) break;
      const Vector2d y = *call->y;
      if (!is_bounded(y)) {
        answer(calls, *call, y, false);
        continue;
      }
      start(count, driven_->systems[call->map], y);
      taken[count++] = *call;
    }
    for (std::size_t lane = count; count > 0 && lane < lane_count; ++lane)
      start(lane, driven_->systems[taken[0].map], *taken[0].y);
    return count;
  }

  void start(std::size_t lane, const Oscillator& system, const Vector2d& y) {
    Vector2d slope;
    system.rhs(0, y, slope);
    run_.lanes.start(lane, y, slope);
    run_.systems.set(lane, system);
  }

  std::shared_ptr<const Driven> driven_;
  Advance<Method> advance_;
  std::vector<SharedStep<Method>> steps_;
  SharedRun<Method> run_;
};

/// Fixed steps of the method of this id; nothing where it is no explicit Runge-Kutta method.
MapEnsemble shared_periods(std::string_view id, const std::shared_ptr<const Driven>& driven, double h,
                           InstructionSet set) {
  MapEnsemble ensemble;
  const auto try_method = [&]<class Method>(const Method&) {
    if (Method::id == id)
      ensemble = [periods = std::make_shared<SharedPeriods<Method>>(driven, h, set)](MapCalls& calls) {
        (*periods)(calls);
      };
  };
  std::apply([&](const auto&... method) { (try_method(method), ...); }, tableaux::All{});
  return ensemble;
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

std::vector<MapEnsemble> period_maps(const std::function<Problem(std::size_t i)>& problem_at,
                                     const std::vector<double>& periods,
                                     const std::optional<FixedSteps>& steps, std::size_t threads,
                                     InstructionSet set) {
  if (steps && !periods.empty()) stroboscope(problem_at(0), periods.front(), steps);  // may throw
  const auto driven = std::make_shared<Driven>();
  driven->periods = periods;
  for (std::size_t i = 0; i < periods.size(); ++i) {
    const Problem problem = problem_at(i);
    const auto* oscillator = std::get_if<Oscillator>(&problem.system);
    if (!oscillator) break;
    driven->systems.push_back(*oscillator);
  }
  const bool in_lanes = !periods.empty() && driven->systems.size() == periods.size();
  std::vector<MapEnsemble> ensembles;
  while (ensembles.size() < threads) {
    MapEnsemble ensemble;
    if (in_lanes && !steps)
      ensemble = [periods = std::make_shared<AdaptivePeriods>(driven, set)](MapCalls& calls) {
        (*periods)(calls);
      };
    else if (in_lanes && driven->share_time() &&
             fixed_step_count(periods.front(), steps->h) <= most_shared_steps)
      ensemble = shared_periods(steps->method.id, driven, size_of_steps(*steps, periods.front()), set);
    if (!ensemble)
      ensemble = one_by_one([=](std::size_t i) { return stroboscope(problem_at(i), periods[i], steps); });
    ensembles.push_back(std::move(ensemble));
  }
  return ensembles;
}

}  // namespace hmax
