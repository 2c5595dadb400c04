/// From types to erased calls: one method on one system becomes a Runner.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "catalogue/methods/kept_sink.hpp"
#include "catalogue/methods/method.hpp"
#include "catalogue/methods/run.hpp"
#include "integrators/control.hpp"
#include "integrators/integrate.hpp"
#include "integrators/kept_run.hpp"
#include "integrators/observers.hpp"

namespace hmax {

namespace detail {

/// Explicit steps of a few numbers take some nanoseconds: a loop of their own for every control and every way
/// of being watched pays off. Everything else is compiled once.
template <class StepperT>
inline constexpr bool steps_are_cheap = StepperT::is_explicit&& is_small_state<typename StepperT::State>;

template <class Real>
Tolerances<Real> tolerances_of(const RunSpec& spec) {
  return {static_cast<Real>(spec.rtol), static_cast<Real>(spec.atol), static_cast<Real>(spec.h_first),
          static_cast<Real>(spec.h_max)};
}

/// Steps steered by the error as `spec` asks, of all controllers in one type.
/// @param error_order  order of the error estimate
template <class Real>
Adaptive<Real, AnyController, AnyNorm> any_adaptive(const RunSpec& spec, int error_order) {
  const auto tolerances = tolerances_of<Real>(spec);
  const AnyController<Real> controller = [&] {
    switch (spec.control) {
      case Controllers::i:
        return AnyController<Real>(IntegralController<Real>(error_order));
      case Controllers::pi:
        return AnyController<Real>(PiController<Real>(error_order));
      case Controllers::matlab:
        return AnyController<Real>(MatlabController<Real>(error_order));
      case Controllers::deadband:
        break;
    }
    return AnyController<Real>(DeadbandController<Real>(error_order));
  }();
  const AnyNorm<Real> norm{tolerances.rtol, tolerances.atol, spec.control == Controllers::matlab};
  return {tolerances, error_order, controller, norm};
}

/// Calls go(control) with the control that `spec` asks for; the typed world begins here. The steps of an
/// explicit method on a small state are so cheap that each controller is compiled into a loop of its own.
/// @param error_order  order of the error estimate; 0 for a method without one, which then only runs at fixed
/// step
/// @tparam each_controller  compiles a loop for each controller, else one for all; the steps are the same
template <class StepperT, bool each_controller = steps_are_cheap<StepperT>,
          class Real = typename StepperT::Real, class Go>
auto with_control(const RunSpec& spec, int error_order, Go&& go) {
  const auto tolerances = tolerances_of<Real>(spec);
  if constexpr (requires { typename StepperT::Control; }) {
    return go(typename StepperT::Control(tolerances));
  } else {
    const FixedStep<Real> fixed(static_cast<Real>(spec.h));
    if constexpr (!StepperT::may_estimate_error) {
      return go(fixed);
    } else {
      if (!spec.adaptive || error_order == 0) return go(fixed);
      if constexpr (each_controller) {
        switch (spec.control) {
          case Controllers::i:
            return go(Adaptive<Real, IntegralController>(tolerances, error_order));
          case Controllers::pi:
            return go(Adaptive<Real, PiController>(tolerances, error_order));
          case Controllers::matlab:
            return go(Adaptive<Real, MatlabController, MatlabNorm>(tolerances, error_order));
          case Controllers::deadband:
            break;
        }
        return go(Adaptive<Real, DeadbandController>(tolerances, error_order));
      } else {
        return go(any_adaptive<Real>(spec, error_order));
      }
    }
  }
}

/// A stepper under hmax's own loop. An engine is callable as
///   engine(system, span, y, spec, observer) -> RunEnd,  y initial state in, last accepted state out;
/// foreign libraries bring theirs, with views of their own for the observer.
template <class StepperT>
struct StepperEngine {
  StepperT stepper;
  int error_order;
  /// Whether a step is so cheap that watching and counting it would show in its time.
  static constexpr bool is_cheap = steps_are_cheap<StepperT>;
  static constexpr bool saves_state = SavesState<StepperT>;

  template <System Sys, class Observer>
  auto operator()(const Sys& system, Span<real_of<typename Sys::State>> span, typename Sys::State& y,
                  const RunSpec& spec, Observer&& observer) const {
    return with_control<StepperT>(spec, error_order, [&](auto control) {
      return integrate(fresh(spec), system, span, y, control, observer, spec.max_steps);
    });
  }

  /// The same for a run that is saved and resumed. @param counts  those of `system`
  template <System Sys, class Observer>
  auto kept(const Sys& system, Span<real_of<typename Sys::State>> span, typename Sys::State& y,
            const RunSpec& spec, Observer& observer, Stats& counts, RunKeeper& keeper) const {
    return with_control<StepperT, false>(spec, error_order, [&](auto control) {
      return integrate_kept(fresh(kept_spec(spec)), system, span, y, control, observer, spec.max_steps,
                            counts, keeper);
    });
  }

 private:
  /// A stepper with the options of the run.
  [[nodiscard]] StepperT fresh(const RunSpec& spec) const {
    StepperT made = stepper;
    if constexpr (requires { made.set_jacobian_update(spec.jacobian); })
      made.set_jacobian_update(spec.jacobian);
    if constexpr (requires { made.set_newton(spec.newton); }) made.set_newton(spec.newton);
    if constexpr (requires { made.set_linear_solve(spec.linear_solve); })
      made.set_linear_solve(spec.linear_solve);
    return made;
  }
};

}  // namespace detail

/// The observer of runs that are compiled once: shows what it is told to, points or samples, or nothing.
template <class State>
class AnyObserver {
 public:
  using Real = real_of<State>;
  using Show = std::function<void(Real t, const State& y)>;

  /// @param every  interval of samples [s]; 0: every accepted step
  /// @param show   may be empty
  /// @param work   as RunSpec::work
  AnyObserver(Span<Real> span, Real every, const State& y0, Show show, ImplicitWork* work = nullptr)
      : samples_(every > 0), show_(std::move(show)), work_(work) {
    if (!show_) return;
    if (samples_)
      sample_.emplace(span, every, y0, std::cref(show_));
    else
      show_(span.t0, y0);
  }
  AnyObserver(const AnyObserver&) = delete;
  AnyObserver& operator=(const AnyObserver&) = delete;

  template <class View>
  void operator()(View& view) {
    if constexpr (requires { view.work(); })
      if (work_) *work_ = view.work();
    if (sample_)
      (*sample_)(view);
    else if (show_)
      show_(view.t1(), view.y1());
  }

  /// See saved_state.hpp.
  void visit_state(auto& visit) {
    if (sample_) visit(*sample_);
  }

 private:
  bool samples_;
  Show show_;
  ImplicitWork* work_;
  std::optional<SampleEvery<State, std::reference_wrapper<const Show>>> sample_;
};

namespace detail {
/// One run by an engine. Where the sink keeps it, the engine has to know the state of its method.
template <class Engine, System Sys, class Observer>
RunEnd<real_of<typename Sys::State>> run_once(const Engine& engine, const Sys& system,
                                              Span<real_of<typename Sys::State>> span, typename Sys::State& y,
                                              const RunSpec& spec, Observer& observer, Stats& counts,
                                              const Sink& sink) {
  const auto* kept = sink.target<KeptSink>();
  if (!kept) return engine(system, span, y, spec, observer);
  if constexpr (requires { requires Engine::saves_state; })
    return engine.kept(system, span, y, spec, observer, counts, kept->keeper());
  else
    throw StateNotSaved{};
}
}  // namespace detail

/// A Runner from an engine, a system and an initial state at t = 0; `end_state_extended` is left empty.
template <class Engine, System Sys>
Runner make_runner(const Engine& engine, const Sys& system, const typename Sys::State& y0) {
  using State = typename Sys::State;
  using Real = real_of<State>;
  Runner runner;

  runner.run = [=](const RunSpec& spec, const Sink& sink) {
    const Span<Real> span{0, static_cast<Real>(spec.t_end)};
    State y = y0;
    Stats counts;
    typename AnyObserver<State>::Show show;
    if (shows_points(sink))
      show = [&sink](Real t, const State& state) { sink(static_cast<double>(t), state); };
    AnyObserver<State> observer(span, static_cast<Real>(spec.every), y0, std::move(show), spec.work);
    const RunEnd<Real> end =
        detail::run_once(engine, Counted<Sys>(system, counts), span, y, spec, observer, counts, sink);
    RunRecord record{end.outcome, end.t, y, static_cast<double>(end.t_state), end.stats, end.note};
    record.stats.rhs += counts.rhs;
    record.stats.jacobian += counts.jacobian;
    return record;
  };

  runner.repeat = [=, memory = std::make_shared<std::vector<State>>(),
                   last = std::make_shared<Eigen::VectorXd>(y0)](
                      const RunSpec& spec, std::int64_t runs) -> const Eigen::VectorXd& {
    const Span<Real> span{0, static_cast<Real>(spec.t_end)};
    if (spec.every > 0) {
      const auto points = static_cast<std::size_t>(fixed_step_count(spec.t_end, spec.every)) + 1;
      if (memory->size() < points) memory->assign(points, y0);
    }
    State y = y0;
    Stats unread;
    for (std::int64_t run = 0; run < runs; ++run) {
      y = y0;
      State* out = memory->data();
      const auto store = [&out](Real, const State& state) { copy_state(state, *out++); };
      if constexpr (Engine::is_cheap) {
        if (spec.every > 0)
          engine(system, span, y, spec, SampleEvery<State, decltype(store)>(span, spec.every, y0, store));
        else
          engine(system, span, y, spec, ObserveNothing{});
      } else {
        typename AnyObserver<State>::Show show;
        if (spec.every > 0) show = store;
        AnyObserver<State> observer(span, static_cast<Real>(spec.every), y0, std::move(show));
        engine(Counted<Sys>(system, unread), span, y, spec, observer);
      }
      // The state is an input and an output the compiler knows nothing of: no run may be merged with
      // another.
      asm volatile("" : : "g"(y.data()) : "memory");
    }
    *last = y;
    return *last;
  };
  return runner;
}

/// The end state of a fixed-step run in long double.
template <class ExtendedStepper>
auto extended_run(const ExtendedStepper& stepper, const ExtendedSystem& system, const Eigen::VectorXd& y0) {
  return [=](double h, double t_end) {
    using Real = long double;
    ExtendedSystem::State y = y0.cast<Real>();
    integrate(stepper, system, Span<Real>{0, static_cast<Real>(t_end)}, y,
              FixedStep<Real>(static_cast<Real>(h)));
    return Eigen::Vector<Real, Eigen::Dynamic>(y);
  };
}

/// Binds an engine to a problem, whatever the type of its system.
/// @param make  make(std::type_identity<Sys>) -> the engine for systems of type Sys
template <class Make>
Runner bind_engine(const Problem& problem, const Make& make) {
  return std::visit(
      [&]<class Sys>(const Sys& system) {
        return make_runner(make(std::type_identity<Sys>{}), system, typename Sys::State(problem.y0));
      },
      problem.system);
}

/// The same of a stepper.
/// @param make  make(std::type_identity<Sys>) -> the stepper for systems of type Sys; called for the type of
/// the
///              problem and for ExtendedSystem
template <class Make>
Runner bind_problem(const Problem& problem, int error_order, const Make& make) {
  Runner runner = bind_engine(problem, [&](auto sys) {
    return detail::StepperEngine<decltype(make(sys))>{make(sys), error_order};
  });
  if (problem.extended)
    runner.end_state_extended =
        extended_run(make(std::type_identity<ExtendedSystem>{}), *problem.extended, problem.y0);
  return runner;
}

/// Method::bind of such a stepper.
template <class Make>
std::function<Runner(const Problem&)> bound(int error_order, const Make& make) {
  return [=](const Problem& problem) { return bind_problem(problem, error_order, make); };
}

}  // namespace hmax
