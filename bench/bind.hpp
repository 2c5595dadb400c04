/// From types to erased calls: one method on one system becomes a Runner.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "bench/run.hpp"
#include "integrators/control.hpp"
#include "integrators/explicit_rk.hpp"
#include "integrators/integrate.hpp"
#include "integrators/observers.hpp"

namespace hmax {

namespace detail {

/// Calls go(control) with the control that `spec` asks for; the typed world begins here.
/// @param error_order  order of the error estimate; 0 for a method without one, which then only runs at fixed
/// step
template <class StepperT, class Real = typename StepperT::Real, class Go>
auto with_control(const RunSpec& spec, int error_order, Go&& go) {
  const FixedStep<Real> fixed(static_cast<Real>(spec.h));
  if constexpr (!StepperT::may_estimate_error)
    return go(fixed);
  else {
    if (!spec.adaptive || error_order == 0) return go(fixed);
    const Tolerances<Real> tolerances{static_cast<Real>(spec.rtol), static_cast<Real>(spec.atol)};
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
  }
}

}  // namespace detail

/// Binds a stepper to a system and an initial state at t = 0.
/// @param error_order      see with_control
/// @param extended_stepper, extended_system  the same in the highest precision there is: long double, or
/// double again
template <class StepperT, System Sys, class ExtendedStepper, System ExtendedSys>
Runner bind(const StepperT& stepper, const Sys& system, const typename Sys::State& y0, int error_order,
            const ExtendedStepper& extended_stepper, const ExtendedSys& extended_system) {
  using State = typename Sys::State;
  using Real = real_of<State>;
  Runner runner;

  runner.run = [=](const RunSpec& spec, const Sink& sink) {
    const Span<Real> span{0, static_cast<Real>(spec.t_end)};
    RunRecord record;
    State y = y0;
    const Counted<Sys> counted(system, record.stats.rhs);
    auto point = [&sink](Real t, const State& state) {
      if (sink) sink(static_cast<double>(t), state);
    };
    const RunEnd<Real> end = detail::with_control<StepperT>(spec, error_order, [&](auto control) {
      // One observer for all three ways of looking, so that each method is compiled once a control.
      SampleEvery<State, decltype(point)> sample(span, spec.every > 0 ? spec.every : spec.t_end, y0, point);
      return integrate(
          stepper, counted, span, y, control,
          [&](auto& view) {
            if (spec.every > 0)
              sample(view);
            else
              point(view.t1(), view.y1());
          },
          spec.max_steps);
    });
    record.outcome = end.outcome;
    record.t = end.t;
    record.stats.steps = end.stats.steps;
    record.stats.rejected = end.stats.rejected;
    record.y = y;
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
    detail::with_control<StepperT>(spec, error_order, [&](auto control) {
      State y = y0;
      for (std::int64_t run = 0; run < runs; ++run) {
        y = y0;
        if (spec.every > 0) {
          State* out = memory->data();
          auto store = [&out](Real, const State& state) { copy_state(state, *out++); };
          integrate(stepper, system, span, y, control,
                    SampleEvery<State, decltype(store)>(span, spec.every, y0, store), spec.max_steps);
        } else {
          integrate(stepper, system, span, y, control, ObserveNothing{}, spec.max_steps);
        }
        // The state is an input and an output the compiler knows nothing of: no run may be merged with
        // another.
        asm volatile("" : : "g"(y.data()) : "memory");
      }
      *last = y;
      return 0;
    });
    return *last;
  };

  runner.end_state_extended = [=](double h, double t_end) {
    using Extended = typename ExtendedSys::State;
    using ExtendedReal = real_of<Extended>;
    Extended y = y0.template cast<ExtendedReal>();
    integrate(extended_stepper, extended_system, Span<ExtendedReal>{0, static_cast<ExtendedReal>(t_end)}, y,
              FixedStep<ExtendedReal>(static_cast<ExtendedReal>(h)));
    return Eigen::Vector<long double, Eigen::Dynamic>(y.template cast<long double>());
  };
  return runner;
}

}  // namespace hmax
