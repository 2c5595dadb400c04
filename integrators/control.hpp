/// Where the next step ends and whether an attempt is accepted: fixed steps, or steps steered by the error.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "integrators/controller.hpp"
#include "integrators/error_norm.hpp"
#include "integrators/initial_step.hpp"

namespace hmax {

/// A time interval [t0, t_end], t_end >= t0.
template <class Real>
struct Span {
  Real t0, t_end;
};

/// The step to attempt: from t to t_next = t + h up to rounding; `last` when t_next is the end of the span.
template <class Real>
struct Proposal {
  Real h, t_next;
  bool last;
};

/// What became of an attempt.
enum class Judgement { accept, retry, give_up };

// A control has four verbs. start(stepper, system, span, y) begins a run, after the stepper's init(), and
// tells a stepper that iterates (one with set_tolerances(rtol, atol)) how exact it has to be; propose(t) says
// which step to attempt next; judge(stepper, system, step, y, y_new) says what becomes of an attempt that
// made a candidate, and failed(stepper, step) of one that did not.

namespace detail {
/// What rounding may do to a difference of two times in the span.
template <class Real>
Real rounding_of(Span<Real> span) {
  return 4 * std::numeric_limits<Real>::epsilon() * std::max(std::abs(span.t0), std::abs(span.t_end));
}
}  // namespace detail

/// The number of steps of size h that cover the span: the last one is shorter when h does not divide it,
/// unless it would be a sliver of less than 1e-9 h or made by rounding. The largest integer when there are
/// more.
template <class Real>
std::int64_t fixed_step_count(Span<Real> span, Real h) {
  const Real quotient = (span.t_end - span.t0) / h;
  if (!(quotient > 0)) return 0;
  const Real nearest = std::round(quotient);
  const Real sliver = std::max(Real(1e-9), detail::rounding_of(span) / h);
  const Real count = std::abs(quotient - nearest) <= sliver ? nearest : std::ceil(quotient);
  if (!(count < Real(9e18))) return std::numeric_limits<std::int64_t>::max();
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(count));
}

/// The same for a span that begins at zero.
template <class Real>
std::int64_t fixed_step_count(Real length, Real h) {
  return fixed_step_count(Span<Real>{0, length}, h);
}

/// Steps of one size. Time is t0 + n h, computed and never accumulated; the last step ends at t_end exactly.
template <class Real>
class FixedStep {
 public:
  explicit FixedStep(Real h) : h_(h) {}

  template <class Stepper, System Sys>
  void start(const Stepper&, const Sys&, Span<Real> span, const typename Sys::State&) {
    span_ = span;
    n_ = 0;
    last_ = fixed_step_count(span, h_) - 1;
    const Real rest = span.t_end - at(last_);
    last_h_ = std::abs(rest - h_) <= detail::rounding_of(span) ? h_ : rest;
  }

  Proposal<Real> propose(Real) const {
    if (n_ == last_) [[unlikely]]
      return {last_h_, span_.t_end, true};
    return {h_, at(n_ + 1), false};
  }

  template <class Stepper, class Sys, class State>
  Judgement judge(const Stepper&, const Sys&, const Proposal<Real>&, const State&, const State&) {
    ++n_;
    return Judgement::accept;
  }

  /// A fixed step cannot be cut.
  template <class Stepper>
  Judgement failed(const Stepper&, const Proposal<Real>&) const {
    return Judgement::give_up;
  }

 private:
  [[nodiscard]] Real at(std::int64_t n) const { return span_.t0 + static_cast<Real>(n) * h_; }

  Real h_;
  Span<Real> span_{};
  std::int64_t n_ = 0, last_ = 0;
  Real last_h_ = 0;
};

/// Settings of a run steered by its error.
template <class Real>
struct Tolerances {
  Real rtol, atol;
  Real h_first = 0;  ///< 0: chosen from the right-hand side
  Real h_max = std::numeric_limits<Real>::infinity();
};

/// Steps steered by the error estimate of the method: `Controller` decides the size, `Norm` weighs the error.
template <class Real, template <class> class Controller, template <class> class Norm = RmsNorm>
class Adaptive {
 public:
  /// @param error_order  order of the error estimate; the stepper's own unless it is known only at run time
  Adaptive(Tolerances<Real> tolerances, int error_order)
      : Adaptive(tolerances, error_order, Controller<Real>(error_order),
                 Norm<Real>{tolerances.rtol, tolerances.atol}) {}

  /// For a controller and a norm that are chosen at run time.
  Adaptive(Tolerances<Real> tolerances, int error_order, Controller<Real> controller, Norm<Real> norm)
      : tolerances_(tolerances), norm_(norm), controller_(controller), error_order_(error_order) {}

  template <class Stepper, System Sys>
  void start(Stepper& stepper, const Sys& system, Span<Real> span, const typename Sys::State& y) {
    if constexpr (requires { stepper.set_tolerances(tolerances_.rtol, tolerances_.atol); })
      stepper.set_tolerances(tolerances_.rtol, tolerances_.atol);
    t_end_ = span.t_end;
    const Real length = span.t_end - span.t0;
    if (matlab_rules()) tolerances_.h_max = std::min(tolerances_.h_max, length / 10);
    if (tolerances_.h_first > 0)
      h_ = tolerances_.h_first;
    else if (matlab_rules())
      h_ = matlab_initial_step(system, span.t0, y, error_order_, tolerances_.rtol, tolerances_.atol,
                               tolerances_.h_max);
    else
      h_ = hairer_initial_step(system, span.t0, y, error_order_, norm_, length);
    h_ = std::max(std::min(h_, tolerances_.h_max), smallest_step(span.t0));
  }

  /// The last step is stretched by up to 1 % (10 % under MATLAB's rules) rather than leaving a sliver.
  Proposal<Real> propose(Real t) const {
    const Real stretch = matlab_rules() ? Real(1.1) : Real(1.01);
    if (t + stretch * h_ >= t_end_) [[unlikely]]
      return {t_end_ - t, t_end_, true};
    return {h_, t + h_, false};
  }

  template <class Stepper, class Sys, class State>
  Judgement judge(const Stepper& stepper, const Sys&, const Proposal<Real>& step, const State& y,
                  const State& y_new) {
    const Verdict<Real> verdict = controller_.judge(stepper.error_squared(step.h, y, y_new, norm_), step.h);
    h_ = std::min(verdict.h_next, tolerances_.h_max);
    if constexpr (requires { stepper.longest_step(); }) h_ = std::min(h_, stepper.longest_step());
    if (verdict.accept) [[likely]] {
      // A method that keeps its Jacobian would have to factor anew for every change of h.
      if constexpr (requires { stepper.prefers_equal_steps(); })
        if (stepper.prefers_equal_steps() && std::abs(h_ - step.h) <= step.h / 5) h_ = step.h;
      return Judgement::accept;
    }
    return retry_or_give_up(step);
  }

  /// An implicit equation without a solution: a shorter step starts nearer to it.
  template <class Stepper>
  Judgement failed(const Stepper&, const Proposal<Real>& step) {
    h_ = step.h / 4;
    return retry_or_give_up(step);
  }

 private:
  bool matlab_rules() const {
    if constexpr (requires { controller_.matlab_rules(); })
      return controller_.matlab_rules();
    else
      return std::is_same_v<Controller<Real>, MatlabController<Real>>;
  }

  Judgement retry_or_give_up(const Proposal<Real>& step) const {
    return h_ <= smallest_step(step.t_next) ? Judgement::give_up : Judgement::retry;
  }

  /// Below 16 units in the last place of t a step no longer moves time reliably.
  static Real smallest_step(Real t) {
    return std::max(16 * std::numeric_limits<Real>::epsilon() * std::abs(t),
                    std::numeric_limits<Real>::min());
  }

  Tolerances<Real> tolerances_;
  Norm<Real> norm_;
  Controller<Real> controller_;
  int error_order_;
  Real t_end_ = 0, h_ = 0;
};

}  // namespace hmax
