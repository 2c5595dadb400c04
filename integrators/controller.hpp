/// Step-size controllers: from the error of an attempt to its verdict and the next step size.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

#include "core/instructions/single_powers.hpp"

namespace hmax {

/// What a controller says of one attempt.
template <class Real>
struct Verdict {
  bool accept;
  Real h_next;  ///< for the next step, or for the same step once more
};

/// Elementary (integral) controller: h_next = h clamp(0.9 err^(-1/q)), no growth right after a rejection
/// [hairer1993solving, II.4].
/// Every controller is constructed with q, the order of the error estimate (error = O(h^q)), and takes the
/// square of the error norm; the error is acceptable when it is at most 1, and NaN is a rejection.
template <class Real>
class IntegralController {
 public:
  /// @param error_order  q of err = O(h^q)
  explicit IntegralController(int error_order) : exponent_(Real(-0.5) / static_cast<Real>(error_order)) {}

  /// @param error_squared  err^2;  @param h  of the attempt, signed; h_next has its sign
  /// Factors lie in [0.2, 5], or in [0.2, 1] right after a rejection; an err that is not finite gives 0.2.
  Verdict<Real> judge(Real error_squared, Real h) {
    const bool accept = error_squared <= 1;  // false for NaN
    Real factor = std::isfinite(error_squared) ? Real(0.9) * std::pow(error_squared, exponent_) : Real(0.1);
    factor = std::clamp(factor, Real(0.2), accept && !rejected_ ? Real(5) : Real(1));
    rejected_ = !accept;
    return {accept, h * factor};
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(rejected_); }

 private:
  Real exponent_;          ///< -1 / (2 q): of err^2
  bool rejected_ = false;  ///< the last attempt was rejected
};

/// Proportional-integral controller: h_next = h 0.9 err^(-0.7/q) err_old^(0.4/q), smoother where stability
/// limits the step [gustafsson1991control].
template <class Real>
class PiController {
 public:
  /// @param error_order  q of err = O(h^q)
  explicit PiController(int error_order)
      : integral_(Real(-0.35) / static_cast<Real>(error_order)),
        proportional_(Real(0.2) / static_cast<Real>(error_order)),
        elementary_(Real(-0.5) / static_cast<Real>(error_order)) {}

  /// A rejected attempt shrinks by the elementary formula. Factors lie in [0.2, 5], or in [0.2, 1] for the
  /// first step after a rejection; an err that is not finite gives 0.2.
  Verdict<Real> judge(Real error_squared, Real h) {
    const bool accept = error_squared <= 1;
    if (!accept) {
      rejected_ = true;
      const Real factor =
          std::isfinite(error_squared) ? Real(0.9) * std::pow(error_squared, elementary_) : Real(0.1);
      return {false, h * std::clamp(factor, Real(0.2), Real(1))};
    }
    // An error of exactly zero must not make the next proportional term vanish.
    const Real error = std::max(error_squared, Real(1e-8));
    // h 0.9 err^(-0.7/q) err_old^(0.4/q), in squares: exponents -0.35 / q and 0.2 / q.
    Real factor = Real(0.9) * std::pow(error, integral_) * std::pow(previous_, proportional_);
    factor = std::clamp(factor, Real(0.2), rejected_ ? Real(1) : Real(5));
    previous_ = error;
    rejected_ = false;
    return {true, h * factor};
  }

  void visit_state(auto& visit) { visit(previous_, rejected_); }

 private:
  Real integral_, proportional_, elementary_;  ///< exponents of squares
  Real previous_ = 1;                          ///< err^2 of the last accepted step, at least 1e-8
  bool rejected_ = false;
};

/// Elementary controller that leaves h alone while the error is in (0.4, 0.8]. A step size that changes every
/// step makes the time of the next evaluation wait for the controller; an unchanged one is known in advance,
/// so the processor works on the next step while the error of this one is still being weighed. An error that
/// creeps above 0.8 is accepted but h shrinks at once, which costs less than the rejection that would follow:
/// against a band of (0.5, 1] the forced liver model takes a third of the rejections. Powers are taken in
/// single precision: a step size needs no more.
template <class Real>
class DeadbandController {
 public:
  explicit DeadbandController(int error_order) : exponent_(-0.5F / static_cast<float>(error_order)) {}

  /// h where err is in (0.4, 0.8], else h 0.9 err^(-1/q), at most 5 h. A rejected attempt shrinks to 0.2 h
  /// at least; an err that is not finite gives 0.1 h.
  HMAX_DEVICE Verdict<Real> judge(Real error_squared, Real h) {
    if (error_squared <= 1) [[likely]] {
      if (error_squared > Real(0.16) && error_squared <= Real(0.64)) [[likely]]
        return {true, h};
      return {true, h * std::min(factor(std::max(error_squared, Real(1e-30))), Real(5))};
    }
    return {false,
            h * (std::isfinite(error_squared) ? std::max(factor(error_squared), Real(0.2)) : Real(0.1))};
  }

  void visit_state(auto&) {}  // h alone tells it what to do

 private:
  /// 0.9 err^(-1/q).
  HMAX_DEVICE Real factor(Real error_squared) const {
    const Real bounded = std::min(error_squared, Real(1e30));
    return Real(0.9F * single_exp2(exponent_ * single_log2(static_cast<float>(bounded))));
  }
  float exponent_;
};

/// The rules of MATLAB's ode23 and ode45 [shampine1997matlab]: safety 0.8, growth at most 5, the first
/// failure shrinks by the formula down to 0.1, further failures halve, no growth after a failure.
template <class Real>
class MatlabController {
 public:
  explicit MatlabController(int error_order) : exponent_(Real(-0.5) / static_cast<Real>(error_order)) {}

  /// Accepted: h min(5, 0.8 err^(-1/q)), or h right after a failure. Rejected: h max(0.1, 0.8 err^(-1/q))
  /// at first, then h / 2; an err that is not finite gives h / 2.
  Verdict<Real> judge(Real error_squared, Real h) {
    if (!(error_squared <= 1)) {
      const bool first = !failed_;
      failed_ = true;
      if (!first || !std::isfinite(error_squared)) return {false, h / 2};
      return {false, h * std::max(Real(0.1), Real(0.8) * std::pow(error_squared, exponent_))};
    }
    const Real factor = failed_ ? Real(1) : std::min(Real(5), Real(0.8) * std::pow(error_squared, exponent_));
    failed_ = false;
    return {true, h * factor};
  }

  void visit_state(auto& visit) { visit(failed_); }

 private:
  Real exponent_;        ///< -1 / (2 q): of err^2
  bool failed_ = false;  ///< the attempt before was rejected
};

/// One of the controllers above, chosen at run time: for methods whose step costs far more than this choice.
template <class Real>
class AnyController {
 public:
  template <class Controller>
  explicit AnyController(Controller controller) : controller_(controller) {}

  Verdict<Real> judge(Real error_squared, Real h) {
    return std::visit([&](auto& controller) { return controller.judge(error_squared, h); }, controller_);
  }
  /// Whether runs follow the other rules of MATLAB's solvers too, see Adaptive.
  [[nodiscard]] bool matlab_rules() const {
    return std::holds_alternative<MatlabController<Real>>(controller_);
  }

  void visit_state(auto& visit) { visit(controller_); }

 private:
  std::variant<IntegralController<Real>, PiController<Real>, DeadbandController<Real>, MatlabController<Real>>
      controller_;
};

}  // namespace hmax
