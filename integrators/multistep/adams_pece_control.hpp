/// How Shampine and Gordon's Adams method chooses its order and its step.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "integrators/control.hpp"
#include "integrators/state.hpp"

namespace hmax {

/// Estimates of the local error of one attempt at order k; 0 below order 1.
template <class Real>
struct AdamsErrors {
  Real step;                          ///< of the attempt as its steps really are; this is what is tested
  Real at_order;                      ///< as at equal steps of order k,
  Real one_below = 0, two_below = 0;  ///< k - 1 and k - 2: these choose the order
};

/// The rules of subroutine STEP [shampine1975computer]:
/// - The error test is |e / w|_2 <= eps with eps = max(rtol, atol_i) and w_i = (rtol |y_i| + atol_i) / eps:
/// the
///   Euclidean norm over all components, not their mean.
/// - The run begins with order 1, and while all goes well each step raises the order and doubles the step.
/// - Then the order falls when errors at lower orders are no larger, and rises when that at the next one is
///   smaller, which only equal steps can tell. Steps double when the error allows it, keep their size, or
///   shrink by a factor of 0.5 to 0.9: equal steps are cheap and stable, so no other growth is worth it.
/// - A failed step is halved; after the third failure in a row the order is 1.
/// A tolerance below what rounding allows is taken as the smallest that it does.
/// A relative tolerance above one half is taken as one half: errors as large as the state let it run away.
/// STEP leaves to its caller what eps stands for. Here it is 0.7 of the tolerance, a factor chosen on the
/// forced liver model from 1e-4 to 1e-10: with 1 the run at 1e-10 takes a tenth fewer evaluations and ends
/// three tolerances off, since the highest orders work there at the edge of their stability.
/// @tparam Atol  Real, the same for all components, or a vector with one for each
template <class Real, class Atol = Real>
class ShampineGordonControl {
 public:
  using WholeSpan = Span<Real>;

  explicit ShampineGordonControl(Tolerances<Real, Atol> tolerances) : tolerances_(std::move(tolerances)) {
    tolerances_.rtol = Real(0.7) * std::min(tolerances_.rtol, Real(0.5));
    tolerances_.atol *= Real(0.7);
  }

  /// The span of the whole run, from which the longest step follows; that of start() without this call.
  void prepare(Span<Real> span) { longest_ = longest_step(tolerances_.h_max, span.t_end - span.t0); }

  /// Begins a run at order 1 with h = min(h_first, h_max, sqrt(eps / |f(t_0, y_0) / w|_2) / 4). An h_first of
  /// 0 stands for the longest step, or for first_step_from_rest() where f says nothing.
  /// @throws std::invalid_argument  unless there is one positive absolute tolerance for each component
  template <class Stepper, System Sys>
  void start(Stepper& stepper, const Sys& system, Span<Real> span, const typename Sys::State& y) {
    using State = typename Sys::State;
    check_atol(tolerances_.atol, y.size());
    eps_ = std::max(tolerances_.rtol, detail::largest_atol(tolerances_.atol));
    destination_ = detail::Destination<Real>(span);
    if (!(longest_ > 0)) prepare(span);
    const Real length = span.t_end - span.t0;
    // |v / w|_2
    const auto weighted = [&](const State& v) {
      Real sum{0};
      for (Eigen::Index i = 0; i < y.size(); ++i) sum += Eigen::numext::abs2(v[i] * weight(y, i));
      return std::sqrt(sum);
    };
    const Real rate = weighted(stepper.evaluate_start(system, span.t0, y));
    Real first =
        std::min({tolerances_.h_first > 0 ? tolerances_.h_first : longest_, longest_, std::abs(length)});
    if (!(tolerances_.h_first > 0) && starts_at_rest(rate / eps_, length))
      first = std::min(first, first_step_from_rest(
                                  system, span.t0, y, [&](const State& v) { return weighted(v) / eps_; },
                                  length, longest_));
    // In the unit of time of hairer_initial_step().
    const Real unit = std::min(std::abs(length), Real(1));
    if (unit * eps_ < 16 * rate * first * first) first = std::sqrt(unit * eps_ / rate) / 4;
    h_ = span.direction() * std::max(first, detail::smallest_step(span.t0));
    failures_ = 0;
    doubling_ = true;
  }

  /// The last step is stretched by up to 1 % rather than leaving a sliver.
  Proposal<Real> propose(Real t) const { return destination_.propose(t, h_, Real(1.01)); }

  /// Accepts where |e / w|_2 <= eps. An accepted step whose f(t_n+1, y_n+1) is not finite is retried.
  /// @returns accept, retry with half the step, or give_up where the step no longer moves t
  template <class Stepper, System Sys>
  Judgement judge(Stepper& stepper, const Sys& system, const Proposal<Real>& step,
                  const typename Sys::State& y, const typename Sys::State& y_new) {
    const auto w = [&](Eigen::Index i) { return weight(y, i); };
    const AdamsErrors<Real> errors = stepper.errors(w);
    const int k = stepper.current_order();
    const Real tolerance = std::max(eps_, rounding_of(y));
    int next = k;
    // Lower the order where max(e_k-1, e_k-2) <= e_k, or e_1 <= e_2 / 2.
    if (k > 2 ? std::max(errors.one_below, errors.two_below) <= errors.at_order
              : k == 2 && errors.one_below <= errors.at_order / 2)
      next = k - 1;
    if (!(errors.step <= tolerance)) return shorten(stepper, step, errors.at_order, tolerance, next);
    failures_ = 0;
    if (step.last) return Judgement::accept;
    // A state beyond which f is not finite is no place to go on from.
    if (!is_bounded(stepper.evaluate_end(system, step.t_next, y_new)))
      return shorten(stepper, step, errors.at_order, tolerance, next);
    choose(stepper, step.h, errors, tolerance, next, w);
    return Judgement::accept;
  }

  /// The stepper made no candidate; the order stays and the step is halved.
  template <class Stepper>
  Judgement failed(Stepper& stepper, const Proposal<Real>& step) {
    return shorten(stepper, step, Real(0), eps_, stepper.current_order());
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(h_, failures_, doubling_); }

 private:
  /// eps / (rtol |y_i| + atol_i) = 1 / w_i.
  template <class State>
  Real weight(const State& y, Eigen::Index i) const {
    return eps_ / (tolerances_.rtol * std::abs(y[i]) + detail::atol_of(tolerances_.atol, i));
  }

  /// The smallest tolerance that rounding of y allows: 4 u |y / w|_2, u the distance from 1 to the next
  /// number.
  template <class State>
  Real rounding_of(const State& y) const {
    constexpr Real u = std::numeric_limits<Real>::epsilon();
    // Looser tolerances are far above rounding.
    if (eps_ > Real(1e-10)) return 0;
    Real sum{0};
    for (Eigen::Index i = 0; i < y.size(); ++i) sum += Eigen::numext::abs2(y[i] * weight(y, i));
    return 4 * u * std::sqrt(sum);
  }

  /// Order and step after an accepted step, which may still lower the order to `next`.
  template <class Stepper, class Weight>
  void choose(Stepper& stepper, Real h, const AdamsErrors<Real>& errors, Real tolerance, int next,
              const Weight& w) {
    const int k = stepper.current_order();
    Real error = next < k ? errors.one_below : errors.at_order;
    if (next < k || k == Stepper::max_order) doubling_ = false;
    if (doubling_) {
      next = k + 1;
    } else if (next == k && stepper.steps_are_equal()) {
      // The error at order k + 1, known after k + 1 equal steps only.
      const Real above = stepper.error_one_above(w);
      if (k > 1 && errors.one_below <= std::min(errors.at_order, above)) {
        next = k - 1;
        error = errors.one_below;
      } else if (k < Stepper::max_order && above < (k > 1 ? errors.at_order : errors.at_order / 2)) {
        next = k + 1;
        error = above;
      }
    }
    stepper.set_order(next);
    // The error grows by 2^(k+1) when the step doubles; half the tolerance is aimed at.
    const Real aim = tolerance / 2;
    if (doubling_ || aim >= std::ldexp(error, next + 1))
      h_ = 2 * h;
    else if (aim >= error)
      h_ = h;
    // h (eps / (2 e))^(1/(k+1)), held between 0.5 h and 0.9 h, with k the order of the next step.
    else
      h_ = h * std::clamp(std::pow(aim / error, 1 / static_cast<Real>(next + 1)), Real(0.5), Real(0.9));
    h_ = destination_.cut(h_, longest_);
  }

  /// The step after a failure: h / 2. From the fourth failure on, h (eps / (2 e))^(1/2) where that is
  /// shorter.
  /// @returns give_up below 16 units in the last place of t
  template <class Stepper>
  Judgement shorten(Stepper& stepper, const Proposal<Real>& step, Real error, Real tolerance, int next) {
    doubling_ = false;
    ++failures_;
    Real factor = Real(0.5);
    // Past the third failure the optimal step of order 1 may be shorter still.
    if (failures_ > 3 && tolerance / 2 < error / 4) factor = std::sqrt(tolerance / 2 / error);
    stepper.set_order(failures_ >= 3 ? 1 : next);
    h_ = step.h * factor;
    return std::abs(h_) > detail::smallest_step(step.t_next) ? Judgement::retry : Judgement::give_up;
  }

  Tolerances<Real, Atol> tolerances_;
  Real eps_ = 0;
  detail::Destination<Real> destination_;
  Real h_ = 0;
  Real longest_ = 0;  ///< step of the run; 0: prepare() has not been called
  int failures_ = 0;
  bool doubling_ = true;  ///< phase 1 of a run
};

}  // namespace hmax
