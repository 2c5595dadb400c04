/// The Adams method of variable order and step of Shampine and Gordon, MATLAB's ode113.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "integrators/multistep/adams_coefficients.hpp"
#include "integrators/multistep/adams_pece_control.hpp"
#include "integrators/state.hpp"
#include "integrators/stepper.hpp"
#include "integrators/time_part.hpp"

namespace hmax {

/// One step of the predictor-corrector pair of order k = 1 .. 12 at any step size, in modified divided
/// differences phi_i(n) = psi_1(n) ... psi_i-1(n) f[t_n, ..., t_n-i+1], with psi_i(n) = t_n - t_n-i:
///   phi*_i  = beta_i phi_i(n),          beta_i = psi_1(n+1) ... psi_i-1(n+1) / (psi_1(n) ... psi_i-1(n))
///   P:  p   = y_n + h sum_{i <= k} g_i phi*_i,    phi^p_i = sum_{i <= j <= k} phi*_j
///   E:  f_p = f(t_n+1, p),              d = f_p - phi^p_1
///   C:  y_n+1 = p + h g_k+1 d           of order k + 1: local extrapolation
///   E:  phi_i(n+1) = phi^p_i + (f(t_n+1, y_n+1) - phi^p_1)
/// At equal steps beta_i = 1, g_i = gamma_i-1 and phi_i = nabla^(i-1) f.
/// The order is the control's to choose (set_order), one up or down at a time, and so is the last E: without
/// evaluate_end() it waits for the next attempt.
/// @cost   2 evaluations of f a step, 1 for a rejected attempt; O(k^2) for the coefficients while steps
/// change;
///         no allocation after init(); memory of 18 states
/// @source [shampine1975computer] (subroutines STEP and INTRP), its control of rounding errors left out
template <class StateT>
class AdamsPece {
 public:
  using State = StateT;
  using Real = real_of<State>;
  using Control = ShampineGordonControl<Real>;
  static constexpr int order = 0;  ///< chosen in the run
  static constexpr int error_order = 0;
  static constexpr bool may_estimate_error = true;
  static constexpr bool is_explicit = true;
  static constexpr int max_order = 12;  ///< of the predictor; the corrector has one more

  /// Forgets the past: the run begins at order 1 with one value of f.
  template <System Sys>
  void init(const Sys&, Real, const State& y) {
    for (State& phi : phi_) phi = State::Zero(y.size());
    predicted_slope_ = slope_ = end_slope_ = y;
    time_part_.forget();
    past_ = {};
    trial_ = {};
    order_ = 1;
    differences_ = Differences::none;
    end_slope_known_ = false;
  }

  /// y_new = y_n+1 by P, E, C at the order set_order() has chosen. phi(n) stays, so that an attempt may be
  /// repeated with another h and another order.
  /// @returns always ok: the pair solves no equations
  template <System Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    update_differences(system, t, y);
    end_slope_known_ = false;
    set_coefficients(h);
    const std::size_t k = trial_.k;
    std::array<Real, max_order> weights{};
    // P: g_i phi*_i = (g_i beta_i) phi_i, one pass over the differences; then phi^p_1 = sum_i phi*_i.
    for (std::size_t i = 0; i < k; ++i) weights[i] = g_[i] * beta_[i];
    add_combination(y, h, std::span<const Real>(weights.data(), k), phi_, y_new);
    combine(std::span<const Real>(beta_.data(), k), phi_, predicted_slope_);
    time_part_.rhs(system, t + h, y_new, slope_);
    // C: y_n+1 = p + h g_k+1 d
    const Real c = h * g_[k];
    detail::assign(
        y_new, [&](auto access) { return access(y_new) + c * (access(slope_) - access(predicted_slope_)); });
    return StepStatus::ok;
  }

  /// Commits the last attempt. The differences move when f(t_n+1, y_n+1) is known.
  void accept(const State&) {
    differences_ = Differences::await_end_slope;
    past_ = trial_;
    if (end_slope_known_) move_differences();
  }

  /// The polynomial of degree k + 1 through y_n+1 whose derivative passes through f_n+1 and the k values of f
  /// before it. It joins the step before up to the local error. Evaluates f(t_n+1, y_n+1), which then is the
  /// last E of the step.
  template <System Sys>
  void interpolate(const Sys& system, Real t, Real h, const State&, const State& y_new, Real theta,
                   State& out) {
    evaluate_end(system, t + h, y_new);
    const std::size_t k = trial_.k;
    const Real s = (theta - 1) * h;
    std::array<Real, max_order + 1> g{};
    adams::interpolation_weights<Real>(s, std::span<const Real>(trial_.psi), std::span(g.data(), k + 1));
    // sum_{i <= k+1} g_i phi_i(n+1) = sum_{j <= k} (g_1 + ... + g_j) phi*_j + (g_1 + ... + g_k+1) d
    std::array<Real, max_order> weights{};
    Real sum{0};
    for (std::size_t j = 0; j < k; ++j) {
      sum += g[j];
      weights[j] = sum * beta_[j];
    }
    sum += g[k];
    add_combination(y_new, s, std::span<const Real>(weights.data(), k), phi_, out);
    const Real c = s * sum;
    detail::assign(
        out, [&](auto access) { return access(out) + c * (access(end_slope_) - access(predicted_slope_)); });
  }

  /// The last E of the last attempt: f(t_end, y_new), kept for the differences of the next step.
  template <System Sys>
  const State& evaluate_end(const Sys& system, Real t_end, const State& y_new) {
    if (!end_slope_known_) {
      time_part_.rhs(system, t_end, y_new, end_slope_);
      end_slope_known_ = true;
    }
    return end_slope_;
  }

  /// f(t_0, y_0), the only difference known at the start.
  template <System Sys>
  const State& evaluate_start(const Sys& system, Real t, const State& y) {
    update_differences(system, t, y);
    return phi_[0];
  }

  /// The order of the next attempt: of the last one, one more or one less, or 1.
  void set_order(int k) { order_ = static_cast<std::size_t>(k); }
  [[nodiscard]] int current_order() const { return static_cast<int>(order_); }

  /// Whether the last k + 1 steps, the attempted one among them, have one size: error_one_above() may be
  /// called then.
  [[nodiscard]] bool steps_are_equal() const { return trial_.equal > trial_.k; }

  /// Estimates of the local error of the last attempt, as multiples of the tolerance that `weigh`
  /// expresses, with d = f_p - phi^p_1 [shampine1975computer]:
  ///   step      = |h (g_k - g_k+1) d|                               of order k, the error that is tested
  ///   at_order  = |h gamma*_k sigma_k+1 d|                          as at equal steps
  ///   one_below = |h gamma*_k-1 sigma_k (phi*_k + d)|               k >= 2
  ///   two_below = |h gamma*_k-2 sigma_k-1 (phi*_k-1 + phi*_k + d)|  k >= 3
  /// @param weight  callable, weight(i) of component i; norms are |weight(i) e_i|_2
  template <class Weight>
  AdamsErrors<Real> errors(const Weight& weight) const {
    const std::size_t k = trial_.k;
    Real at{0}, below{0}, two_below{0};
    for (Eigen::Index i = 0; i < slope_.size(); ++i) {
      const Real w = weight(i);
      auto e = slope_[i] - predicted_slope_[i];
      at += Eigen::numext::abs2(e * w);
      if (k < 2) continue;
      // d + phi*_k, then d + phi*_k + phi*_k-1, with phi*_i = beta_i phi_i.
      e += beta_[k - 1] * phi_[k - 1][i];
      below += Eigen::numext::abs2(e * w);
      if (k < 3) continue;
      e += beta_[k - 2] * phi_[k - 2][i];
      two_below += Eigen::numext::abs2(e * w);
    }
    const Real h = std::abs(trial_.h), difference = h * std::sqrt(at);
    AdamsErrors<Real> errors{.step = difference * std::abs(g_[k - 1] - g_[k]),
                             .at_order = difference * sigma_[k] * star(k)};
    if (k >= 2) errors.one_below = h * std::sqrt(below) * sigma_[k - 1] * star(k - 1);
    if (k >= 3) errors.two_below = h * std::sqrt(two_below) * sigma_[k - 2] * star(k - 2);
    return errors;
  }

  /// The same at order k + 1, |h gamma*_k+1 phi_k+2(n+1)|: after evaluate_end() and if steps_are_equal().
  template <class Weight>
  Real error_one_above(const Weight& weight) const {
    const std::size_t k = trial_.k;
    Real above{0};
    for (Eigen::Index i = 0; i < slope_.size(); ++i)
      above += Eigen::numext::abs2((end_slope_[i] - predicted_slope_[i] - phi_[k][i]) * weight(i));
    return std::abs(trial_.h) * star(k + 1) * std::sqrt(above);
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(phi_, predicted_slope_, slope_, end_slope_, time_part_, past_, trial_, beta_, sigma_, g_);
    visit(order_, differences_, end_slope_known_);
  }

 private:
  /// What is known of phi(n) at the present state.
  enum class Differences { none, await_end_slope, known };

  /// Sizes of the past steps: of the accepted ones, or with the one that is attempted.
  struct Steps {
    std::size_t k = 0;      // order of the last of them
    std::size_t equal = 0;  // how many of the newest have one size, as far as a formula asks
    Real h{};
    std::array<Real, max_order + 1> psi{};

    void visit_state(auto& visit) { visit(k, equal, h, psi); }
  };

  /// |gamma*_i|: the error of order i at equal steps is h |gamma*_i nabla^i f|.
  static Real star(std::size_t i) {
    static constexpr auto gamma_star = adams::gamma_star<max_order + 2>();
    return static_cast<Real>(std::abs(gamma_star[i]));
  }

  /// psi, beta, sigma and g of a step of size h and order `order_`:
  ///   alpha_i = h / psi_i,   sigma_i+1 = i alpha_i sigma_i,
  ///   c_1,q = 1 / q,   c_2,q = 1 / (q (q + 1)),   c_i,q = c_i-1,q - alpha_i-1 c_i-1,q+1,   g_i = c_i,1
  void set_coefficients(Real h) {
    const std::size_t k = order_;
    std::size_t equal = 1;
    if (h == past_.h) equal = past_.equal <= past_.k ? past_.equal + 1 : past_.equal;
    // With k + 1 equal steps nothing depends on the steps any more.
    if (k == trial_.k && h == trial_.h && equal > k && trial_.equal > k) {
      trial_.equal = equal;
      return;
    }
    trial_.k = k;
    trial_.h = h;
    trial_.equal = equal;
    std::array<Real, max_order> alpha{};
    for (std::size_t i = 0; i < k; ++i) {
      const auto number = static_cast<Real>(i + 1);
      if (i < equal) {
        // Over the newest `equal` steps the size is constant: alpha_i = 1 / i, beta_i = sigma_i = 1.
        trial_.psi[i] = number * h;
        beta_[i] = 1;
        alpha[i] = 1 / number;
        sigma_[i + 1] = 1;
      } else {
        // psi_i(n+1) = h + psi_i-1(n),  beta_i = beta_i-1 psi_i-1(n+1) / psi_i-1(n)
        trial_.psi[i] = past_.psi[i - 1] + h;
        beta_[i] = beta_[i - 1] * (trial_.psi[i - 1] / past_.psi[i - 1]);
        alpha[i] = h / trial_.psi[i];
        sigma_[i + 1] = number * alpha[i] * sigma_[i];
      }
    }
    // The triangle c_i,q, one row in the place of the other; row 2 is c_2,q = 1 / (q (q + 1)).
    std::array<Real, max_order + 1> c{};
    for (std::size_t q = 0; q < k; ++q) c[q] = 1 / static_cast<Real>((q + 1) * (q + 2));
    g_[0] = 1;
    g_[1] = c[0];
    for (std::size_t i = 2; i <= k; ++i) {
      for (std::size_t q = 0; q + i <= k; ++q) c[q] -= alpha[i - 1] * c[q + 1];
      g_[i] = c[0];
    }
  }

  /// phi(n) at the present state, which an accepted step without its last E still lacks.
  template <System Sys>
  void update_differences(const Sys& system, Real t, const State& y) {
    if (differences_ == Differences::known) [[likely]]
      return;
    if (differences_ == Differences::none) {
      time_part_.rhs(system, t, y, phi_[0]);
      differences_ = Differences::known;
      return;
    }
    time_part_.rhs(system, t, y, end_slope_);
    move_differences();
  }

  /// phi(n) becomes phi(n+1), by phi_i(n+1) = phi_i+1(n+1) + phi*_i downwards from phi_k+1(n+1) = f -
  /// phi^p_1; also phi_k+2(n+1), as far as equal steps make it a difference.
  void move_differences() {
    const std::size_t k = trial_.k;
    const auto move = [&](auto&& part) {
      auto&& d = part(slope_);  // of the attempt, no longer needed
      d = part(end_slope_) - part(predicted_slope_);
      part(phi_[k + 1]) = d - part(phi_[k]);
      part(phi_[k]) = d;
      for (std::size_t i = k; i-- > 1;) {
        d += beta_[i] * part(phi_[i]);
        part(phi_[i]) = d;
      }
      part(phi_[0]) = part(end_slope_);
    };
    if constexpr (is_small_state<State>)
      for_each_component<State>(
          [&](Eigen::Index i) { move([i](State& v) -> typename State::Scalar& { return v[i]; }); });
    else
      detail::for_each_block(slope_.size(), [&](Eigen::Index first, Eigen::Index length) {
        move([=](State& v) { return v.segment(first, length); });
      });
    differences_ = Differences::known;
  }

  std::array<State, max_order + 2> phi_;          ///< phi_i(n) is phi_[i - 1]
  State predicted_slope_ = blank_state<State>();  ///< phi^p_1
  State slope_ = blank_state<State>();            ///< f(t_n+1, p)
  State end_slope_ = blank_state<State>();        ///< f(t_n+1, y_n+1)
  TimePart<Real> time_part_;
  Steps past_, trial_;
  std::array<Real, max_order> beta_{};
  std::array<Real, max_order + 1> sigma_{1}, g_{};
  std::size_t order_ = 1;
  Differences differences_ = Differences::none;
  bool end_slope_known_ = false;
};

}  // namespace hmax
