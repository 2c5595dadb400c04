/// The one stepper of all Adams methods at fixed step: Adams-Bashforth and the predictor-corrector pairs.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"
#include "integrators/multistep/adams_coefficients.hpp"
#include "integrators/state.hpp"
#include "integrators/stepper.hpp"
#include "integrators/time_part.hpp"

namespace hmax {

/// What a step does: predict (P), evaluate f (E), correct (C).
enum class AdamsMode {
  bashforth,  ///< P E: the explicit formula alone
  pece,       ///< predict, evaluate, correct, evaluate: past values are f(t_n, y_n)
  pec,        ///< predict, evaluate, correct: past values are f(t_n, p_n) of the predicted states
};

/// A step of an Adams method of order k = 1 .. 6 at fixed step,
///   P:  p = y_n + h sum_{i < k} beta_i f_n-i        (Adams-Bashforth of order k)
///   E:  f_n+1 = f(t_n+1, p)
///   C:  y_n+1 = y_n + h sum_{i < k} beta*_i f_n+1-i  (Adams-Moulton of the same order k)
///   E:  f_n+1 = f(t_n+1, y_n+1)
/// The first k - 1 steps, and a step whose size differs from the one before (the last of a run, when h does
/// not divide it), are taken by a Runge-Kutta method of order 8: the order of a run is that of the Adams
/// formula. Steps of order 1 need no past and take any size.
/// Dense output is the integral, up to any time within the step, of the polynomial that the step itself
/// integrated: of order k, meeting both ends, without an evaluation.
/// @cost   1 evaluation of f a step, 2 with PECE, whose last E waits for the next step; 12 for each
///         Runge-Kutta step; no allocation after init()
/// @source [hairer1993solving] III.1
template <class StateT>
class Adams {
 public:
  using State = StateT;
  using Real = real_of<State>;
  static constexpr int max_order = 6;  ///< the formulas of k values have order k
  static constexpr int order = 0;      ///< known at run time
  static constexpr int error_order = 0;
  static constexpr bool may_estimate_error = false;
  static constexpr bool is_explicit = true;

  /// @param k  order and number of values, 1 .. max_order; pairs take predictor and corrector of the same k
  /// The weights are those of the values f_n-i, from gamma_j and gamma*_j by weights_of_values().
  explicit Adams(AdamsMode mode = AdamsMode::bashforth, int k = 1)
      : mode_(mode), k_(static_cast<std::size_t>(k)) {
    static constexpr auto gamma = adams::gamma<max_order>();
    static constexpr auto gamma_star = adams::gamma_star<max_order>();
    set_weights(gamma, predictor_);
    set_weights(gamma_star, corrector_);
    for (std::size_t i = 0; i < max_order; ++i) distances_[i] = static_cast<Real>(i + 1);
  }

  /// Forgets the past: the first k - 1 steps of the run are Runge-Kutta steps.
  template <System Sys>
  void init(const Sys& system, Real t, const State& y) {
    for (State& f : f_) f = y;
    starter_.init(system, t, y);
    time_part_.forget();
    known_ = 1;
    spacing_ = std::numeric_limits<Real>::quiet_NaN();
    slope_known_ = starting_ = false;
  }

  /// y_new from the past values, by P, or by P, E and C. The last E, f(t + h, y_new), is the first
  /// evaluation of the next attempt. An h other than that of the past is taken by the Runge-Kutta method.
  /// @returns always ok: no equations are solved
  template <System Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    if (!slope_known_) {
      time_part_.rhs(system, t, y, f_[1]);
      slope_known_ = true;
    }
    h_ = h;
    starting_ = k_ > 1 && (known_ < k_ || h != spacing_);
    if (starting_) [[unlikely]]
      return runge_kutta_step(system, t, y, h, y_new);
    // P: p = y + h sum_i beta_i f_n-i
    add_combination(y, h, weights(predictor_), past(), y_new);
    if (mode_ != AdamsMode::bashforth) {
      // E and C: y_new = y + h (beta*_0 f(t + h, p) + sum_{i >= 1} beta*_i f_n+1-i)
      time_part_.rhs(system, t + h, y_new, f_[0]);
      add_combination(y, h, weights(corrector_), newest(), y_new);
    }
    return StepStatus::ok;
  }

  /// Commits the last attempt: f_n-i becomes f_n-i-1. Past values at equal distances count.
  void accept(const State& y_new) {
    for (std::size_t i = k_; i > 0; --i) move_state(f_[i - 1], f_[i]);
    slope_known_ = mode_ == AdamsMode::pec && !starting_;
    if (starting_) {
      starter_.accept(y_new);
      copy_state(starter_.first_stage(), f_[1]);
      slope_known_ = true;
    }
    // A step of another size leaves two usable values: f at its ends.
    known_ = h_ == spacing_ ? std::min(known_ + 1, k_) : 2;
    spacing_ = h_;
  }

  /// out = y(t + theta h) = y_left + s h sum_i g_i(s) nabla^i f, no evaluation: the formula with its upper
  /// limit of integration inside of the step. Starting steps use the interpolant of the Runge-Kutta method.
  /// @param theta  in [0, 1]
  template <System Sys>
  void interpolate(const Sys& system, Real t, Real h, const State& y, const State& y_new, Real theta,
                   State& out) {
    if (starting_) return starter_.interpolate(system, t, h, y, y_new, theta, out);
    // In units of h from the newest value, t for the explicit formula and t + h for the corrector.
    // s counts in steps from the newest value, so it is negative for the corrector.
    const bool explicitly = mode_ == AdamsMode::bashforth;
    const Real s = explicitly ? theta : theta - 1;
    std::array<Real, max_order> g{}, w{};
    const std::span<Real> differences(g.data(), k_), values(w.data(), k_);
    adams::interpolation_weights<Real>(s, distances_, differences);
    adams::weights_of_values<Real>(differences, values);
    add_combination(explicitly ? y : y_new, s * h, std::span<const Real>(values),
                    explicitly ? past() : newest(), out);
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(f_, starter_, time_part_, spacing_, known_, slope_known_, starting_);
  }

 private:
  using Weights = std::array<Real, max_order>;

  /// Weights of the k values from weights of their backward differences; those beyond k stay zero.
  void set_weights(const std::array<long double, max_order>& differences, Weights& out) const {
    std::array<long double, max_order> values{};
    adams::weights_of_values<long double>(std::span(differences).first(k_), std::span(values).first(k_));
    for (std::size_t i = 0; i < k_; ++i) out[i] = static_cast<Real>(values[i]);
  }
  std::span<const Real> weights(const Weights& all) const { return std::span(all).first(k_); }

  /// f_n+1, f_n, ... and f_n, f_n-1, ...
  const State* newest() const { return f_.data(); }
  const State* past() const { return f_.data() + 1; }

  /// Kept out of the loop that steps: it runs k - 1 times at most, and once more at the end.
  template <System Sys>
  [[gnu::noinline]] StepStatus runge_kutta_step(const Sys& system, Real t, const State& y, Real h,
                                                State& y_new) {
    starter_.set_first_stage(f_[1]);
    return starter_.attempt(system, t, y, h, y_new);
  }

  static void move_state(State& from, State& to) {
    if constexpr (is_small_state<State>)
      copy_state(from, to);
    else
      to.swap(from);
  }

  AdamsMode mode_;
  std::size_t k_;
  /// beta_i, beta*_i, and the distances 1, 2, ... of the past values from the newest.
  Weights predictor_{}, corrector_{}, distances_{};
  /// f_n+1 of the attempt, then f_n, f_n-1, ... at distances `spacing_`.
  std::array<State, max_order + 1> f_;
  Rk<tableaux::Dop853, State> starter_;
  TimePart<Real> time_part_;
  Real h_{}, spacing_{};   ///< of the last attempt, and of the past
  std::size_t known_ = 1;  ///< past values at equal distances, f_n among them
  bool slope_known_ = false, starting_ = false;
};

}  // namespace hmax
