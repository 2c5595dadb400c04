/// The explicit steppers of Boost.Odeint in the form that integrators/odeint/integrate.hpp drives: one step
/// from y at t into y_new, tried or just done, and what lies inside it.
#pragma once

#include <algorithm>
#include <functional>
#include <utility>

#include <boost/numeric/odeint/stepper/adams_bashforth_moulton.hpp>
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/bulirsch_stoer_dense_out.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "integrators/odeint/values.hpp"

namespace hmax::odeint {

namespace native = boost::numeric::odeint;

/// A step of given size by any stepper of Odeint. Inside it there is no dense output; Odeint's own way is to
/// step to the time that is asked for, so a copy does that from the left end.
/// @tparam StepperT  a stepper with do_step(f, y, t, y_new, h), perhaps a multistep method
template <System Sys, class StepperT>
class FixedPeer {
 public:
  using Real = real_of<typename Sys::State>;
  using Values = values_of<typename Sys::State>;

  /// @param system  must outlive the peer
  explicit FixedPeer(const Sys& system) : rhs_(system) {}

  /// y_new at t + h.
  /// @param y, y_new  shape (n);  @param h  size, > 0
  void step(const Values& y, Real t, Values& y_new, Real h) {
    // The history of a multistep method belongs to one step size: a shorter last step starts anew.
    if (h != h_) stepper_ = StepperT();
    h_ = h;
    // By reference: Odeint would copy the function, with its two states, at every call.
    stepper_.do_step(std::ref(rhs_), y, t, y_new, h);
  }

  /// out = y(t), t in (t0, t1), by one step of a fresh stepper from t0.
  void inside(const Values& y0, Real t0, const Values&, Real, Real t, Values& out) {
    StepperT fresh;
    fresh.do_step(std::ref(rhs_), y0, t0, out, t - t0);
  }

 private:
  Rhs<Sys> rhs_;
  StepperT stepper_;  ///< with the history of a multistep method
  Real h_ = 0;        ///< of the last step
};

/// Fehlberg's pair, its step steered by Odeint. A step stands where
///   max_i |err_i| / (atol + rtol (|y_i| + h |f_i|)) <= 1,   f at the start of the step;
/// after a rejection h shrinks, to h / 5 at least; where the maximum is below 1/2 it becomes up to 4.5 h.
template <System Sys, class ErrorStepper>
class ControlledPeer {
 public:
  using Real = real_of<typename Sys::State>;
  using Values = values_of<typename Sys::State>;

  /// @param system  must outlive the peer;  @param rtol, atol  Odeint takes them in the other order
  ControlledPeer(const Sys& system, Real rtol, Real atol)
      : rhs_(system), controlled_(typename Controlled::error_checker_type(atol, rtol)) {}

  /// @param h  the step to try in, the next one out
  /// @returns whether y_new at t + h stands
  bool try_step(const Values& y, Real t, Values& y_new, Real& h) {
    return controlled_.try_step(std::ref(rhs_), y, t, y_new, h) == native::success;
  }

  /// out = y(t), t in (t0, t1), by one step of a fresh stepper from t0, without a test of its error.
  void inside(const Values& y0, Real t0, const Values&, Real, Real t, Values& out) {
    ErrorStepper fresh;
    fresh.do_step(std::ref(rhs_), y0, t0, out, t - t0);
  }

 private:
  using Controlled = native::controlled_runge_kutta<ErrorStepper>;
  Rhs<Sys> rhs_;
  Controlled controlled_;
};

/// The pair of Dormand and Prince [dormand1980family], first same as last, with its dense output of order 4.
/// The error is weighed and the step steered as in ControlledPeer; the slopes at both ends are kept here.
template <System Sys>
class Dopri5Peer {
 public:
  using Real = real_of<typename Sys::State>;
  using Values = values_of<typename Sys::State>;

  Dopri5Peer(const Sys& system, Real rtol, Real atol)
      : rhs_(system), controlled_(typename Controlled::error_checker_type(atol, rtol)) {}

  /// @param h  the step to try in, the next one out
  /// @returns whether y_new at t + h is accepted
  bool try_step(const Values& y, Real t, Values& y_new, Real& h) {
    // k_1 of the first step; later ones have it from the step before.
    if (!started_) {
      start_ = end_ = y;
      rhs_(y, start_, t);
      started_ = true;
    }
    // The last slope of an accepted step is the first one of the next; a rejected step keeps its own.
    if (accepted_) std::swap(start_, end_);
    accepted_ = controlled_.try_step(std::ref(rhs_), y, start_, t, y_new, end_, h) == native::success;
    return accepted_;
  }

  /// Takes back a step that Odeint accepted though it is not finite: the next attempt begins with the slope
  /// at the same start.
  void take_back() { accepted_ = false; }

  /// out = y(t), t in (t0, t1), from y and f at both ends of the last step and the stages that the stepper
  /// holds: no evaluation.
  void inside(const Values& y0, Real t0, const Values& y1, Real t1, Real t, Values& out) {
    controlled_.stepper().calc_state(t, out, y0, start_, t0, y1, end_, t1);
  }

 private:
  using Stepper = native::runge_kutta_dopri5<Values, Real>;
  using Controlled = native::controlled_runge_kutta<Stepper>;
  Rhs<Sys> rhs_;
  Controlled controlled_;
  Values start_{}, end_{};  ///< f at both ends of the step
  /// start_ holds f at the first state; the last attempt was accepted.
  bool started_ = false, accepted_ = false;
};

/// Extrapolation of the modified midpoint rule in h^2 by Bulirsch and Stoer [hairer1993solving, II.9], order
/// and step chosen together. It has no dense output: inside a step a fresh stepper steps to the time that is
/// asked for, with the same tolerances.
template <System Sys>
class BulirschStoerPeer {
 public:
  using Real = real_of<typename Sys::State>;
  using Values = values_of<typename Sys::State>;

  BulirschStoerPeer(const Sys& system, Real rtol, Real atol)
      : rhs_(system), stepper_(atol, rtol), fresh_(stepper_) {}

  /// @param h  the step to try in, the next one out
  /// @returns whether y_new at t + h is accepted
  bool try_step(const Values& y, Real t, Values& y_new, Real& h) {
    return stepper_.try_step(std::ref(rhs_), y, t, y_new, h) == native::success;
  }

  /// out = y(t), t in (t0, t1), by steps from t0 with the same error test.
  void inside(const Values& y0, Real t0, const Values&, Real, Real t, Values& out) {
    Stepper stepper = fresh_;
    out = y0;
    Values next = y0;
    Real at = t0, h = t - t0;
    // Ends at t exactly. After 1000 attempts out is where it has come to.
    for (int attempts = 0; attempts < 1000 && at < t; ++attempts) {
      h = std::min(h, t - at);
      const bool last = at + h >= t;
      if (stepper.try_step(std::ref(rhs_), out, at, next, h) != native::success) continue;
      out = next;
      if (last) return;
    }
  }

 private:
  using Stepper = native::bulirsch_stoer<Values, Real>;
  Rhs<Sys> rhs_;
  /// fresh_ stays as constructed: its copies have no history.
  Stepper stepper_, fresh_;
};

/// The same with a dense output of high order, which makes its steps a little different: 2, 6, 10, ...
/// midpoint steps instead of 2, 4, 6, ..., as the interpolant asks for [hairer1993solving, II.9].
template <System Sys>
class BulirschStoerDensePeer {
 public:
  using Real = real_of<typename Sys::State>;
  using Values = values_of<typename Sys::State>;

  BulirschStoerDensePeer(const Sys& system, Real rtol, Real atol) : rhs_(system), stepper_(atol, rtol) {}

  /// Always accepts: Odeint repeats a step by itself until its error is small enough.
  /// @param h  the step to try in, the next one out; reached() says where the step ended
  bool try_step(const Values& y, Real t, Values& y_new, Real& h) {
    // A step that differs from Odeint's own proposal starts anew from y.
    if (!started_ || h != stepper_.current_time_step()) {
      stepper_.initialize(y, t, h);
      started_ = true;
    }
    stepper_.do_step(std::ref(rhs_));
    y_new = stepper_.current_state();
    reached_ = stepper_.current_time();
    h = stepper_.current_time_step();
    return true;
  }

  /// Where the step ended: the stepper repeats it with shorter ones by itself.
  [[nodiscard]] Real reached() const { return reached_; }
  /// The next attempt starts anew from the state it is given.
  void take_back() { started_ = false; }

  /// out = y(t) by the extrapolated interpolant of the last step, no evaluation. It knows its ends.
  void inside(const Values&, Real, const Values&, Real, Real t, Values& out) { stepper_.calc_state(t, out); }

 private:
  Rhs<Sys> rhs_;
  native::bulirsch_stoer_dense_out<Values, Real> stepper_;
  bool started_ = false;
  Real reached_ = 0;  ///< end of the last step
};

}  // namespace hmax::odeint
