/// Where the next step ends and whether an attempt is accepted: fixed steps, or steps steered by the error.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "core/instructions/device_code.hpp"
#include "integrators/controller.hpp"
#include "integrators/error_norm.hpp"
#include "integrators/initial_step.hpp"
#include "integrators/tolerances.hpp"

namespace hmax {

/// The time from t0 to t_end. Where t_end < t0 a run goes backwards, with steps h < 0.
template <class Real>
struct Span {
  Real t0, t_end;  ///< in the unit of the system; s for tissue

  /// The sign of the steps: 1, or -1 backwards.
  [[nodiscard]] constexpr Real direction() const { return t_end < t0 ? Real(-1) : Real(1); }
};

/// The step to attempt: from t to t_next = t + h up to rounding; `last` when t_next is the end of the span.
template <class Real>
struct Proposal {
  Real h, t_next;  ///< signed; may differ from t_next - t in rounding
  bool last;
};

/// What became of an attempt: accepted; to be repeated with the step that propose() says; or the run ends.
enum class Judgement { accept, retry, give_up };

// A control has four verbs. start(stepper, system, span, y) begins a run, after the stepper's init(), and
// tells a stepper that iterates (one with set_tolerances(rtol, atol)) how exact it has to be; propose(t) says
// which step to attempt next; judge(stepper, system, step, y, y_new) says what becomes of an attempt that
// made a candidate, and failed(stepper, step) of one that did not.
// A control that chooses its steps also has prepare(span): the whole run, of which start() then begins one
// piece after the other, from breakpoint to breakpoint (breakpoints.hpp).

namespace detail {
/// What rounding may do to a difference of two times in the span: 4 eps max(|t0|, |t_end|).
template <class Real>
Real rounding_of(Span<Real> span) {
  return 4 * std::numeric_limits<Real>::epsilon() * std::max(std::abs(span.t0), std::abs(span.t_end));
}

/// 16 eps |t|: a shorter step no longer moves time reliably.
template <class Real>
HMAX_DEVICE Real smallest_step(Real t) {
  return std::max(16 * std::numeric_limits<Real>::epsilon() * std::abs(t), std::numeric_limits<Real>::min());
}

/// The end of a run for controls that choose their steps, h < 0 backwards.
template <class Real>
struct Destination {
  Real t_end = 0, direction = 1;  ///< direction is 1, or -1 backwards

  explicit Destination(Span<Real> span) : t_end(span.t_end), direction(span.direction()) {}
  Destination() = default;

  /// A step of h, or the last one where `stretch` h reaches the end: no step passes it, and none is a
  /// sliver.
  /// @param stretch  >= 1; a last step may be that much longer than h
  [[nodiscard]] HMAX_DEVICE Proposal<Real> propose(Real t, Real h, Real stretch) const {
    if (direction * (t_end - (t + stretch * h)) <= 0) [[unlikely]]
      return {t_end - t, t_end, true};
    return {h, t + h, false};
  }
  /// h, cut to the length `longest`.
  [[nodiscard]] HMAX_DEVICE Real cut(Real h, Real longest) const {
    return std::abs(h) > longest ? direction * longest : h;
  }
};
}  // namespace detail

/// Whether a control chooses its steps, so that it can land on breakpoints.
template <class Control>
concept ChoosesSteps = requires(Control control) {
  control.prepare(typename Control::WholeSpan{});
};

/// The number of steps of size h that cover the span, h < 0 backwards: the last one is shorter when h does
/// not divide it, unless it would be a sliver of less than 1e-9 h or made by rounding. The largest integer
/// when there are more; 0 when h does not lead to the end.
template <class Real>
std::int64_t fixed_step_count(Span<Real> span, Real h) {
  const Real quotient = (span.t_end - span.t0) / h;
  if (!(quotient > 0)) return 0;
  const Real nearest = std::round(quotient);
  // Within a sliver of an integer the count is that integer, else the next larger one.
  const Real sliver = std::max(Real(1e-9), detail::rounding_of(span) / std::abs(h));
  const Real count = std::abs(quotient - nearest) <= sliver ? nearest : std::ceil(quotient);
  // 9e18 is below the largest 64-bit integer.
  if (!(count < Real(9e18))) return std::numeric_limits<std::int64_t>::max();
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(count));
}

/// The same for a span that begins at zero.
template <class Real>
std::int64_t fixed_step_count(Real length, Real h) {
  return fixed_step_count(Span<Real>{0, length}, h);
}

/// Steps of one size. Time is t0 + n h, computed and never accumulated; the last step ends at t_end exactly.
/// Backwards h is negative, whatever its sign is given as.
template <class Real>
class FixedStep {
 public:
  /// @param h  step size; its sign is that of the span where that runs backwards
  explicit FixedStep(Real h) : h_(h) {}

  /// Counts the steps of the span. An h that does not lead to the end becomes 0: the run ends.
  template <class Stepper, System Sys>
  void start(const Stepper&, const Sys&, Span<Real> span, const typename Sys::State&) {
    span_ = span;
    n_ = 0;
    if (span.t_end < span.t0) h_ = -std::abs(h_);
    last_ = fixed_step_count(span, h_) - 1;
    if (last_ < 0) h_ = 0;  // it leads nowhere, and the loop ends at once
    // A last step that differs from h by rounding alone is h.
    const Real rest = span.t_end - at(last_);
    last_h_ = std::abs(rest - h_) <= detail::rounding_of(span) ? h_ : rest;
  }

  /// t_next = t0 + (n + 1) h, or t_end for the last step.
  HMAX_DEVICE Proposal<Real> propose(Real) const {
    if (n_ == last_) [[unlikely]]
      return {last_h_, span_.t_end, true};
    return {h_, at(n_ + 1), false};
  }

  /// Every attempt that made a candidate is accepted: there is no error test.
  template <class Stepper, class Sys, class State>
  HMAX_DEVICE Judgement judge(const Stepper&, const Sys&, const Proposal<Real>&, const State&, const State&) {
    ++n_;
    return Judgement::accept;
  }

  /// A fixed step cannot be cut.
  template <class Stepper>
  Judgement failed(const Stepper&, const Proposal<Real>&) const {
    return Judgement::give_up;
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(n_); }

 private:
  /// t0 + n h.
  [[nodiscard]] HMAX_DEVICE Real at(std::int64_t n) const { return span_.t0 + static_cast<Real>(n) * h_; }

  Real h_;  ///< signed; 0 where it does not lead to the end
  Span<Real> span_{};
  std::int64_t n_ = 0, last_ = 0;  ///< accepted steps, and the number of the last one
  Real last_h_ = 0;                ///< its size
};

/// Steps steered by the error estimate of the method: `Controller` decides the size, `Norm` weighs the
/// error. An attempt is accepted where err <= 1 in this norm, and the next step is h_next of the
/// controller, at most the h_max of the tolerances, or a tenth of the span where none is given, and at most
/// the longest_step() of the stepper. A norm by component takes an absolute tolerance for each component;
/// start() throws std::invalid_argument where there is not one for each.
template <class Real, template <class> class Controller, template <class> class Norm = RmsNorm>
class Adaptive {
 public:
  using Atol = decltype(Norm<Real>::atol);
  using WholeSpan = Span<Real>;

  /// @param error_order  order of the error estimate; the stepper's own unless it is known only at run time
  Adaptive(Tolerances<Real, Atol> tolerances, int error_order)
      : Adaptive(tolerances, error_order, Controller<Real>(error_order),
                 Norm<Real>{tolerances.rtol, tolerances.atol}) {}

  /// For a controller and a norm that are chosen at run time.
  /// @param controller  constructed with the same error_order;  @param norm  with the same tolerances
  Adaptive(Tolerances<Real, Atol> tolerances, int error_order, Controller<Real> controller, Norm<Real> norm)
      : tolerances_(tolerances), norm_(norm), controller_(controller), error_order_(error_order) {}

  /// The span of the whole run, from which the longest step follows; that of start() without this call.
  void prepare(Span<Real> span) { longest_ = longest_step(tolerances_.h_max, span.t_end - span.t0); }

  /// Begins a run or a piece of it: gives the stepper its tolerances and chooses the first step, h_first or
  /// else that of hairer_initial_step(), under MATLAB's rules that of matlab_initial_step().
  /// @throws std::invalid_argument  unless there is one positive absolute tolerance for each component
  template <class Stepper, System Sys>
  void start(Stepper& stepper, const Sys& system, Span<Real> span, const typename Sys::State& y) {
    check_atol(tolerances_.atol, y.size());
    if constexpr (requires { stepper.set_tolerances(tolerances_.rtol, Real{}); })
      stepper.set_tolerances(tolerances_.rtol, tolerances_.atol);
    destination_ = detail::Destination<Real>(span);
    if (!(longest_ > 0)) prepare(span);
    const Real length = span.t_end - span.t0;
    Real first = tolerances_.h_first;
    if (!(first > 0))
      first = matlab_rules() ? matlab_initial_step(system, span.t0, y, error_order_, tolerances_.rtol,
                                                   tolerances_.atol, length, longest_)
                             : hairer_initial_step(system, span.t0, y, error_order_, norm_, length, longest_);
    first = std::max(std::min(first, longest_), detail::smallest_step(span.t0));
    h_ = span.direction() * first;
  }

  /// The last step is stretched by up to 1 % (10 % under MATLAB's rules) rather than leaving a sliver.
  HMAX_DEVICE Proposal<Real> propose(Real t) const {
    return destination_.propose(t, h_, matlab_rules() ? Real(1.1) : Real(1.01));
  }

  /// Accepts where the error norm is at most 1.
  /// @returns accept, retry with the shorter step of the controller, or give_up where that is too short
  template <class Stepper, class Sys, class State>
  HMAX_DEVICE Judgement judge(const Stepper& stepper, const Sys&, const Proposal<Real>& step, const State& y,
                              const State& y_new) {
    const Verdict<Real> verdict = controller_.judge(stepper.error_squared(step.h, y, y_new, norm_), step.h);
    h_ = destination_.cut(verdict.h_next, longest_);
    if constexpr (requires { stepper.longest_step(); }) h_ = destination_.cut(h_, stepper.longest_step());
    if (verdict.accept) [[likely]] {
      // A method that keeps its Jacobian would have to factor anew for every change of h.
      if constexpr (requires { stepper.prefers_equal_steps(); })
        if (stepper.prefers_equal_steps() && std::abs(h_ - step.h) <= std::abs(step.h) / 5) h_ = step.h;
      return Judgement::accept;
    }
    return retry_or_give_up(step);
  }

  /// An implicit equation without a solution: a quarter of the step starts nearer to it.
  template <class Stepper>
  Judgement failed(const Stepper&, const Proposal<Real>& step) {
    h_ = step.h / 4;
    return retry_or_give_up(step);
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(h_, controller_); }

 private:
  /// Whether steps and end of the run follow MATLAB's rules too.
  HMAX_DEVICE bool matlab_rules() const {
    if constexpr (requires { controller_.matlab_rules(); })
      return controller_.matlab_rules();
    else
      return std::is_same_v<Controller<Real>, MatlabController<Real>>;
  }

  /// give_up where the step is too short to move t, 16 eps |t|.
  HMAX_DEVICE Judgement retry_or_give_up(const Proposal<Real>& step) const {
    return std::abs(h_) <= detail::smallest_step(step.t_next) ? Judgement::give_up : Judgement::retry;
  }

  Tolerances<Real, Atol> tolerances_;
  Norm<Real> norm_;
  Controller<Real> controller_;
  int error_order_;
  detail::Destination<Real> destination_;
  Real h_ = 0;        ///< of the next attempt, signed
  Real longest_ = 0;  ///< step of the run; 0: prepare() has not been called
};

}  // namespace hmax
