/// THE loop over time: the only one in the house.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "integrators/breakpoints.hpp"
#include "integrators/control.hpp"
#include "integrators/run_end.hpp"
#include "integrators/state.hpp"
#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// What every view of a step has: both ends, and the request to end the run.
/// It refers to the states of the loop and is valid during the call of the observer only.
template <class State>
class StepEnds {
 public:
  using Real = real_of<State>;
  /// @param h       t1 - t0 up to rounding, negative backwards
  /// @param y0, y1  states at t0 and t1, shape (n); they must outlive this view
  StepEnds(Real t0, Real t1, Real h, const State& y0, const State& y1)
      : t0_(t0), t1_(t1), h_(h), y0_(y0), y1_(y1) {}

  /// The step leads from y0 at t0 to y1 at t1 = t0 + h, up to rounding; h < 0 backwards.
  [[nodiscard]] Real t0() const { return t0_; }
  [[nodiscard]] Real t1() const { return t1_; }
  [[nodiscard]] Real h() const { return h_; }            ///< signed
  [[nodiscard]] const State& y0() const { return y0_; }  ///< shape (n)
  [[nodiscard]] const State& y1() const { return y1_; }  ///< shape (n)

  /// Ends the run at time t in [t0, t1]. Of several requests the first in the order of the run counts.
  void stop_at(Real t) {
    if (!stop_ || std::abs(t - t0_) < std::abs(*stop_ - t0_)) stop_ = t;
  }
  /// The request of an observer, if there is one.
  [[nodiscard]] const std::optional<Real>& stop() const { return stop_; }
  /// The time up to which the step counts: t1, or the stop that an observer before has requested.
  [[nodiscard]] Real t_end() const { return stop_ ? *stop_ : t1_; }

 private:
  Real t0_, t1_, h_;
  const State &y0_, &y1_;
  /// Where the run is to end; empty: it goes on.
  std::optional<Real> stop_;
};

/// A step that is about to be accepted, as observers see it: both ends and, on request, everything between.
template <class StepperT, System Sys>
class StepView : public StepEnds<typename Sys::State> {
 public:
  using State = typename Sys::State;
  using Real = real_of<State>;

  /// @param stepper  after a successful attempt of `step` from y0, before accept()
  StepView(StepperT& stepper, const Sys& system, Real t0, const Proposal<Real>& step, const State& y0,
           const State& y1)
      : StepEnds<State>(t0, step.t_next, step.h, y0, y1), stepper_(stepper), system_(system) {}

  /// out = y(t) by dense output, t in [t0, t1], shape (n); costs nothing unless called and never shortens a
  /// step. At t1 it is y1 exactly.
  void at(Real t, State& out) {
    if (t == this->t1())
      copy_state(this->y1(), out);
    else
      stepper_.interpolate(system_, this->t0(), this->h(), this->y0(), this->y1(),
                           (t - this->t0()) / this->h(), out);
  }

  /// What an implicit method did since the start of the run, this step included.
  [[nodiscard]] ImplicitWork work() const requires requires(const StepperT& stepper) { stepper.work(); }
  { return stepper_.work(); }

 private:
  StepperT& stepper_;
  const Sys& system_;
};

/// The observer of runs nobody watches; the loop then builds no view at all.
struct ObserveNothing {};

namespace detail {

/// The loop of integrate(): attempt, judgement, observer, accept, until the span or the run ends.
template <class StepperT, System Sys, class Control, class Observer>
inline RunEnd<real_of<typename Sys::State>> loop(StepperT& stepper, const Sys& system,
                                                 Span<real_of<typename Sys::State>> span,
                                                 typename Sys::State& y, Control& control, Observer& observer,
                                                 std::int64_t max_steps) {
  using State = typename Sys::State;
  using Real = real_of<State>;
  RunEnd<Real> end{Outcome::reached_end, span.t0, {}};
  if (!admits(system, y)) return {Outcome::diverged, span.t0, {}};
  if (span.t_end == span.t0) return end;

  State now = y, candidate = y;
  stepper.init(system, span.t0, now);
  control.start(stepper, system, span, now);
  Real t = span.t0;
  auto finish = [&](Outcome outcome, Real at) {
    copy_state(now, y);
    end.outcome = outcome;
    end.t = at;
    end.t_state = t;
    if constexpr (requires { stepper.work(); }) {
      end.stats.take(stepper.work());
      if (outcome == Outcome::newton_failed) end.note = stepper.work().failure;
    }
    return end;
  };

  Proposal<Real> step = control.propose(t);
  for (std::int64_t attempts = 0;;) {
    // One pass of this outer loop is a run of attempts of equal size: the compiler then knows that h stays
    // and multiplies it into the coefficients of the method once a run (g++: with -fno-trapping-math).
    const Real h = step.h;
    do {
      if (attempts++ == max_steps) [[unlikely]]
        return finish(Outcome::too_many_steps, t);
      if (step.t_next == t) [[unlikely]]
        return finish(Outcome::step_too_small, t);
      const StepStatus status = stepper.attempt(system, t, now, h, candidate);
      const Judgement judgement = status == StepStatus::ok
                                      ? control.judge(stepper, system, step, now, candidate)
                                      : control.failed(stepper, step);
      if (judgement == Judgement::accept) [[likely]] {
        if (!admits(system, candidate)) [[unlikely]]
          return finish(Outcome::diverged, step.t_next);
        ++end.stats.steps;
        if constexpr (!std::is_same_v<std::remove_cvref_t<Observer>, ObserveNothing>) {
          StepView<StepperT, Sys> view(stepper, system, t, step, now, candidate);
          observer(view);
          if (view.stop()) {
            State stopped = now;
            view.at(*view.stop(), stopped);  // NOLINT(bugprone-unchecked-optional-access): asked above
            now = stopped;
            t = *view.stop();  // NOLINT(bugprone-unchecked-optional-access): asked above
            return finish(Outcome::stopped, t);
          }
        }
        stepper.accept(candidate);
        copy_state(candidate, now);
        t = step.t_next;
        if (step.last) return finish(Outcome::reached_end, t);
      } else {
        ++end.stats.rejected;
        if (judgement == Judgement::give_up)
          return finish(status == StepStatus::ok ? Outcome::step_too_small : Outcome::newton_failed, t);
        if constexpr (requires { stepper.reject(); }) stepper.reject();
      }
      step = control.propose(t);
    } while (step.h == h);
  }
}

/// Explicit steps of a few numbers take some nanoseconds; a step that solves equations does not.
template <class StepperT, System Sys>
inline constexpr bool worth_flattening = is_small_state<typename Sys::State>&& [] {
  if constexpr (requires { StepperT::is_explicit; })
    return static_cast<bool>(StepperT::is_explicit);
  else
    return true;
}();

/// The loop with everything inlined: small states then live in registers from step to step. An unoptimised
/// build would only take twice as long to compile.
template <class StepperT, System Sys, class Control, class Observer>
#ifdef __OPTIMIZE__
[[gnu::flatten]]
#endif
auto flat_loop(StepperT stepper, const Sys& system, Span<real_of<typename Sys::State>> span,
                                typename Sys::State& y, Control control, Observer& observer,
                                std::int64_t max_steps) {
  return loop(stepper, system, span, y, control, observer, max_steps);
}

}  // namespace detail

/// Integrates y' = f(t, y) over `span`, backwards where it ends before it begins. A control that chooses its
/// steps lands on the breakpoints of the system (breakpoints.hpp); fixed steps do not.
/// @param stepper   taken by value: the loop owns the memory of the method, so the compiler may keep it in
/// registers
/// @param y         initial state in, last accepted state out, shape (n)
/// @param control   FixedStep or Adaptive
/// @param observer  called as observer(StepView&) once for each accepted step, in order of time
/// @param max_steps attempts allowed
/// Failure is a value (RunEnd::outcome), never an exception.
template <class StepperT, System Sys, class Control, class Observer = ObserveNothing>
RunEnd<real_of<typename Sys::State>> integrate(StepperT stepper, const Sys& system,
                                               Span<real_of<typename Sys::State>> span,
                                               typename Sys::State& y, Control control,
                                               Observer&& observer = {},
                                               std::int64_t max_steps = 1'000'000'000) {
  const auto over = [&](const Sys& of, Span<real_of<typename Sys::State>> piece, std::int64_t attempts) {
    if constexpr (detail::worth_flattening<StepperT, Sys>) {
      return detail::flat_loop(stepper, of, piece, y, control, observer, attempts);
    } else {
      Control fresh = control;  // what it learns of one piece does not hold for the next
      return detail::loop(stepper, of, piece, y, fresh, observer, attempts);
    }
  };
  if constexpr (ChoosesSteps<Control>) {
    control.prepare(span);
    return run_by_pieces(system, span, y, max_steps, over);
  } else {
    return over(system, span, max_steps);
  }
}

}  // namespace hmax
