/// Stabilised explicit Runge-Kutta methods: s stages buy a step whose length grows with s^2 along the
/// negative real axis.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "integrators/hermite.hpp"
#include "integrators/spectral_radius.hpp"
#include "integrators/state.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// Shifted Chebyshev polynomials, damped by eps = 2/13 [sommeijer1998rkc].
/// A family of polynomials P_0 = 1, P_1 = x, P_j = alpha_j x P_{j-1} - beta_j P_{j-2} makes a method of order
/// two: it tells alpha_j and beta_j, the point w0 around which it is expanded, how far along the negative
/// real axis s stages are stable, and which is the smallest number of stages that reaches so far.
struct Rkc2 {
  static constexpr std::string_view id = "rkc_2", source = "sommeijer1998rkc";
  static constexpr double damping = 2.0 / 13;  ///< eps of w0 = 1 + eps / s^2

  /// T_j(x) = 2 x T_{j-1}(x) - T_{j-2}(x).
  template <class Real>
  static Real alpha(int) {
    return Real(2);
  }
  template <class Real>
  static Real beta(int) {
    return Real(1);
  }
  /// w0 = 1 + eps / s^2, eps = 2/13: |R| stays below 1 inside of the interval.
  template <class Real>
  static Real w0(int s) {
    return 1 + Real(2) / (13 * static_cast<Real>(s) * static_cast<Real>(s));
  }
  /// Where stability ends, as a bound of h times the spectral radius:
  /// beta(s) = (2/3) (s^2 - 1) (1 - (2/15) eps), a little less than the first point where |R| = 1.
  template <class Real>
  static Real reach(int s) {
    return slope<Real>() * (static_cast<Real>(s) * static_cast<Real>(s) - 1);
  }
  /// The smallest s >= 2 with beta(s) >= x.
  template <class Real>
  static int stages(Real x) {
    return std::max(2, static_cast<int>(std::ceil(std::sqrt(1 + x / slope<Real>()))));
  }

 private:
  /// beta(s) / (s^2 - 1).
  template <class Real>
  static constexpr Real slope() {
    return (Real(2) / 3) * (1 - (Real(2) / 15) * (Real(2) / 13));
  }
};

/// Legendre polynomials, which need no damping; s is odd, since even ones are not damped at the end of their
/// reach, (s^2 + s - 2) / 2 [meyer2014stabilized].
struct Rkl2 {
  static constexpr std::string_view id = "rkl_2", source = "meyer2014stabilized";

  /// j P_j(x) = (2 j - 1) x P_{j-1}(x) - (j - 1) P_{j-2}(x), as alpha_j and beta_j.
  template <class Real>
  static Real alpha(int j) {
    return static_cast<Real>(2 * j - 1) / static_cast<Real>(j);
  }
  template <class Real>
  static Real beta(int j) {
    return static_cast<Real>(j - 1) / static_cast<Real>(j);
  }
  template <class Real>
  static Real w0(int) {
    return Real(1);
  }
  /// (s^2 + s - 2) / 2: with many stages a quarter less than the reach of RKC2.
  template <class Real>
  static Real reach(int s) {
    return (static_cast<Real>(s) * static_cast<Real>(s) + static_cast<Real>(s) - 2) / 2;
  }
  /// The smallest odd s >= 3 with reach(s) >= x.
  template <class Real>
  static int stages(Real x) {
    const int s = std::max(3, static_cast<int>(std::ceil((std::sqrt(9 + 8 * x) - 1) / 2)));
    return s + (s % 2 == 0 ? 1 : 0);
  }
};

/// The coefficients of the s stages of a step of unit length.
/// With w0, w1 = P_s'(w0) / P_s''(w0), b_j = P_j''(w0) / P_j'(w0)^2, b_0 = b_1 = b_2, a_j = 1 - b_j P_j(w0):
///   mu_j = alpha_j w0 b_j / b_{j-1},  nu_j = -beta_j b_j / b_{j-2},  mu~_j = alpha_j w1 b_j / b_{j-1},
///   gamma~_j = -a_{j-1} mu~_j,  R_j(z) = a_j + b_j P_j(w0 + w1 z).
template <class Real>
struct StabilizedStage {
  Real mu, nu, rest;   ///< of Y_{j-1}, Y_{j-2} and y: mu + nu + rest = 1
  Real mu_f, gamma_f;  ///< of h f(Y_{j-1}) and h f(y)
  Real node;           ///< c_{j-1}: f(Y_{j-1}) is taken at t + c_{j-1} h
};

/// Writes the stages j = 1 .. s; that of j = 1 has only mu_f.
/// @param s       number of stages, at least 2
/// @param stages  resized to s; entry j - 1 belongs to Y_j
template <class Polynomials, class Real>
void make_stages(int s, std::vector<StabilizedStage<Real>>& stages) {
  // P_j, P_j', P_j'' at w0 for the last three j.
  struct Values {
    Real p, d, d2;
  };
  const Real w0 = Polynomials::template w0<Real>(s);
  // P_j = alpha w0 P_{j-1} - beta P_{j-2} and its derivatives with respect to w0.
  const auto next = [w0](int j, const Values& one, const Values& two) {
    const Real alpha = Polynomials::template alpha<Real>(j), beta = Polynomials::template beta<Real>(j);
    return Values{alpha * w0 * one.p - beta * two.p, alpha * (one.p + w0 * one.d) - beta * two.d,
                  alpha * (2 * one.d + w0 * one.d2) - beta * two.d2};
  };
  // P_0 = 1 and P_1 = x with their derivatives at w0.
  const Values first{1, 0, 0}, second{w0, 1, 0};
  Values two = first, one = second;
  for (int j = 2; j <= s; ++j) two = std::exchange(one, next(j, one, two));
  // w1 = P_s'(w0) / P_s''(w0)
  const Real w1 = one.d / one.d2;

  stages.resize(static_cast<std::size_t>(s));
  two = first;
  one = second;
  // b_0 = b_1 = b_2 = P_2'' / P_2'^2
  const Values third = next(2, one, two);
  Real b_two = third.d2 / (third.d * third.d), b_one = b_two;
  // Y_1 = y + h mu~_1 f(y) with mu~_1 = b_1 w1.
  stages[0] = {0, 0, 1, b_one * w1, 0, 0};
  // c_0 = 0, c_1 = mu~_1
  Real c_two{0}, c_one = stages[0].mu_f;
  for (int j = 2; j <= s; ++j) {
    const Values now = next(j, one, two);
    const Real b = now.d2 / (now.d * now.d), a_one = 1 - b_one * one.p;
    const Real ratio = Polynomials::template alpha<Real>(j) * b / b_one;
    const Real mu = ratio * w0, nu = -Polynomials::template beta<Real>(j) * b / b_two, mu_f = ratio * w1;
    stages[static_cast<std::size_t>(j - 1)] = {mu, nu, 1 - mu - nu, mu_f, -a_one * mu_f, c_one};
    // c_j = mu_j c_{j-1} + nu_j c_{j-2} + mu~_j + gamma~_j
    const Real c = mu * c_one + nu * c_two + mu_f * (1 - a_one);
    c_two = std::exchange(c_one, c);
    b_two = std::exchange(b_one, b);
    two = std::exchange(one, now);
  }
}

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

  /// Rounding enters a step multiplied by some 10 s^2 [sommeijer1998rkc]: with more stages than this half of
  /// the digits would be lost: 10 s^2 eps = sqrt(eps), 2590 stages of double. A step that needs more is as
  /// unstable as that of any explicit method.
  static int max_stages() {
    return static_cast<int>(std::pow(std::numeric_limits<Real>::epsilon(), Real(-0.25)) /
                            std::sqrt(Real(10)));
  }

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
    prepare_stages(h);

    // Y_j stands in y_new for j = s, s - 2, ..., in stage_ for the others.
    State *newer = &y_new, *older = &stage_;
    if (stages_.size() % 2 == 0) std::swap(newer, older);
    copy_state(y, *older);
    const Real first = h * stages_[0].mu_f;
    detail::assign(*newer, [&](auto access) { return access(y) + first * access(first_slope_); });
    for (std::size_t j = 1; j < stages_.size(); ++j) {
      const StabilizedStage<Real>& c = stages_[j];
      system.rhs(t + c.node * h, *newer, slope_);
      const Real mu_f = h * c.mu_f, gamma_f = h * c.gamma_f;
      detail::assign(*older, [&, older, newer](auto access) {
        return (c.mu * access(*newer) + c.nu * access(*older) + c.rest * access(y)) +
               (mu_f * access(slope_) + gamma_f * access(first_slope_));
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
  [[nodiscard]] Real longest_step() const {
    return radius_ > 0 ? Polynomials::template reach<Real>(max_stages()) / radius_
                       : std::numeric_limits<Real>::infinity();
  }

  /// Square of the weighted error norm of the last attempt; at most 1 means good enough.
  template <class Norm>
  Real error_squared(Real h, const State& y, const State& y_new, const Norm& norm) const {
    return norm.squared(y, y_new, [&](Eigen::Index d) {
      return Real(0.8) * (y[d] - y_new[d]) + (Real(0.4) * h) * (first_slope_[d] + end_slope_[d]);
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

  /// The stages for |h| rho, computed again only when their number changes.
  void prepare_stages(Real h) {
    // reach(s) >= |h| rho, at most max_stages(); a radius that is NaN gives the fewest.
    const Real x = std::abs(h) * radius_, most = Polynomials::template reach<Real>(max_stages());
    const int s = Polynomials::template stages<Real>(x >= 0 ? std::min(x, most) : Real(0));
    if (s != stages()) make_stages<Polynomials>(s, stages_);
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
