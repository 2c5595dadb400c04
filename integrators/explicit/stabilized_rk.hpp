/// Stabilised explicit Runge-Kutta methods: s stages buy a step whose length grows with s^2 along the
/// negative real axis.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "integrators/explicit/stabilized_stages.hpp"
#include "integrators/hermite.hpp"
#include "integrators/spectral_radius.hpp"
#include "integrators/state.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// One step of a stabilised method of order two,
///   Y_0 = y,  Y_1 = y + h mu~_1 f(y),
///   Y_j = mu_j Y_{j-1} + nu_j Y_{j-2} + (1 - mu_j - nu_j) y + h (mu~_j f(Y_{j-1}) + gamma~_j f(y)),
///   y_new = Y_s,   err = 0.8 (y - y_new) + 0.4 h (f(y) + f(y_new)) = O(h^3).
/// The stage number s is the smallest one stable for h times the spectral radius of f: the bound of a system
/// that knows one, at every step; else an estimate that is renewed every 25 steps and after a rejection.
/// Stable means real negative eigenvalues: on the imaginary axis |R(iy)| = 1 + O(y^4) > 1 however many stages
/// there are, so that an oscillator needs damping, or steps short enough for accuracy.
/// @tparam Polynomials  Rkc2 or Rkl2
/// @cost   s evaluations of f a step, the last of which is the first of the next step, and those of the
///         estimate; no allocation after init()
template <class Polynomials, class StateT>
class StabilizedRk {
 public:
  using State = StateT;
  using Real = real_of<State>;
  /// Of y_new, and of err = O(h^3).
  static constexpr int order = 2, error_order = 3;
  static constexpr bool may_estimate_error = true, is_explicit = true;
  static constexpr int steps_between_estimates = 25;  ///< accepted steps

  static int max_stages() { return most_stabilized_stages<Real>(); }

  /// Allocates for max_stages() stages, so that steps allocate nothing.
  template <System Sys>
  void init(const Sys& system, Real, const State&) {
    if constexpr (!is_small_state<State>)
      for (State* vector : {&first_slope_, &end_slope_, &slope_, &stage_}) vector->resize(system.dim());
    if (!has_spectral_radius(system)) estimate_.init(system);
    stages_.clear();
    stages_.reserve(static_cast<std::size_t>(max_stages()) + 1);
    radius_ = 0;
    accepted_ = 0;
    first_slope_known_ = radius_is_of_here_ = false;
    radius_is_due_ = true;
  }

  /// y_new = Y_s. The spectral radius is evaluated first where it is due.
  /// @returns always ok; an h beyond longest_step() is attempted with max_stages() stages and is unstable
  template <System Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    if (!first_slope_known_) system.rhs(t, y, first_slope_);
    first_slope_known_ = true;
    if (radius_is_due_) find_radius(system, t, y);
    choose_stages<Polynomials>(h, radius_, stages_);

    // Y_j stands in y_new for j = s, s - 2, ..., in stage_ for the others.
    State *newer = &y_new, *older = &stage_;
    if (stages_.size() % 2 == 0) std::swap(newer, older);
    copy_state(y, *older);
    const Real first = h * stages_[0].mu_f;
    detail::assign(*newer, [&](auto access) { return access(y) + first * access(first_slope_); });
    for (std::size_t j = 1; j < stages_.size(); ++j) {
      const StabilizedStage<Real> stage = stages_[j].times(h);
      system.rhs(t + stage.node * h, *newer, slope_);
      detail::assign(*older, [&, older, newer](auto access) {
        return stage.of(access(*newer), access(*older), access(y), access(slope_), access(first_slope_));
      });
      std::swap(newer, older);
    }
    // The first slope of the next step, and half of the error estimate.
    system.rhs(t + h, y_new, end_slope_);
    return StepStatus::ok;
  }

  /// Commits the last attempt: y_new is the new state.
  void accept(const State&) {
    if constexpr (is_small_state<State>)
      copy_state(end_slope_, first_slope_);
    else
      first_slope_.swap(end_slope_);
    radius_is_of_here_ = false;
    ++accepted_;
    radius_is_due_ = system_knows_ || accepted_ % steps_between_estimates == 0;
  }

  /// An attempt was not good enough: the spectrum may have grown since it was estimated.
  void reject() { radius_is_due_ = !radius_is_of_here_; }

  /// The longest step that is stable with max_stages() stages, in the units of t; infinite where the spectral
  /// radius is zero. Adaptive cuts its steps to it.
  [[nodiscard]] Real longest_step() const { return longest_stabilized_step<Polynomials>(radius_); }

  /// Square of the weighted error norm of the last attempt; at most 1 means good enough.
  template <class Norm>
  Real error_squared(Real h, const State& y, const State& y_new, const Norm& norm) const {
    return norm.squared(y, y_new, [&](Eigen::Index d) {
      return stabilized_error(h, y[d], y_new[d], first_slope_[d], end_slope_[d]);
    });
  }

  /// out = y(t + theta h) by the cubic Hermite polynomial through both ends; it costs no evaluation.
  template <System Sys>
  void interpolate(const Sys&, Real, Real h, const State& y, const State& y_new, Real theta, State& out) {
    hermite_step(h, y, y_new, first_slope_, end_slope_, theta, out);
  }

  /// Stages of the last attempt.
  [[nodiscard]] int stages() const { return static_cast<int>(stages_.size()); }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(estimate_, radius_, accepted_, system_knows_, radius_is_due_, radius_is_of_here_,
          first_slope_known_);
    if (first_slope_known_) visit(first_slope_);
  }

 private:
  /// The spectral radius at (t, y): the bound of the system, or the estimate of SpectralRadius.
  template <System Sys>
  void find_radius(const Sys& system, Real t, const State& y) {
    system_knows_ = has_spectral_radius(system);
    if constexpr (BoundedSpectrumSystem<Sys>) {
      if (system_knows_) radius_ = system.spectral_radius(t, y);
    }
    if (!system_knows_) radius_ = estimate_.estimate(system, t, y, first_slope_);
    radius_is_due_ = false;
    radius_is_of_here_ = true;
  }

  State first_slope_ = blank_state<State>(), end_slope_ = first_slope_;  ///< f at both ends of the step
  /// f(Y_{j-1}), and the other one of Y_{j-1} and Y_{j-2}.
  State slope_ = first_slope_, stage_ = first_slope_;
  /// Coefficients for the number of stages of the last attempt.
  std::vector<StabilizedStage<Real>> stages_;
  SpectralRadius<State> estimate_;
  /// Spectral radius in use [1/s].
  Real radius_ = 0;
  std::int64_t accepted_ = 0;
  bool system_knows_ = false, first_slope_known_ = false;
  /// Whether it is to be evaluated before the next attempt, and whether it is that of the present state.
  bool radius_is_due_ = true, radius_is_of_here_ = false;
};

}  // namespace hmax
