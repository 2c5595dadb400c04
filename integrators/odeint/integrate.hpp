/// Runs of Boost.Odeint's steppers on systems of the house, with the observers of the house. Odeint's own
/// loops go on for ever where a derivative is not finite; these do not.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include <boost/numeric/odeint/util/odeint_error.hpp>

#include "integrators/initial_step.hpp"
#include "integrators/integrate.hpp"
#include "integrators/odeint/implicit_steppers.hpp"
#include "integrators/odeint/values.hpp"

namespace hmax::odeint {

namespace detail {

/// A step that is about to be accepted, as observers see it. It refers to all that it is given, so it lives
/// no longer than the call of the observer.
template <class Peer, class State>
class View : public StepEnds<State> {
 public:
  using Real = real_of<State>;
  using Values = typename Peer::Values;
  /// @param y0, y1      the ends in Odeint's types;  @param start, end  the same as states of hmax
  View(Peer& peer, Real t0, Real t1, const Values& y0, const Values& y1, const State& start, const State& end)
      : StepEnds<State>(t0, t1, t1 - t0, start, end), peer_(peer), values0_(y0), values1_(y1) {}

  /// out = y(t), t in [t0, t1]; at both ends the states themselves, inside by the peer.
  void at(Real t, State& out) {
    if (t == this->t1()) return copy_state(this->y1(), out);
    if (t == this->t0()) return copy_state(this->y0(), out);
    Values values = values0_;
    peer_.inside(values0_, this->t0(), values1_, this->t1(), t, values);
    to_state(values, out);
  }

 private:
  Peer& peer_;
  /// The same states in Odeint's types.
  const Values &values0_, &values1_;
};

/// True when the sum of the squares of Odeint's numbers is finite; false for NaN.
template <class Values>
bool is_bounded(const Values& values) {
  using Real = std::remove_cvref_t<decltype(*values.begin())>;
  Real sum{0};
  for (const Real value : values) sum += value * value;
  return sum <= std::numeric_limits<Real>::max();
}

/// Keeps the state of a run and shows its steps: `now` at t, and `next`, the candidate.
template <class Peer, class State, class Observer>
class Walk {
 public:
  using Real = real_of<State>;
  using Values = typename Peer::Values;
  /// There is an observer.
  static constexpr bool watched = !std::is_same_v<std::remove_cvref_t<Observer>, ObserveNothing>;

  /// @param y  initial state in, shape (n); the last accepted state is written to it
  Walk(Peer& peer, Real start, State& y, Observer& observer)
      : t(start), peer_(peer), y_(y), end_(y), observer_(observer), run_{Outcome::reached_end, start, {}} {
    to_values(y, now);
    next = now;
  }

  /// Accepts `next` at t_next; true when an observer ends the run there. Without an observer y_ waits
  /// for finish().
  bool accept(Real t_next) {
    ++run_.stats.steps;
    if constexpr (watched) {
      to_state(next, end_);
      View<Peer, State> view(peer_, t, t_next, now, next, y_, end_);
      observer_(view);
      if (view.stop()) {
        // The state at the stop is the last one of the run.
        State stopped = y_;
        view.at(*view.stop(), stopped);
        to_values(stopped, now);
        t = *view.stop();
        return true;
      }
      copy_state(end_, y_);
    }
    std::swap(now, next);
    t = t_next;
    return false;
  }
  void reject() { ++run_.stats.rejected; }  ///< counts a rejected attempt

  /// Whether a solution can be at `next`, as hmax::admits tells.
  template <class Sys>
  bool admitted(const Sys& system) {
    if (!is_bounded(next)) return false;
    if constexpr (requires { system.admits(end_); }) {
      to_state(next, end_);
      return system.admits(end_);
    }
    return true;
  }

  /// Writes the last accepted state to y and says how the run ended.
  /// @param at    where it ended or failed
  /// @param note  why equations were not solved
  RunEnd<Real> finish(Outcome outcome, Real at, std::string_view note = {}) {
    to_state(now, y_);
    run_.outcome = outcome;
    run_.t = at;
    run_.t_state = t;
    run_.note = note;
    return run_;
  }

  /// Time of `now`.
  Real t;
  /// The last accepted state and the candidate.
  Values now, next;

 private:
  Peer& peer_;
  State& y_;
  /// `next` as a state of hmax, for the observer and for admits().
  State end_;
  Observer& observer_;
  /// Its counts grow with the run; finish() fills in the rest.
  RunEnd<Real> run_;
};

/// Notes of failed runs.
inline constexpr std::string_view not_solved = "Odeint does not solve the stage equation";
inline constexpr std::string_view not_finite = "the derivative is not finite however short the step";

/// Steps steered by Odeint over a piece of a run.
/// @param longest  of a step
template <class Peer, System Sys, class Observer>
RunEnd<real_of<typename Sys::State>> steered_piece(const Sys& system, Span<real_of<typename Sys::State>> span,
                                                   typename Sys::State& y, real_of<typename Sys::State> rtol,
                                                   real_of<typename Sys::State> atol, int first_order,
                                                   real_of<typename Sys::State> h_first,
                                                   real_of<typename Sys::State> longest, Observer& observer,
                                                   std::int64_t max_steps) {
  using Real = real_of<typename Sys::State>;
  Peer peer(system, rtol, atol);
  Walk<Peer, typename Sys::State, Observer> walk(peer, span.t0, y, observer);
  // Odeint takes the first step as an argument; later ones are its own.
  Real h = h_first > 0 ? h_first
                       : hairer_initial_step(system, span.t0, y, first_order, RmsNorm<Real>{rtol, atol},
                                             span.t_end - span.t0, longest);
  // A step that shrinks to nothing has diverged where the last candidate was not finite.
  bool was_finite = true;
  for (std::int64_t attempts = 0;; ++attempts) {
    const Real t = walk.t;
    if (attempts == max_steps) return walk.finish(Outcome::too_many_steps, t);
    h = std::min(h, longest);
    // 16 units in the last place of t: below that a step no longer moves the time.
    const Real shortest = 16 * std::numeric_limits<Real>::epsilon() * std::abs(t);
    if (!(h > shortest) || !(t + h > t))
      return was_finite ? walk.finish(Outcome::step_too_small, t)
                        : walk.finish(Outcome::diverged, t, not_finite);
    // The last step is cut to the end of the span.
    bool last = t + h >= span.t_end;
    if (last) h = span.t_end - t;
    const Real tried = h;
    bool stands = false;
    try {
      stands = peer.try_step(walk.now, t, walk.next, h);
    } catch (const NotSolved&) {
      return walk.finish(Outcome::newton_failed, t, not_solved);
    } catch (const boost::numeric::odeint::odeint_error&) {
      return walk.finish(Outcome::step_too_small, t, "Odeint finds no step that it accepts");
    }
    was_finite = is_bounded(walk.next);
    if (!stands || !was_finite) {
      walk.reject();
      if (stands) {
        // Odeint takes an error that is no number for a small one: h is not cut by it, so it is here.
        if constexpr (requires { peer.take_back(); }) peer.take_back();
        h = tried / 4;
      }
      continue;
    }
    Real t_next = last ? span.t_end : t + tried;
    // A stepper with dense output may have stopped short of what was tried.
    if constexpr (requires { peer.reached(); }) {
      last = last && peer.reached() >= t + tried;
      t_next = last ? span.t_end : peer.reached();
    }
    if (!walk.admitted(system)) return walk.finish(Outcome::diverged, t_next);
    if (walk.accept(t_next)) return walk.finish(Outcome::stopped, walk.t);
    if (last) return walk.finish(Outcome::reached_end, walk.t);
  }
}

}  // namespace detail

/// Fixed steps over `span`, as hmax::integrate does them: time is t0 + n h, the last step may be shorter.
/// @tparam Peer      step(y, t, y_new, h) and inside(...), as in explicit_peers.hpp
/// @param y          initial state in, last bounded state out, shape (n)
/// @param h          > 0
/// @param observer   called as observer(View&) once for each accepted step
/// @param max_steps  steps allowed
/// @throws std::invalid_argument  where the span runs backwards
template <class Peer, System Sys, class Observer>
RunEnd<real_of<typename Sys::State>> integrate_fixed(const Sys& system,
                                                     Span<real_of<typename Sys::State>> span,
                                                     typename Sys::State& y, real_of<typename Sys::State> h,
                                                     Observer&& observer, std::int64_t max_steps) {
  using Real = real_of<typename Sys::State>;
  expect_forwards(span, "Boost.Odeint");
  if (!admits(system, y)) return {Outcome::diverged, span.t0, {}};
  if (span.t_end == span.t0) return {Outcome::reached_end, span.t0, {}};
  Peer peer(system);
  detail::Walk<Peer, typename Sys::State, std::remove_reference_t<Observer>> walk(peer, span.t0, y, observer);
  // The times of hmax: t0 + n h, the end exactly.
  FixedStep<Real> control(h);
  control.start(peer, system, span, y);
  for (std::int64_t steps = 0;; ++steps) {
    const Proposal<Real> step = control.propose(walk.t);
    if (steps == max_steps) return walk.finish(Outcome::too_many_steps, walk.t);
    if (!(step.t_next > walk.t)) return walk.finish(Outcome::step_too_small, walk.t);
    try {
      peer.step(walk.now, walk.t, walk.next, step.h);
    } catch (const NotSolved&) {
      return walk.finish(Outcome::newton_failed, walk.t, detail::not_solved);
    }
    if (!walk.admitted(system)) return walk.finish(Outcome::diverged, step.t_next);
    // Counts the step: fixed steps are always accepted.
    control.judge(peer, system, step, y, y);
    if (walk.accept(step.t_next)) return walk.finish(Outcome::stopped, walk.t);
    if (step.last) return walk.finish(Outcome::reached_end, walk.t);
  }
}

/// Steps steered by Odeint; it wants to be told the first one, which hmax chooses as for its own methods.
/// They land on the breakpoints of the system, where a fresh stepper goes on.
/// @tparam Peer         try_step(y, t, y_new, h) -> bool and inside(...), as in explicit_peers.hpp
/// @param y             initial state in, last accepted state out, shape (n)
/// @param rtol, atol    Odeint's own test: how they weigh the error is up to its stepper; the first step is
///                      chosen in the root mean square of hmax
/// @param first_order   order of the error estimate that the first step is chosen for
/// @param max_steps     attempts allowed
/// @param h_first, h_max  as in Tolerances
/// @throws std::invalid_argument  where the span runs backwards
template <class Peer, System Sys, class Observer>
RunEnd<real_of<typename Sys::State>> integrate_adaptive(
    const Sys& system, Span<real_of<typename Sys::State>> span, typename Sys::State& y,
    real_of<typename Sys::State> rtol, real_of<typename Sys::State> atol, int first_order,
    Observer&& observer, std::int64_t max_steps, real_of<typename Sys::State> h_first = 0,
    real_of<typename Sys::State> h_max = std::numeric_limits<real_of<typename Sys::State>>::infinity()) {
  using Real = real_of<typename Sys::State>;
  expect_forwards(span, "Boost.Odeint");
  if (!admits(system, y)) return {Outcome::diverged, span.t0, {}};
  if (span.t_end == span.t0) return {Outcome::reached_end, span.t0, {}};
  const Real longest = longest_step(h_max, span.t_end - span.t0);
  return run_by_pieces(system, span, y, max_steps,
                       [&](const Sys& of, Span<Real> piece, std::int64_t attempts) {
                         return detail::steered_piece<Peer>(of, piece, y, rtol, atol, first_order, h_first,
                                                            longest, observer, attempts);
                       });
}

/// An absolute tolerance for each component, which Odeint does not have.
/// @throws std::invalid_argument  always
template <class Peer, System Sys, class Derived, class Observer>
RunEnd<real_of<typename Sys::State>> integrate_adaptive(const Sys&, Span<real_of<typename Sys::State>>,
                                                        typename Sys::State&, real_of<typename Sys::State>,
                                                        const Eigen::MatrixBase<Derived>&, int, Observer&&,
                                                        std::int64_t) {
  throw std::invalid_argument(
      "Boost.Odeint has one absolute tolerance for all components: give a number, or take a method of hmax");
}

}  // namespace hmax::odeint
