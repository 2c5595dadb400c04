/// The one stepper of all explicit Runge-Kutta methods, fed by tableaux known at compile time or read at run
/// time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "integrators/error_norm.hpp"
#include "integrators/explicit/runtime_tableau.hpp"
#include "integrators/explicit/tableau.hpp"
#include "integrators/state.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// The coefficients of a constexpr method in the form the stepper asks for: every index is a type, so that
/// each stage compiles to its own straight line without loops, tests or zero weights.
template <class Method>
class StaticCoefficients {
  static constexpr const auto& tableau = Method::tableau;
  static constexpr std::size_t s = tableau.stages;

 public:
  static constexpr int order = Method::order;
  static constexpr int error_order = Method::error_order;
  static constexpr bool has_error = has_error_estimate(tableau);
  static constexpr bool has_low_error = requires { Method::b_err_low; };
  static constexpr bool fsal = is_fsal(tableau);
  static constexpr bool has_interpolant = requires { Method::interpolant; };
  static constexpr std::size_t extra_stages = [] {
    if constexpr (has_interpolant)
      return Method::interpolant.extra;
    else
      return 0;
  }();
  static constexpr std::size_t interpolant_degree = [] {
    if constexpr (has_interpolant)
      return Method::interpolant.degree;
    else
      return 3;  // cubic Hermite
  }();

  template <class T>
  using Storage = std::array<T, s + extra_stages>;

  template <std::size_t I>
  struct StageRow {
    static constexpr std::size_t size = I;
    static constexpr long double weight(std::size_t j) { return tableau.a[I][j]; }
  };
  struct Weights {
    static constexpr std::size_t size = s;
    static constexpr long double weight(std::size_t j) { return tableau.b[j]; }
  };
  struct ErrorWeights {
    static constexpr std::size_t size = s;
    static constexpr long double weight(std::size_t j) { return tableau.b_err[j]; }
  };
  struct LowErrorWeights {
    static constexpr std::size_t size = s;
    static constexpr long double weight(std::size_t j) { return Method::b_err_low[j]; }
  };
  template <std::size_t E>
  struct ExtraRow {
    static constexpr std::size_t size = s + E;
    static constexpr long double weight(std::size_t j) { return Method::interpolant.a[E][j]; }
  };
  template <std::size_t Power>
  struct InterpolantColumn {
    static constexpr std::size_t size = s + extra_stages;
    static constexpr long double weight(std::size_t i) { return Method::interpolant.p[i][Power]; }
  };

  static constexpr std::size_t stages() { return s; }
  template <std::size_t I>
  static constexpr auto stage_row(std::integral_constant<std::size_t, I>) {
    return StageRow<I>{};
  }
  static constexpr auto weights() { return Weights{}; }
  static constexpr auto error_weights() { return ErrorWeights{}; }
  static constexpr long double node(std::size_t i) { return tableau.c[i]; }
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
  static constexpr long double extra_node(std::size_t e) { return Method::interpolant.c[e]; }

  /// Calls f for the stages 1 .. s-1; the index is an integral_constant.
  template <class F>
  static void for_each_later_stage(F&& f) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (f(std::integral_constant<std::size_t, I + 1>{}), ...);
    }
    (std::make_index_sequence<s - 1>{});
  }
};

/// One step of an explicit Runge-Kutta method,
///   k_i = f(t + c_i h, y + h sum_j a_ij k_j),    y_new = y + h sum_i b_i k_i.
/// @tparam Coefficients  StaticCoefficients<Method>, or RuntimeTableau for a user's file
/// @tparam StateT        Eigen column vector of any real or complex scalar, shape (n)
/// @cost   s evaluations of f a step, s - 1 when the last stage is the first of the next (FSAL) or after a
/// rejection;
///         no allocation after init()
/// @source [hairer1993solving] II.1, II.4; continuous output II.6
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

  ExplicitRk() = default;
  explicit ExplicitRk(Coefficients coefficients) : coefficients_(std::move(coefficients)) {}

  /// Sizes the stages and forgets what was known of an earlier run.
  template <System Sys>
  void init(const Sys& system, Real, const State& y) {
    if constexpr (requires { k_.resize(coefficients_.stages()); }) k_.resize(coefficients_.stages());
    if constexpr (!is_small_state<State>) {
      for (State& k : k_) k.resize(system.dim());
      for (State& q : q_) q.resize(system.dim());
      stage_.resize(y.size());
      end_slope_.resize(y.size());
    }
    end_time_ = std::numeric_limits<Real>::quiet_NaN();
    first_stage_known_ = end_slope_known_ = polynomial_known_ = false;
  }

  template <System Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    const bool fsal = coefficients_.fsal;
    if (!first_stage_known_) evaluate_first(system, t, y);
    first_stage_known_ = true;
    end_slope_known_ = polynomial_known_ = false;
    const StageTimes<Sys> times(system, t, h);
    if constexpr (keeps_end_part<Sys>) {
      end_time_ = t + h;
      end_part_ = times.at[Coefficients::first_at_end()];
    }
    coefficients_.for_each_later_stage([&](auto i) {
      if (fsal && i + 1 == coefficients_.stages()) {
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

  /// Commits the last attempt: y_new is the new state.
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
  void set_first_stage(const State& slope) {
    copy_state(slope, k_[0]);
    first_stage_known_ = true;
  }

  /// Square of the weighted error norm of the last attempt; at most 1 means good enough.
  /// With two error rows (DOP853) the estimates e5 and e3 are combined as |e5|^2 / sqrt(|e5|^2 + 0.01 |e3|^2)
  /// [hairer1993solving, II.10].
  template <class Norm>
  requires may_estimate_error Real error_squared(Real h, const State& y, const State& y_new, const Norm& norm)
  const {
    const Real e = weighted_square(coefficients_.error_weights(), h, y, y_new, norm);
    if constexpr (has_low_error()) {
      const Real e_low = weighted_square(typename Coefficients::LowErrorWeights{}, h, y, y_new, norm);
      const Real denominator = e + Real(0.01) * e_low;
      return denominator == 0 ? Real{0} : e * e / denominator;
    }
    return e;
  }

  /// out = y(t + theta h) by the method's own interpolant, or by the cubic Hermite polynomial through both
  /// ends. Costs nothing unless called; the polynomial is made once a step and further points cost O(degree
  /// n).
  template <System Sys>
  void interpolate(const Sys& system, Real t, Real h, const State& y, const State& y_new, Real theta,
                   State& out) {
    if (!polynomial_known_) make_polynomial(system, t, h, y, y_new);
    const Real scale = h * theta;
    if constexpr (is_small_state<State>) {
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

  static constexpr bool has_low_error() {
    if constexpr (requires { Coefficients::has_low_error; })
      return Coefficients::has_low_error;
    else
      return false;
  }
  static constexpr bool has_interpolant() {
    if constexpr (requires { Coefficients::has_interpolant; })
      return Coefficients::has_interpolant;
    else
      return false;
  }

  static void move_state(State& from, State& to) {
    if constexpr (is_small_state<State>)
      copy_state(from, to);
    else
      to.swap(from);
  }

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
      const State& f0 = k_[0];
      const State& f1 = coefficients_.fsal ? k_[coefficients_.stages() - 1] : end_slope_;
      q_[0] = f0;
      q_[1] = (y_new - y) * (3 / h) - 2 * f0 - f1;
      q_[2] = f0 + f1 - (y_new - y) * (2 / h);
    }
    polynomial_known_ = true;
  }

  template <StaticRow Row>
  void set_weighted(Row row, State& out) const {
    for (Eigen::Index d = 0; d < out.size(); ++d) out[d] = increment_component(row, Real{1}, k_, d);
  }

  [[no_unique_address]] Coefficients coefficients_;
  typename Coefficients::template Storage<State> k_;
  State stage_ = blank_state<State>();  // argument of the stage in the making
  State end_slope_ =
      blank_state<State>();  // f at the new point, for the Hermite polynomial of methods without FSAL
  std::array<State, Coefficients::interpolant_degree> q_;
  Real end_time_{}, end_part_{};  // t + h and g(t + h) of the last attempt
  bool first_stage_known_ = false, end_slope_known_ = false, polynomial_known_ = false;
};

/// The stepper of a constexpr method: Rk<tableaux::Rk4, Eigen::Vector2d>.
template <class Method, class State>
using Rk = ExplicitRk<StaticCoefficients<Method>, State>;

}  // namespace hmax
