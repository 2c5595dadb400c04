/// The one stepper of all explicit Runge-Kutta methods, fed by tableaux known at compile time or read at run
/// time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

#include "core/instructions/device_code.hpp"
#include "integrators/error_norm.hpp"
#include "integrators/explicit/own_tableau.hpp"
#include "integrators/explicit/runtime_tableau.hpp"
#include "integrators/explicit/tableau.hpp"
#include "integrators/state.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// The coefficients of a constexpr method in the form the stepper asks for: every index is a type, so that
/// each stage compiles to its own straight line without loops, tests or zero weights.
template <class Method>
class StaticCoefficients {
  static_assert(CheckedTableau<Method>::value);
  static constexpr const auto& tableau = Method::tableau;
  static constexpr std::size_t s = tableau.stages;

 public:
  static constexpr int order = Method::order;              ///< of the propagated weights b
  static constexpr int error_order = Method::error_order;  ///< err = O(h^error_order); 0 without an estimate
  static constexpr bool has_error = has_error_estimate(tableau);          ///< some b_err_i is not zero
  static constexpr bool has_low_error = requires { Method::b_err_low; };  ///< two error rows, as of DOP853
  static constexpr bool fsal = is_fsal(tableau);  ///< a_sj = b_j, c_s = 1: k_s is f(t + h, y_new)
  static constexpr bool has_interpolant = requires { Method::interpolant; };  ///< else cubic Hermite output
  /// Stages that only continuous output needs. They are evaluated when it is called.
  static constexpr std::size_t extra_stages = [] {
    if constexpr (has_interpolant)
      return Method::interpolant.extra;
    else
      return 0;
  }();
  /// D of the continuous output y(t + theta h) = y + h sum_{j < D} q_j theta^(j+1).
  static constexpr std::size_t interpolant_degree = [] {
    if constexpr (has_interpolant)
      return Method::interpolant.degree;
    else
      return 3;  // cubic Hermite
  }();

  /// The slopes k_i: those of the method, then those of the interpolant.
  template <class T>
  using Storage = std::array<T, s + extra_stages>;

  /// Row I of A: the weights of k_0, ..., k_{I-1} in the argument of stage I, stages counted from 0.
  template <std::size_t I>
  struct StageRow {
    static constexpr std::size_t size = I;
    static constexpr long double weight(std::size_t j) { return tableau.a[I][j]; }
  };
  /// b of y_new = y + h sum_i b_i k_i.
  struct Weights {
    static constexpr std::size_t size = s;
    static constexpr long double weight(std::size_t j) { return tableau.b[j]; }
  };
  /// b - b_hat of err = h sum_i b_err_i k_i.
  struct ErrorWeights {
    static constexpr std::size_t size = s;
    static constexpr long double weight(std::size_t j) { return tableau.b_err[j]; }
  };
  /// The second error row, for methods that compute one estimate from two.
  struct LowErrorWeights {
    static constexpr std::size_t size = s;
    static constexpr long double weight(std::size_t j) { return Method::b_err_low[j]; }
  };
  /// Row E of the extra stages: k_{s+E} = f(t + c_E h, y + h sum_j a_Ej k_j).
  template <std::size_t E>
  struct ExtraRow {
    static constexpr std::size_t size = s + E;
    static constexpr long double weight(std::size_t j) { return Method::interpolant.a[E][j]; }
  };
  /// The coefficients p_ij of one power j: q_j = sum_i p_ij k_i.
  template <std::size_t Power>
  struct InterpolantColumn {
    static constexpr std::size_t size = s + extra_stages;
    static constexpr long double weight(std::size_t i) { return Method::interpolant.p[i][Power]; }
  };

  static constexpr std::size_t stages() { return s; }  ///< s, without the extra ones
  template <std::size_t I>
  static constexpr auto stage_row(std::integral_constant<std::size_t, I>) {
    return StageRow<I>{};
  }
  /// The rows as values, as RuntimeTableau returns spans.
  static constexpr auto weights() { return Weights{}; }
  static constexpr auto error_weights() { return ErrorWeights{}; }
  static constexpr long double node(std::size_t i) { return tableau.c[i]; }  ///< c_i
  /// The first later stage that stands at the same time as stage i; i itself when there is none.
  static constexpr std::size_t first_at_node_of(std::size_t i) {
    std::size_t j = 1;
    while (tableau.c[j] != tableau.c[i]) ++j;
    return j;
  }
  /// The first later stage at the end of the step, c = 1; the number of stages when there is none.
  static constexpr std::size_t first_at_end() {
    std::size_t j = 1;
    while (j < s && tableau.c[j] != 1) ++j;
    return j;
  }
  static constexpr long double extra_node(std::size_t e) { return Method::interpolant.c[e]; }  ///< c_{s+e}

  /// Calls f for the stages 1 .. s-1; the index is an integral_constant.
  template <class F>
  HMAX_DEVICE static void for_each_later_stage(F&& f) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (f(std::integral_constant<std::size_t, I + 1>{}), ...);
    }
    (std::make_index_sequence<s - 1>{});
  }
};

/// The square of |e5|^2 / sqrt(|e5|^2 + 0.01 |e3|^2), of two estimates e5 and e3 of one error
/// [hairer1993solving, II.10], from their squares.
template <class Real>
Real combined_error_squared(Real e5, Real e3) {
  const Real denominator = e5 + Real(0.01) * e3;
  return denominator == 0 ? Real{0} : e5 * e5 / denominator;
}

/// One step of an explicit Runge-Kutta method,
///   k_i = f(t + c_i h, y + h sum_j a_ij k_j),    y_new = y + h sum_i b_i k_i.
/// @tparam Coefficients  StaticCoefficients<Method>, or RuntimeTableau for a user's file
/// @tparam StateT        Eigen column vector of any real or complex scalar, shape (n)
/// @cost   s evaluations of f a step, s - 1 when the last stage is the first of the next (FSAL) or after a
/// rejection;
///         no allocation after init()
/// @source [hairer1993solving] II.1 formulas, II.4 error estimate and step control, II.6 continuous output
template <class Coefficients, class StateT>
class ExplicitRk {
 public:
  using State = StateT;
  using Real = real_of<State>;
  static constexpr int order = Coefficients::order;
  static constexpr int error_order = Coefficients::error_order;
  /// Whether attempts carry an error estimate: a tableau of order 0 says so only at run time.
  static constexpr bool may_estimate_error = order == 0 || error_order > 0;
  static constexpr bool is_explicit = true;

  /// Without coefficients of its own, for methods that are known at compile time.
  ExplicitRk() = default;
  /// @throws std::invalid_argument  where the coefficients of a RuntimeTableau do not keep what it says of
  /// them
  explicit ExplicitRk(Coefficients coefficients) : coefficients_(std::move(coefficients)) {
    if constexpr (requires { require_kept(coefficients_); }) require_kept(coefficients_);
  }

  /// Sizes the stages and forgets what was known of an earlier run. The only call that allocates.
  /// @param y  state of the run, shape (n); its values are not read
  template <System Sys>
  void init(const Sys& system, Real, const State& y) {
    // Tableaux that are read at run time keep their slopes in a vector.
    if constexpr (requires { k_.resize(coefficients_.stages()); }) k_.resize(coefficients_.stages());
    if constexpr (!is_small_state<State>) {
      for (State& k : k_) k.resize(system.dim());
      for (State& q : q_) q.resize(system.dim());
      stage_.resize(y.size());
      end_slope_.resize(y.size());
    }
    // NaN equals no time, so g is evaluated at the start.
    end_time_ = std::numeric_limits<Real>::quiet_NaN();
    first_stage_known_ = end_slope_known_ = polynomial_known_ = false;
  }

  /// y_new = y + h sum_i b_i k_i. May be repeated with another h: k_1 = f(t, y) is evaluated once.
  /// @param h      step size, h < 0 backwards
  /// @param y_new  the candidate, shape (n), must not be y
  /// @returns      always ok: an explicit method solves no equations
  template <System Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    // Known to the compiler, or read at run time.
    const bool fsal = coefficients_.fsal;
    if (!first_stage_known_) evaluate_first(system, t, y);
    first_stage_known_ = true;
    end_slope_known_ = polynomial_known_ = false;
    // g(t + c_i h) of all stages first, see StageTimes.
    const StageTimes<Sys> times(system, t, h);
    if constexpr (keeps_end_part<Sys>) {
      end_time_ = t + h;
      end_part_ = times.at[Coefficients::first_at_end()];
    }
    coefficients_.for_each_later_stage([&](auto i) {
      if (fsal && i + 1 == coefficients_.stages()) {
        // The last row of A is b, so the argument of k_s is y_new.
        add_increment(coefficients_.weights(), y, h, k_, y_new);
        evaluate(system, times, i, t, h, y_new);
      } else {
        stage_argument(coefficients_.stage_row(i), y, h, k_, stage_);
        evaluate(system, times, i, t, h, stage_);
      }
    });
    if (!fsal) add_increment(coefficients_.weights(), y, h, k_, y_new);
    return StepStatus::ok;
  }

  /// Commits the last attempt: y_new is the new state. k_1 of the next step is k_s where the method is
  /// first-same-as-last, and f(t + h, y_new) where dense output has evaluated it. Otherwise the next attempt
  /// evaluates it.
  void accept(const State&) {
    if (coefficients_.fsal)
      move_state(k_[coefficients_.stages() - 1], k_[0]);
    else if (end_slope_known_)
      move_state(end_slope_, k_[0]);
    else
      first_stage_known_ = false;
  }

  /// The first stage f(t, y) of the next attempt, for methods that start from this one and keep slopes of
  /// their own: known after accept() if the last stage is the first of the next step.
  [[nodiscard]] const State& first_stage() const { return k_[0]; }
  /// Gives f(t, y) of the next attempt, shape (n), from where it is known.
  void set_first_stage(const State& slope) {
    copy_state(slope, k_[0]);
    first_stage_known_ = true;
  }

  /// Square of the weighted error norm of the last attempt; at most 1 means good enough.
  /// With two error rows (DOP853) that of both estimates.
  /// @param norm  carries the tolerances: RmsNorm or MatlabNorm
  template <class Norm>
  requires may_estimate_error Real error_squared(Real h, const State& y, const State& y_new, const Norm& norm)
  const {
    const Real e = weighted_square(coefficients_.error_weights(), h, y, y_new, norm);
    if constexpr (has_low_error()) {
      return combined_error_squared(
          e, weighted_square(typename Coefficients::LowErrorWeights{}, h, y, y_new, norm));
    }
    return e;
  }

  /// out = y(t + theta h) by the method's own interpolant, or by the cubic Hermite polynomial through both
  /// ends. Costs nothing unless called; the polynomial is made once a step and further points cost O(degree
  /// n).
  /// @param theta  in [0, 1]: 0 is y, 1 is y_new
  /// @cost  the extra stages at the first call of a step, or f(t + h, y_new) for the Hermite polynomial of a
  ///        method without FSAL
  template <System Sys>
  void interpolate(const Sys& system, Real t, Real h, const State& y, const State& y_new, Real theta,
                   State& out) {
    if (!polynomial_known_) make_polynomial(system, t, h, y, y_new);
    const Real scale = h * theta;
    if constexpr (is_small_state<State>) {
      // Horner's scheme in theta.
      for_each_component<State>([&](Eigen::Index d) {
        typename State::Scalar sum = q_.back()[d];
        for (std::size_t j = q_.size() - 1; j-- > 0;) sum = q_[j][d] + theta * sum;
        out[d] = y[d] + scale * sum;
      });
    } else {
      out = q_.back();
      for (std::size_t j = q_.size() - 1; j-- > 0;) out = q_[j] + theta * out;
      out = y + scale * out;
    }
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(end_time_, end_part_, first_stage_known_);
    if (first_stage_known_) visit(k_[0]);
  }

 private:
  /// g(t) at the nodes of one attempt, for systems that split off their dependence on time: once per distinct
  /// node, and before any stage. Nothing in g waits for the state, so the processor begins while the step
  /// before is still being computed, and no call between the stages makes it save what it holds in registers.
  template <class Sys>
  struct StageTimes {
    StageTimes(const Sys&, Real, Real) {}
  };
  template <TimeSplitSystem Sys>
  requires requires { Coefficients::first_at_node_of(1); }
  struct StageTimes<Sys> {
    StageTimes(const Sys& system, Real t, Real h) {
      Coefficients::for_each_later_stage([&](auto i) {
        if constexpr (Coefficients::first_at_node_of(i) == i)
          at[i] = system.at(t + static_cast<Real>(Coefficients::node(i)) * h);
      });
    }
    std::array<decltype(std::declval<const Sys&>().at(Real{})), Coefficients::stages()> at;
  };

  /// Whether g at the end of a step is kept for the first stage of the next: there is a stage at c = 1, the
  /// method is not FSAL, which needs no g there, and g is one number.
  template <class Sys>
  static constexpr bool keeps_end_part = [] {
    if constexpr (requires(const StageTimes<Sys>& times) { times.at; })
      return !Coefficients::fsal && Coefficients::first_at_end() < Coefficients::stages() &&
             std::is_same_v<typename decltype(StageTimes<Sys>::at)::value_type, Real>;
    else
      return false;
  }();

  /// k_0 = f(t, y). Fixed steps compute t as t0 + n h, which may differ in rounding from the end t + h of the
  /// step before; both round the same time, so one g serves both.
  template <System Sys>
  void evaluate_first(const Sys& system, Real t, const State& y) {
    if constexpr (keeps_end_part<Sys>) {
      if (!(std::abs(t - end_time_) <= 4 * std::numeric_limits<Real>::epsilon() * std::abs(t))) [[unlikely]]
        end_part_ = system.at(t);
      system.rhs_at(end_part_, y, k_[0]);
    } else {
      system.rhs(t, y, k_[0]);
    }
  }

  /// k_i = f(t + c_i h, argument).
  template <System Sys, class Index>
  void evaluate(const Sys& system, const StageTimes<Sys>& times, Index i, Real t, Real h,
                const State& argument) {
    if constexpr (requires { times.at; })
      system.rhs_at(times.at[Coefficients::first_at_node_of(i)], argument, k_[i]);
    else
      system.rhs(t + static_cast<Real>(coefficients_.node(i)) * h, argument, k_[i]);
  }

  /// Whether the coefficients have two error rows; those read at run time have one.
  static constexpr bool has_low_error() {
    if constexpr (requires { Coefficients::has_low_error; })
      return Coefficients::has_low_error;
    else
      return false;
  }
  /// Whether the method has continuous output of its own; those read at run time have cubic Hermite output.
  static constexpr bool has_interpolant() {
    if constexpr (requires { Coefficients::has_interpolant; })
      return Coefficients::has_interpolant;
    else
      return false;
  }

  /// Small states are copied; states on the heap exchange their memory.
  static void move_state(State& from, State& to) {
    if constexpr (is_small_state<State>)
      copy_state(from, to);
    else
      to.swap(from);
  }

  /// Square of the norm of h sum_i row_i k_i.
  template <class Row, class Norm>
  Real weighted_square(Row row, Real h, const State& y, const State& y_new, const Norm& norm) const {
    return norm.squared(y, y_new, [&](Eigen::Index d) { return increment_component(row, h, k_, d); });
  }

  /// q_j with y(t + theta h) = y + h sum_j q_j theta^(j+1).
  template <System Sys>
  void make_polynomial(const Sys& system, Real t, Real h, const State& y, const State& y_new) {
    if constexpr (has_interpolant()) {
      constexpr std::size_t s = Coefficients::stages();
      [&]<std::size_t... E>(std::index_sequence<E...>) {
        // k_{s+e}, in their order: each row may contain the extra stages before it.
        ((stage_argument(typename Coefficients::template ExtraRow<E>{}, y, h, k_, stage_),
          system.rhs(t + static_cast<Real>(Coefficients::extra_node(E)) * h, stage_, k_[s + E])),
         ...);
      }
      (std::make_index_sequence<Coefficients::extra_stages>{});
      [&]<std::size_t... J>(std::index_sequence<J...>) {
        (set_weighted(typename Coefficients::template InterpolantColumn<J>{}, q_[J]), ...);
      }
      (std::make_index_sequence<Coefficients::interpolant_degree>{});
    } else {
      if (!coefficients_.fsal && !end_slope_known_) {
        system.rhs(t + h, y_new, end_slope_);
        end_slope_known_ = true;
      }
      // Cubic Hermite: q_0 + q_1 + q_2 = (y_new - y) / h, slopes q_0 = f0 and q_0 + 2 q_1 + 3 q_2 = f1.
      const State& f0 = k_[0];
      const State& f1 = coefficients_.fsal ? k_[coefficients_.stages() - 1] : end_slope_;
      q_[0] = f0;
      q_[1] = (y_new - y) * (3 / h) - 2 * f0 - f1;
      q_[2] = f0 + f1 - (y_new - y) * (2 / h);
    }
    polynomial_known_ = true;
  }

  /// out = sum_i weight_i k_i.
  template <StaticRow Row>
  void set_weighted(Row row, State& out) const {
    for (Eigen::Index d = 0; d < out.size(); ++d) out[d] = increment_component(row, Real{1}, k_, d);
  }

  [[no_unique_address]] Coefficients coefficients_;
  /// k_i, each of shape (n).
  typename Coefficients::template Storage<State> k_;
  State stage_ = blank_state<State>();  ///< argument of the stage in the making
  /// Valid while end_slope_known_.
  State end_slope_ =
      blank_state<State>();  // f at the new point, for the Hermite polynomial of methods without FSAL
  /// q_j, each of shape (n), valid while polynomial_known_.
  std::array<State, Coefficients::interpolant_degree> q_;
  Real end_time_{}, end_part_{};  ///< t + h and g(t + h) of the last attempt
  /// k_1 of the next attempt, f at the end of the last attempt and its polynomial are valid.
  bool first_stage_known_ = false, end_slope_known_ = false, polynomial_known_ = false;
};

/// The stepper of a constexpr method: Rk<tableaux::Rk4, Eigen::Vector2d>.
template <class Method, class State>
using Rk = ExplicitRk<StaticCoefficients<Method>, State>;

}  // namespace hmax
