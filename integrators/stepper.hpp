/// What a stepper is: one attempted step of a method, without a loop and without an opinion about its size.
#pragma once

#include <concepts>
#include <string_view>

#include "integrators/system.hpp"

namespace hmax {

/// Whether an attempted step produced a candidate at all.
enum class StepStatus {
  ok,             ///< the candidate is there; whether it is good enough is the control's business
  newton_failed,  ///< an implicit stage equation was not solved
};

/// How a run ended.
enum class Outcome {
  reached_end,     ///< the state is that at the end of the span
  stopped,         ///< an observer asked for it (a terminal event)
  diverged,        ///< the state is not finite, or not what the system admits
  step_too_small,  ///< a step no longer changes t, or the error test fails at one that hardly does
  too_many_steps,  ///< max_steps attempts, rejected ones included
  newton_failed,   ///< stage equations are not solved and the step cannot be cut
};

/// The word that stores, tables and JSON use.
constexpr std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::reached_end:
      return "reached_end";
    case Outcome::stopped:
      return "stopped";
    case Outcome::diverged:
      return "diverged";
    case Outcome::step_too_small:
      return "step_too_small";
    case Outcome::too_many_steps:
      return "too_many_steps";
    case Outcome::newton_failed:
      return "newton_failed";
  }
  return "unknown";
}

/// init() prepares for a run and is the only call that allocates. attempt() writes a candidate for t + h into
/// y_new, h < 0 backwards, and may be repeated with another h: only accept() commits. interpolate() is valid
/// after a successful attempt and until accept(): it writes the state at t + theta h, theta in [0, 1].
///
/// A stepper with an error estimate also has error_squared(h, y, y_new, norm), the square of its weighted
/// norm; one that solves equations has work() -> ImplicitWork, what it did since init(). One that assumes
/// something it could look at anew (the spectrum of f, say) may have reject(), called when an attempt was not
/// good enough and another follows; one whose steps are stable only up to a length of its own may have
/// longest_step(). One that chooses its own order brings a control of its own (control.hpp says what a
/// control is).
template <class M, class Sys>
concept Stepper = System<Sys> && requires(M stepper, const Sys& system, real_of<typename Sys::State> t,
                                          const typename Sys::State& y, typename Sys::State& y_new) {
  { M::order } -> std::convertible_to<int>;        // 0 when it is known only at run time
  { M::error_order } -> std::convertible_to<int>;  // error estimate = O(h^error_order); 0 without one
  stepper.init(system, t, y);
  { stepper.attempt(system, t, y, t, y_new) } -> std::same_as<StepStatus>;
  stepper.accept(y_new);
  stepper.interpolate(system, t, t, y, y_new, t, y_new);
};

}  // namespace hmax
