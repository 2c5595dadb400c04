/// The one stepper of all implicit-explicit Runge-Kutta methods: what a system declares stiff is solved for,
/// the rest is stepped explicitly.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "integrators/hermite.hpp"
#include "integrators/implicit/imex_tableaux.hpp"
#include "integrators/implicit/newton.hpp"
#include "integrators/implicit/residual_rounding.hpp"
#include "integrators/implicit/stiff_part.hpp"
#include "integrators/state.hpp"
#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// One step of an additive Runge-Kutta method,
///   Y_i = y + h sum_{j<i} (aE_ij kE_j + aI_ij kI_j) + z_i,   z_i = h gamma kI_i,
///   kE_i = nonstiff(t + c_i h, Y_i),   kI_i = stiff(t + c_i h, Y_i),
///   y_new = y + h sum_i (bE_i kE_i + bI_i kI_i),
/// each stage solved for z_i by simplified Newton with the matrix I - h gamma J, J the Jacobian of the stiff
/// part. One matrix serves all stages, and all steps while h and J stay. kI_i is z_i / (h gamma) and not the
/// stiff part at the computed Y_i, which would multiply the error of Y_i by the stiffness.
/// @tparam Method  a struct of imex_tableaux.hpp
/// @tparam Matrix  jacobian_type or stiff_equations_type of the system
/// @cost   a step of s stages evaluates the nonstiff part at most s times and the stiff part once and once an
///         iteration, of which one suffices where the system says that the stiff part is linear; no
///         allocation after init() for dense J
/// @source [kennedy2003additive]; the iteration [hairer1996solving] IV.8
template <class Method, class StateT, class Matrix = jacobian_of<StateT>>
class ImexRk {
  static constexpr const auto& tableau = Method::tableau;
  static constexpr std::size_t s = tableau.stages;

 public:
  using State = StateT;
  using Real = real_of<State>;
  /// Of y_new, and of err = O(h^error_order), 0 without an estimate.
  static constexpr int order = Method::order;
  static constexpr int error_order = Method::error_order;
  static constexpr bool may_estimate_error = error_order > 0;
  static constexpr bool is_explicit = false;

  /// When the J of the stiff part is evaluated; automatic: after an accepted step with slow convergence,
  /// and after a failure with an old J.
  void set_jacobian_update(JacobianUpdate update) { jacobian_.set_update(update); }
  /// How symmetric sparse equations are solved.
  void set_linear_solve(LinearSolve choice) {
    solver_.set(choice);
    solves_exactly_ = choice.by != LinearSolve::By::conjugate_gradients;
  }
  /// How exactly equations are solved at fixed steps.
  void set_newton(NewtonSettings settings) { norm_.set(settings); }
  /// For adaptive runs: stages are solved to a share of the error test, see NewtonNorm.
  /// @param atol  a number, or one for each component, shape (n)
  template <class Atol>
  void set_tolerances(Real rtol, const Atol& atol) {
    norm_.set_tolerances(rtol, atol);
  }
  /// Factorisations, Newton iterations and the last failure since init().
  [[nodiscard]] const ImplicitWork& work() const { return work_; }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(nonstiff_[0], stiff_[0], memory_, jacobian_, solver_, rounding_, start_known_);
    visit_work(visit, work_);
  }
  /// After visit_state() has read it: makes what is not written, masses and factors.
  template <SplitSystem Sys>
  void resumed(const Sys& system) {
    if (!jacobian_.is_kept()) return;
    jacobian_.resumed(StiffPart<Sys>(system));
    solver_.resumed(jacobian_.matrix(), jacobian_.id());
  }

  /// Sizes the stages, forgets slopes, factors and the rate of convergence.
  /// @param y  state of the run, shape (n)
  template <SplitSystem Sys>
  void init(const Sys& system, Real, const State& y) {
    const Eigen::Index n = y.size();
    for (std::array<State, s>* slopes : {&nonstiff_, &stiff_})
      for (State& k : *slopes) k.setZero(n);
    if constexpr (!is_small_state<State>)
      for (State* v : {&base_, &z_, &Y_, &d_, &end_nonstiff_, &end_stiff_, &f0_, &f1_}) v->resize(n);
    jacobian_.init(StiffPart<Sys>(system));
    solver_.init(n);
    norm_.init(n);
    rounding_.init(system);
    work_ = {};
    memory_ = {};
    start_known_ = end_known_ = false;
  }

  /// y_new = y + h sum_i (bE_i kE_i + bI_i kI_i). May be repeated with another h: the slopes at (t, y) are
  /// evaluated once, and only those that the tableau uses.
  /// @returns newton_failed where a stage equation is not solved, also with a new Jacobian
  template <SplitSystem Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    end_known_ = false;
    if (!start_known_) {
      if constexpr (uses<NonstiffHalf>(0)) system.rhs_nonstiff(t, y, nonstiff_[0]);
      if constexpr (uses<StiffHalf>(0)) system.rhs_stiff(t, y, stiff_[0]);
      start_known_ = true;
    }
    const StiffPart<Sys> stiff(system);
    jacobian_.begin(stiff, t, y);
    norm_.prepare(system, y);
    // What the attempt learns of the convergence is kept by accept() alone.
    attempt_memory_ = memory_;
    if (!solve_stages(system, t, y, h)) {
      if (!jacobian_.renew(stiff, t, y)) return StepStatus::newton_failed;
      attempt_memory_ = {};
      if (!solve_stages(system, t, y, h)) return StepStatus::newton_failed;
    }
    detail::assign(y_new, [&](auto access) {
      return access(y) + (weighted<typename NonstiffHalf::Weights>(h, access, nonstiff_) +
                          weighted<typename StiffHalf::Weights>(h, access, stiff_));
    });
    return StepStatus::ok;
  }

  /// Commits the last attempt: y_new is the new state. Its slopes are known where dense output has
  /// evaluated them.
  void accept(const State&) {
    jacobian_.accept(attempt_memory_.theta);
    memory_ = {attempt_memory_.eta};
    start_known_ = end_known_;
    // Without dense output the next attempt evaluates both slopes at its start.
    if (!end_known_) return;
    copy_state(end_nonstiff_, nonstiff_[0]);
    copy_state(end_stiff_, stiff_[0]);
  }

  /// Square of the weighted error norm of the last attempt; at most 1 means good enough. For infinitely stiff
  /// components the estimate stays below 0.15 of their size, so that it needs no filter.
  ///   err = h sum_i (bE_err_i kE_i + bI_err_i kI_i)
  /// @param norm  RmsNorm or MatlabNorm, which carry the tolerances
  template <class Norm>
  requires may_estimate_error Real error_squared(Real h, const State& y, const State& y_new, const Norm& norm)
  const {
    return norm.squared(y, y_new, [&](Eigen::Index d) {
      return increment_component(typename NonstiffHalf::ErrorWeights{}, h, nonstiff_, d) +
             increment_component(typename StiffHalf::ErrorWeights{}, h, stiff_, d);
    });
  }

  /// out = y(t + theta h) by the cubic Hermite polynomial through both ends, whose last slope is evaluated
  /// once and serves the next step; by a straight line where the method is of order one.
  /// @param theta  in [0, 1]: 0 is y, 1 is y_new
  template <SplitSystem Sys>
  void interpolate(const Sys& system, Real t, Real h, const State& y, const State& y_new, Real theta,
                   State& out) {
    if constexpr (order == 1) {
      detail::assign(out, [&](auto access) { return access(y) + theta * (access(y_new) - access(y)); });
    } else {
      if (!end_known_) {
        system.rhs_nonstiff(t + h, y_new, end_nonstiff_);
        system.rhs_stiff(t + h, y_new, end_stiff_);
        end_known_ = true;
      }
      detail::assign(f0_, [&](auto access) { return access(nonstiff_[0]) + access(stiff_[0]); });
      detail::assign(f1_, [&](auto access) { return access(end_nonstiff_) + access(end_stiff_); });
      hermite_step(h, y, y_new, f0_, f1_, theta, out);
    }
  }

 private:
  /// The rows of one half of the tableau in the form of state.hpp.
  template <bool Stiff>
  struct Half {
    static constexpr const auto& own = Stiff ? tableau.stiff : tableau.nonstiff;
    /// a_ij, j < I: the diagonal of the stiff half is in z.
    template <std::size_t I>
    struct StageRow {
      static constexpr std::size_t size = I;
      static constexpr long double weight(std::size_t j) { return own.a[I][j]; }
    };
    /// b_i.
    struct Weights {
      static constexpr std::size_t size = s;
      static constexpr long double weight(std::size_t j) { return own.b[j]; }
    };
    /// b_i - b_hat_i.
    struct ErrorWeights {
      static constexpr std::size_t size = s;
      static constexpr long double weight(std::size_t j) { return own.b_err[j]; }
    };
  };
  using NonstiffHalf = Half<false>;
  using StiffHalf = Half<true>;

  /// Whether the slope of stage j appears anywhere outside its own stage equation.
  template <class HalfT>
  static constexpr bool uses(std::size_t j) {
    bool any = HalfT::own.b[j] != 0 || HalfT::own.b_err[j] != 0;
    for (std::size_t i = j + 1; i < s; ++i) any = any || HalfT::own.a[i][j] != 0;
    return any;
  }

  /// h sum_j weight_j k_j as an expression.
  template <class Row, class Access, class Slopes>
  static auto weighted(Real h, const Access& access, const Slopes& k) {
    return detail::weighted_sum<Row, Real>(h, [&](std::size_t j) -> decltype(auto) { return access(k[j]); });
  }

  /// Stages 2 .. s with one factorisation of I - h gamma J; the first stage is explicit, Y_1 = y.
  /// @returns false where the matrix is singular or an iteration does not converge
  template <SplitSystem Sys>
  bool solve_stages(const Sys& system, Real t, const State& y, Real h) {
    if (!solver_.factor(jacobian_.matrix(), jacobian_.id(), h * gamma, work_.factorisations)) return false;
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return (solve_stage<I + 1>(system, t, y, h) && ...);
    }
    (std::make_index_sequence<s - 1>{});
  }

  /// Solves h gamma stiff(t + c_i h, base + z) = z, beginning with the slope of the stage before; then kI_i
  /// and, where a later stage or the result uses it, kE_i.
  template <std::size_t I, SplitSystem Sys>
  bool solve_stage(const Sys& system, Real t, const State& y, Real h) {
    const Real at = t + static_cast<Real>(tableau.stiff.c[I]) * h, h_gamma = h * gamma;
    // base = y + h sum_{j<i} (aE_ij kE_j + aI_ij kI_j)
    stage_argument(typename NonstiffHalf::template StageRow<I>{}, y, h, nonstiff_, base_);
    using StiffRow = typename StiffHalf::template StageRow<I>;
    if constexpr (detail::next_weight<StiffRow>(0) < I)
      detail::assign(base_,
                     [&](auto access) { return access(base_) + weighted<StiffRow>(h, access, stiff_); });
    detail::assign(z_, [&](auto access) { return h_gamma * access(stiff_[I - 1]); });
    // (I - h gamma J) d = h gamma stiff(t + c_i h, base + z) - z, z += d
    const auto correct = [&] {
      detail::assign(Y_, [&](auto access) { return access(base_) + access(z_); });
      system.rhs_stiff(at, Y_, d_);
      detail::assign(d_, [&](auto access) { return h_gamma * access(d_) - access(z_); });
      work_.linear_iterations += solver_.solve(d_);
      detail::assign(z_, [&](auto access) { return access(z_) + access(d_); });
    };
    // One correction solves linear equations but for the error of the linear solver, which only truncated
    // conjugate gradients leave; a failure shows in numbers that are not finite.
    if (solves_exactly_ && has_linear_stiff_part(system)) {
      correct();
      ++work_.newton;
      if (!is_bounded(z_)) return false;
    } else {
      const NewtonEnd end = iterate_newton(
          norm_.iterations(), attempt_memory_, work_.newton,
          [&] {
            correct();
            return norm_.squared(system, d_, Y_);
          },
          [&](bool estimate) { return rounding(system, h_gamma, estimate); });
      if (end != NewtonEnd::converged) {
        work_.failure = to_string(end);
        return false;
      }
      // Zero in adaptive runs, see NewtonNorm::relative().
      work_.newton_error = std::max(work_.newton_error, norm_.relative(attempt_memory_.error));
    }
    const Real per_h_gamma = 1 / h_gamma;
    detail::assign(stiff_[I], [&](auto access) { return access(z_) * per_h_gamma; });
    if constexpr (uses<NonstiffHalf>(I)) {
      detail::assign(Y_, [&](auto access) { return access(base_) + access(z_); });
      system.rhs_nonstiff(at, Y_, nonstiff_[I]);
    }
    return true;
  }

  /// The norm of what rounding of f makes of a correction.
  template <System Sys>
  Real rounding(const Sys& system, Real h_gamma, bool estimate) {
    return rounding_(system, estimate, jacobian_.matrix(), jacobian_.id(), h_gamma, Y_, z_, norm_,
                     [&](State& x) { work_.linear_iterations += solver_.solve(x); });
  }

  /// The diagonal of the implicit half; the same in all stages but the explicit first one.
  static constexpr Real gamma = static_cast<Real>(tableau.stiff.a[s - 1][s - 1]);
  std::array<State, s> nonstiff_, stiff_;  ///< kE_i, kI_i
  /// Of the stage at hand: base + z = Y, and the residual or correction d.
  State base_ = blank_state<State>(), z_ = base_, Y_ = base_, d_ = base_;
  State end_nonstiff_ = base_, end_stiff_ = base_;  ///< at y_new, for the Hermite polynomial
  State f0_ = base_, f1_ = base_;                   ///< nonstiff + stiff, at both ends of the step
  Linearisation<State, Matrix> jacobian_;
  ShiftedSolver<Matrix, typename State::Scalar> solver_;
  NewtonNorm<State> norm_;
  ResidualRounding<State> rounding_;
  /// Of the accepted steps, and as the attempt has changed it.
  NewtonMemory<Real> memory_, attempt_memory_;
  ImplicitWork work_;
  bool solves_exactly_ = true;
  /// Whether the slopes at the start, and at the end of the last attempt, are known.
  bool start_known_ = false, end_known_ = false;
};

}  // namespace hmax
