/// The one stepper of all Rosenbrock and W-methods: linear equations instead of Newton iterations.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "integrators/implicit/jacobian.hpp"
#include "integrators/implicit/newton.hpp"
#include "integrators/implicit/rosenbrock_tableau.hpp"
#include "integrators/state.hpp"
#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

namespace detail {
/// The rows of a Rosenbrock tableau as types: zero weights vanish, and a stage argument that contains the one
/// before it is made from that.
template <class Method>
struct RosenbrockRows {
  static constexpr const auto& tableau = Method::tableau;
  static constexpr std::size_t s = tableau.stages;

  /// The argument of stage i is y + sum_j weight_j u_j; i = s is the end of the step.
  /// a_ij of an inner stage, m_j at the end.
  static constexpr long double argument_weight(std::size_t i, std::size_t j) {
    return i == s ? tableau.m[j] : tableau.a[i][j];
  }
  template <std::size_t I>
  struct Argument {
    static constexpr std::size_t size = I;
    static constexpr long double weight(std::size_t j) { return argument_weight(I, j); }
  };
  /// The first later stage that stands at the same time as stage i.
  static constexpr std::size_t first_at_node_of(std::size_t i) {
    std::size_t j = 1;
    while (tableau.alpha[j] != tableau.alpha[i]) ++j;
    return j;
  }
  /// Whether the argument of stage i is that of stage i - 1 and one term more, as at the end of stiffly
  /// accurate methods.
  static constexpr bool extends(std::size_t i) {
    if (i < 2) return false;
    for (std::size_t j = 0; j + 1 < i; ++j)
      if (argument_weight(i, j) != argument_weight(i - 1, j)) return false;
    return true;
  }
  /// gamma c_ij: what the stages before add to the right-hand side of stage I.
  template <std::size_t I>
  struct Coupling {
    static constexpr std::size_t size = I;
    static constexpr long double weight(std::size_t j) { return tableau.gamma * tableau.c[I][j]; }
  };
  /// e_i: err = sum_i e_i u_i.
  struct Error {
    static constexpr std::size_t size = s;
    static constexpr long double weight(std::size_t j) { return tableau.e[j]; }
  };
};
}  // namespace detail

/// One step of a Rosenbrock method in the variables of RosenbrockTableau,
///   (I - h gamma J) u_i = h gamma [ f(t + alpha_i h, y + sum_j a_ij u_j) + h d_i df/dt ] + gamma sum_j c_ij
///   u_j, y_new = y + sum_i m_i u_i,
/// with J and df/dt at (t, y). The Jacobian is exact unless set_jacobian_update() says otherwise; one that is
/// older leaves a method the order `w_order` of its tableau and no more.
/// @tparam StateT    Eigen column vector of any real or complex scalar, shape (n)
/// @tparam Jacobian  equations_type of the system
/// @cost   s evaluations of f a step (s - 1 when the last stage is the first of the next, or after a
///         rejection), one of df/dy where it is due and one of df/dt (one more of f where the system does not
///         know it), one factorisation where J or h has changed, s solves; dense: no allocation after init()
/// @source [hairer1996solving] IV.7
template <class Method, class StateT, class Jacobian = jacobian_of<StateT>>
class Rosenbrock {
  using Rows = detail::RosenbrockRows<Method>;
  static constexpr const auto& tableau = Method::tableau;
  static constexpr std::size_t s = tableau.stages;

 public:
  using State = StateT;
  using Real = real_of<State>;
  /// Of y_new with the exact J, and of err = O(h^error_order), 0 without an estimate.
  static constexpr int order = Method::order;
  static constexpr int error_order = Method::error_order;
  static constexpr bool may_estimate_error = error_order > 0;
  static constexpr bool is_explicit = false;

  /// When J is evaluated: automatic, at every step; K, at every K-th accepted step; frozen, at the first
  /// step only.
  void set_jacobian_update(JacobianUpdate update) { update_ = update; }
  /// How symmetric sparse equations are solved.
  void set_linear_solve(LinearSolve choice) { solver_.set(choice); }

  /// Sizes the stages, forgets slopes and Jacobian, sets the counts of work() to zero.
  /// @param y  state of the run, shape (n)
  template <System Sys>
  void init(const Sys& system, Real, const State& y) {
    if constexpr (!is_small_state<State>) {
      for (State& u : u_) u.resize(y.size());
      for (State* v : {&slope_, &stage_slope_, &time_slope_, &argument_}) v->resize(y.size());
    }
    source_.init(system);
    solver_.init(y.size());
    make_room(y.size());
    jacobian_due_ = true;
    slope_known_ = time_slope_known_ = false;
    steps_ = 0;
    work_ = {};
  }

  /// y_new = y + sum_i m_i u_i. May be repeated with another h: f, J and df/dt at (t, y) are evaluated
  /// once.
  /// @returns newton_failed where I - h gamma J is singular or not finite, else ok
  template <System Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    // Known after a first-same-as-last step and after a rejected attempt.
    if (!slope_known_) system.rhs(t, y, slope_);
    slope_known_ = true;
    if (jacobian_due_) {
      source_.evaluate(system, t, y, J_, &slope_);
      ++jacobian_id_;
      jacobian_due_ = false;
    }
    // Of an autonomous system df/dt = 0 is neither evaluated nor added.
    const bool driven = !is_autonomous(system);
    if (driven && !time_slope_known_) evaluate_time_derivative(system, t, h, y, slope_, time_slope_);
    time_slope_known_ = true;
    // One factorisation of I - h gamma J for all stages.
    const Real scale = static_cast<Real>(tableau.gamma) * h;
    if (!solver_.factor(J_, jacobian_id_, static_cast<Scalar>(scale), work_.factorisations))
      return StepStatus::newton_failed;

    [&]<std::size_t... I>(std::index_sequence<I...>) {
      TimeParts<Sys> parts;
      (stage(std::integral_constant<std::size_t, I>{}, system, parts, t, y, h, scale, driven), ...);
    }
    (std::make_index_sequence<s>{});
    make_argument(std::integral_constant<std::size_t, s>{}, y, y_new);
    return StepStatus::ok;
  }

  /// Commits the last attempt. The next attempt evaluates J if its update is due.
  void accept(const State&) {
    if constexpr (is_fsal(tableau))
      std::swap(slope_, stage_slope_);
    else
      slope_known_ = false;
    time_slope_known_ = false;
    ++steps_;
    // automatic means exact here.
    const int every = update_.every == JacobianUpdate::automatic ? 1 : update_.every;
    jacobian_due_ = every != JacobianUpdate::frozen && steps_ % every == 0;
  }

  /// Square of the weighted norm of err = sum_i e_i u_i = y_new - y_hat; at most 1 means good enough.
  /// @param norm  RmsNorm or MatlabNorm, which carry the tolerances
  template <class Norm>
  requires may_estimate_error Real error_squared(Real, const State& y, const State& y_new, const Norm& norm)
  const {
    return norm.squared(y, y_new, [&](Eigen::Index d) {
      return increment_component(typename Rows::Error{}, Real(1), u_, d);
    });
  }

  /// out = y(t + theta h) = y + sum_i u_i sum_j p_ij theta^(j+1), at O(s n) without an evaluation.
  /// @param theta  in [0, 1]
  template <System Sys>
  void interpolate(const Sys&, Real, Real, const State& y, const State&, Real theta, State& out) {
    out.setZero(y.size());
    for (std::size_t i = 0; i < s; ++i) {
      const auto& p = Method::interpolant.p[i];
      Real weight = 0;
      // Horner's scheme: theta (p_i0 + theta (p_i1 + ...)).
      for (std::size_t j = p.size(); j-- > 0;) weight = theta * (weight + static_cast<Real>(p[j]));
      out += weight * u_[i];
    }
    out += y;
  }

  /// Factorisations since init(); there are no Newton iterations.
  [[nodiscard]] const ImplicitWork& work() const { return work_; }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(jacobian_id_, steps_, jacobian_due_, slope_known_, solver_, source_);
    visit_work(visit, work_);
    if (slope_known_) visit(slope_);
    if (!jacobian_due_) visit(J_);
  }
  /// After visit_state() has read it: makes what is not written, masses and factors.
  template <System Sys>
  void resumed(const Sys& system) {
    if (jacobian_due_) return;
    detail::take_mass(system, J_);
    solver_.resumed(J_, jacobian_id_);
  }

  /// Whether a step of unchanged size saves a factorisation.
  [[nodiscard]] bool prefers_equal_steps() const { return update_.every == JacobianUpdate::frozen; }

 private:
  using Scalar = typename State::Scalar;

  /// A dense J is sized here, so that steps do not allocate; other kinds bring their size.
  void make_room(Eigen::Index n) {
    if constexpr (std::is_same_v<Jacobian, jacobian_of<State>>) J_.setZero(n, n);
  }

  /// g(t) at the nodes of an attempt, for systems that split off their dependence on time: once per distinct
  /// node.
  template <class Sys>
  struct TimeParts {};
  template <TimeSplitSystem Sys>
  struct TimeParts<Sys> {
    std::array<decltype(std::declval<const Sys&>().at(Real{})), s> at;
  };

  /// u_I of an attempt, from u_1, ..., u_(I-1):
  ///   (I - h gamma J) u_I = h gamma (f(t + alpha_I h, argument) + h d_I df/dt) + gamma sum_{j < I} c_Ij
  ///   u_j.
  /// @param scale   h gamma
  /// @param driven  f depends on time, so that df/dt is added
  template <std::size_t I, System Sys>
  void stage(std::integral_constant<std::size_t, I> i, const Sys& system, TimeParts<Sys>& parts, Real t,
             const State& y, Real h, Real scale, bool driven) {
    const State* slope = &slope_;
    if constexpr (I > 0) {
      make_argument(i, y, argument_);
      const Real node = t + static_cast<Real>(tableau.alpha[I]) * h;
      if constexpr (TimeSplitSystem<Sys>) {
        constexpr std::size_t first = Rows::first_at_node_of(I);
        if constexpr (first == I) parts.at[I] = system.at(node);
        system.rhs_at(parts.at[first], argument_, stage_slope_);
      } else {
        system.rhs(node, argument_, stage_slope_);
      }
      slope = &stage_slope_;
    }
    constexpr auto d = static_cast<Real>(tableau.d[I]);
    // part + gamma sum_j c_Ij u_j, in one pass.
    const auto set = [&](auto&& part) {
      detail::assign(u_[I], [&](auto access) {
        return detail::fold_weights<typename Rows::template Coupling<I>, Real,
                                    detail::next_weight<typename Rows::template Coupling<I>>(0)>(
            Real(1), [&](std::size_t j) -> decltype(auto) { return access(u_[j]); }, part(access));
      });
    };
    if (d != 0 && driven)
      set([&](auto access) { return scale * access(*slope) + (scale * d * h) * access(time_slope_); });
    else
      set([&](auto access) { return scale * access(*slope); });
    work_.linear_iterations += solver_.solve(u_[I]);
  }

  /// out = the argument of stage I, or the end of the step for I = s. `argument_` holds that of stage I - 1.
  template <std::size_t I>
  void make_argument(std::integral_constant<std::size_t, I>, const State& y, State& out) {
    if constexpr (Rows::extends(I)) {
      constexpr auto last = static_cast<Real>(Rows::argument_weight(I, I - 1));
      if constexpr (last == 0)
        copy_state(argument_, out);
      else
        detail::assign(out, [&](auto access) { return access(argument_) + last * access(u_[I - 1]); });
    } else {
      add_increment(typename Rows::template Argument<I>{}, y, Real(1), u_, out);
    }
  }

  JacobianUpdate update_;
  JacobianSource<State, Jacobian> source_;  ///< where J comes from
  Jacobian J_ = blank_matrix<Jacobian>();
  ShiftedSolver<Jacobian, Scalar> solver_;
  std::array<State, s> u_;                                     ///< u_i, each of shape (n)
  State slope_ = blank_state<State>(), stage_slope_ = slope_;  ///< f at (t, y), and of the last stage
  State time_slope_ = slope_;                                  ///< df/dt at (t, y)
  State argument_ = slope_;                                    ///< of the stage, shape (n)
  /// Number of J_, for the solver to see a new one; accepted steps.
  std::int64_t jacobian_id_ = 0, steps_ = 0;
  ImplicitWork work_;
  /// J is to be evaluated; f and df/dt at the start of the next attempt are known.
  bool jacobian_due_ = true, slope_known_ = false, time_slope_known_ = false;
};

}  // namespace hmax
