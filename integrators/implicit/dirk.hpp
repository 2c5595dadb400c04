/// The one stepper of all diagonally implicit Runge-Kutta methods.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "integrators/explicit/tableau.hpp"
#include "integrators/hermite.hpp"
#include "integrators/implicit/newton.hpp"
#include "integrators/implicit/residual_rounding.hpp"
#include "integrators/slope_at.hpp"
#include "integrators/state.hpp"
#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// One step of a diagonally implicit method with the same gamma in every implicit stage,
///   Y_i = y + h sum_{j<i} a_ij k_j + z_i,   z_i = h gamma k_i,   k_i = f(t + c_i h, Y_i),
/// each solved for z_i by simplified Newton with the matrix I - h gamma J. k_i is z_i / (h gamma) and not f
/// at the computed Y_i, which would multiply the error of Y_i by the stiffness.
/// @tparam Method  a struct of dirk_tableaux.hpp
/// @tparam StateT  Eigen column vector of any real or complex scalar, shape (n)
/// @tparam Matrix  equations_type of the system
/// @cost   one f and one solution an iteration, one factorisation when h or J has changed; no allocation
/// after
///         init() for dense J
/// @source [hairer1996solving] IV.6, IV.8
template <class Method, class StateT, class Matrix = jacobian_of<StateT>>
class Dirk {
  static constexpr const auto& tableau = Method::tableau;
  static constexpr std::size_t s = tableau.stages;
  /// k_1 = f(t, y), the last slope of the step before.
  static constexpr bool explicit_first = tableau.a[0][0] == 0;
  static constexpr bool stiffly_accurate = is_stiffly_accurate(tableau);  ///< y_new is Y_s
  /// No embedded method: C h^3 y''' from three slopes.
  static constexpr bool estimates_from_slopes = requires { Method::third_derivative_error; };
  static constexpr bool has_interpolant = requires { Method::interpolant; };
  /// Some Y_i is a point of the solution.
  static constexpr bool has_inner_stage = requires { Method::inner_stage; };
  static_assert(explicit_first ? stiffly_accurate : true, "an explicit first stage is the last one's slope");

 public:
  using State = StateT;
  using Real = real_of<State>;
  /// Of y_new, and of err = O(h^error_order), 0 without an estimate.
  static constexpr int order = Method::order;
  static constexpr int error_order = Method::error_order;
  static constexpr bool may_estimate_error = error_order > 0;
  static constexpr bool is_explicit = false;

  /// When J is evaluated; automatic: after an accepted step with slow convergence, and after a failure with
  /// an old J.
  void set_jacobian_update(JacobianUpdate update) { jacobian_.set_update(update); }
  /// How symmetric sparse equations are solved.
  void set_linear_solve(LinearSolve choice) { solver_.set(choice); }
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
    visit(k_[0], slopes_, slopes_known_, memory_, old_h_, jacobian_, solver_, rounding_, start_known_);
    visit_work(visit, work_);
    if constexpr (!explicit_first)
      if (start_known_) visit(start_slope_);
    if constexpr (estimates_from_slopes)
      if (old_h_ != 0) visit(old_slope_);
  }
  /// After visit_state() has read it: makes what is not written, masses and factors.
  template <System Sys>
  void resumed(const Sys& system) {
    if (!jacobian_.is_kept()) return;
    jacobian_.resumed(system);
    solver_.resumed(jacobian_.matrix(), jacobian_.id());
  }

  /// Sizes the stages, evaluates nothing, forgets slopes, factors and the rate of convergence.
  /// @param y  state of the run, shape (n)
  template <System Sys>
  void init(const Sys& system, Real, const State& y) {
    const Eigen::Index n = y.size();
    if constexpr (!is_small_state<State>)
      for (State* v : {&base_, &z_, &Y_, &d_, &error_, &start_slope_, &end_slope_, &old_slope_}) v->resize(n);
    for (State& v : k_) v.setZero(n);
    for (State& v : slopes_) v.setZero(n);
    jacobian_.init(system);
    solver_.init(n);
    norm_.init(n);
    rounding_.init(system);
    work_ = {};
    memory_ = {};
    slopes_known_ = 0;
    start_known_ = end_known_ = false;
    old_h_ = 0;
  }

  /// y_new from y at t. May be repeated with another h; what is learned of J and of the rate of convergence
  /// stays with the attempt until accept().
  /// @returns newton_failed where a stage equation is not solved; work().failure then names the reason
  template <System Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    h_ = h;
    end_known_ = false;
    jacobian_.begin(system, t, y);
    norm_.prepare(system, y);
    if constexpr (explicit_first)
      if (!start_known_) {
        system.rhs(t, y, k_[0]);
        start_known_ = true;
      }
    // What the attempt learns of the convergence is kept by accept() alone.
    attempt_memory_ = memory_;
    extrapolates_ = slopes_known_ > 0 && (jacobian_.is_mechanical() || norm_.resolves(y));
    if (!solve(system, t, y, h)) return StepStatus::newton_failed;
    // Y_s = base + z
    if constexpr (stiffly_accurate)
      detail::assign(y_new, [&](auto access) { return access(base_) + access(z_); });
    else
      add_increment(Weights{}, y, h, k_, y_new);
    if constexpr (estimates_from_slopes)
      if (old_h_ == 0) {
        // The first step has no other before it: the slope at its middle serves in its place.
        hermite_step(h, y, y_new, k_[0], k_[s - 1], Real(0.5), Y_);
        system.rhs(t + h / 2, Y_, old_slope_);
      }
    return StepStatus::ok;
  }

  /// Commits the last attempt: the slope at its end, where it is known, is that at the start of the next
  /// step. The slopes of the step extrapolate to the first guess of the next one.
  void accept(const State&) {
    extrapolate_slopes();
    if constexpr (estimates_from_slopes) copy_state(k_[0], old_slope_);
    if constexpr (explicit_first) {
      copy_state(k_[s - 1], k_[0]);
    } else {
      // k_s = f(t + h, y_new) of a stiffly accurate method; else the slope that dense output has evaluated.
      start_known_ = stiffly_accurate || end_known_;
      if (start_known_) copy_state(stiffly_accurate ? k_[s - 1] : end_slope_, start_slope_);
    }
    jacobian_.accept(attempt_memory_.theta);
    memory_ = {attempt_memory_.eta};
    old_h_ = h_;
  }

  /// Square of the weighted norm of (I - h gamma J)^-1 h sum_i b_err_i k_i, or of the third derivative in its
  /// place. Without the inverse the estimate of a stiff component grows with its stiffness while the
  /// component itself is damped. [hosea1996analysis, 4], [hairer1996solving, IV.8 (8.19)]
  /// @param norm  RmsNorm or MatlabNorm, which carry the tolerances
  template <class Norm>
  requires may_estimate_error Real error_squared(Real h, const State& y, const State& y_new, const Norm& norm)
  const {
    if constexpr (estimates_from_slopes) {
      // C h^3 d^3y/dt^3 = 2 C h^3 f[., ., .], by the second divided difference of three slopes.
      const Real C = static_cast<Real>(Method::third_derivative_error);
      const bool first = old_h_ == 0;  // slopes at t, t + h/2, t + h; later at t - h_old, t, t + h
      const State& f0 = first ? k_[0] : old_slope_;
      const State& f1 = first ? old_slope_ : k_[0];
      const Real h1 = first ? h / 2 : old_h_, h2 = first ? h / 2 : h;
      const Real scale = 2 * C * h * h * h / (h1 + h2);
      detail::assign(error_, [&](auto access) {
        return (access(k_[1]) - access(f1)) * (scale / h2) - (access(f1) - access(f0)) * (scale / h1);
      });
    } else {
      // h sum_i b_err_i k_i
      detail::assign(error_, [&](auto access) {
        return detail::weighted_sum<ErrorWeights, Real>(
            h, [&](std::size_t j) -> decltype(auto) { return access(k_[j]); });
      });
    }
    // With the factors of the stages.
    if constexpr (requires { Method::damps_error; }) work_.linear_iterations += solver_.solve(error_);
    return norm.squared(y, y_new, [&](Eigen::Index d) { return error_[d]; });
  }

  /// out = y(t + theta h) by the method's own interpolant, or by cubic Hermite polynomials through both ends
  /// and an inner stage where there is one. Slopes at the ends that no stage knows are evaluated once.
  /// @param theta  in [0, 1]: 0 is y, 1 is y_new
  template <System Sys>
  void interpolate(const Sys& system, Real t, Real h, const State& y, const State& y_new, Real theta,
                   State& out) {
    if constexpr (has_interpolant) {
      out = y;
      for (std::size_t i = 0; i < s; ++i) {
        // y + h sum_i k_i sum_j p_ij theta^(j+1)
        Real weight = 0;
        for (std::size_t j = Method::interpolant.degree; j-- > 0;)
          weight = theta * (static_cast<Real>(Method::interpolant.p[i][j]) + weight);
        out += (h * weight) * k_[i];
      }
    } else if constexpr (has_inner_stage) {
      constexpr std::size_t inner = Method::inner_stage;
      const Real c = static_cast<Real>(tableau.c[inner]);
      stage_argument(FullRow<inner>{}, y, h, k_, Y_);
      if (theta <= c)
        hermite_step(c * h, y, Y_, k_[0], k_[inner], theta / c, out);
      else
        hermite_step((1 - c) * h, Y_, y_new, k_[inner], k_[s - 1], (theta - c) / (1 - c), out);
    } else if constexpr (explicit_first) {
      hermite_step(h, y, y_new, k_[0], k_[s - 1], theta, out);
    } else {
      if (!start_known_) system.rhs(t, y, start_slope_);
      if (!end_known_) system.rhs(t + h, y_new, end_slope_);
      start_known_ = end_known_ = true;
      hermite_step(h, y, y_new, start_slope_, end_slope_, theta, out);
    }
  }

 private:
  /// a_ij, j < I: what the stages before contribute to Y_I.
  template <std::size_t I>
  struct StageRow {
    static constexpr std::size_t size = I;
    static constexpr long double weight(std::size_t j) { return tableau.a[I][j]; }
  };
  /// All of row I, a_II included: Y_I itself.
  template <std::size_t I>
  struct FullRow {
    static constexpr std::size_t size = I + 1;
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

  /// All stages of an attempt, with another Jacobian or by continuation where the first try fails.
  template <System Sys>
  bool solve(const Sys& system, Real t, const State& y, Real h) {
    return solve_or_continue(
        jacobian_, norm_, attempt_memory_, system, t, y, first_mu,
        [&](std::optional<Real> continuation) { return solve_stages(system, t, y, h, continuation); });
  }

  /// The stages in their order, with one factorisation of I - h gamma J.
  /// @param continuation  the first mu of continue_newton, which then replaces iterate_newton
  template <System Sys>
  bool solve_stages(const Sys& system, Real t, const State& y, Real h, std::optional<Real> continuation) {
    if (!continuation && !factor(h * gamma)) return failed(NewtonEnd::singular);
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return (solve_stage<I + explicit_first>(system, t, y, h, continuation) && ...);
    }
    (std::make_index_sequence<s - explicit_first>{});
  }

  /// Factors I - h_gamma J unless the factors at hand are of this h_gamma and J.
  /// @returns false where the matrix is singular or not finite
  bool factor(Real h_gamma) {
    return solver_.factor(jacobian_.matrix(), jacobian_.id(), h_gamma, work_.factorisations);
  }
  /// Notes why a stage was not solved; always false.
  bool failed(NewtonEnd end) {
    work_.failure = to_string(end);
    return false;
  }

  /// Solves h gamma f(t + c_i h, base + z) = z and keeps k_i = z / (h gamma), with base = y + h sum_{j<i}
  /// a_ij k_j.
  /// @returns false where the iteration does not converge
  template <std::size_t I, System Sys>
  bool solve_stage(const Sys& system, Real t, const State& y, Real h, std::optional<Real> continuation) {
    const Real c = static_cast<Real>(tableau.c[I]), h_gamma = h * gamma;
    stage_argument(StageRow<I>{}, y, h, k_, base_);
    // g(t + c_i h) is evaluated once for all iterations.
    const SlopeAt<Sys> slope(system, t + c * h);
    // d = h gamma f(t + c_i h, base + z) - z
    const auto residual = [&] {
      detail::assign(Y_, [&](auto access) { return access(base_) + access(z_); });
      slope(Y_, d_);
      detail::assign(d_, [&](auto access) { return h_gamma * access(d_) - access(z_); });
    };
    // (I - h gamma J) d = residual, z += d. In continuation d = share (I - share h gamma J)^-1 residual.
    const auto correct = [&](Real share) {
      work_.linear_iterations += solver_.solve(d_);
      detail::assign(d_, [&](auto access) { return share * access(d_); });
      detail::assign(z_, [&](auto access) { return access(z_) + access(d_); });
      return norm_.squared(system, d_, Y_);
    };
    const auto rounds = [&](bool estimate) { return rounding(system, h_gamma, estimate); };
    NewtonEnd end;
    if (continuation) {
      // From a state that stands still: what velocities would carry too far is not even looked at.
      detail::assign(z_, [&](auto access) { return access(y) - access(base_); });
      end = continue_newton<Real>(
          *continuation, attempt_memory_, work_.newton,
          [&] {
            residual();
            return norm_.largest(system, d_);
          },
          [&](Real mu) -> std::optional<Real> {
            // ((1 + mu) I - h gamma J) = (1 + mu) (I - h gamma / (1 + mu) J), J at the iterate.
            jacobian_.take(system, t + c * h, Y_);
            if (!factor(h_gamma / (1 + mu))) return std::nullopt;
            return correct(1 / (1 + mu));
          },
          rounds);
    } else {
      predict(c * h, h_gamma);
      end = iterate_newton(
          norm_.iterations(), attempt_memory_, work_.newton,
          [&] {
            residual();
            return correct(1);
          },
          rounds);
    }
    if (end != NewtonEnd::converged) return failed(end);
    // Zero in adaptive runs, see NewtonNorm::relative().
    work_.newton_error = std::max(work_.newton_error, norm_.relative(attempt_memory_.error));
    const Real per_h_gamma = 1 / h_gamma;
    detail::assign(k_[I], [&](auto access) { return access(z_) * per_h_gamma; });
    return true;
  }

  /// The norm of what rounding of f makes of a correction.
  template <System Sys>
  Real rounding(const Sys& system, Real h_gamma, bool estimate) {
    return rounding_(system, estimate, jacobian_.matrix(), jacobian_.id(), h_gamma, Y_, z_, norm_,
                     [&](State& x) { work_.linear_iterations += solver_.solve(x); });
  }

  /// z = h gamma times the slope extrapolated to t + tau; zero as long as no step is behind.
  /// @param tau  c_i h, the distance of the stage from t
  void predict(Real tau, Real h_gamma) {
    if (!extrapolates_) {
      z_.setZero(base_.size());
      // What is known is of better starts.
      if (slopes_known_ > 0) attempt_memory_.eta = NewtonMemory<Real>{}.eta;
      return;
    }
    // A polynomial says little far beyond its points.
    const bool quadratic = slopes_known_ > 2 && std::abs(tau) <= 2 * std::abs(old_h_);
    const Real a = h_gamma, b = h_gamma * tau, c = quadratic ? h_gamma * tau * tau : Real(0);
    detail::assign(z_, [&](auto access) {
      return access(slopes_[0]) * a + access(slopes_[1]) * b + access(slopes_[2]) * c;
    });
  }

  /// slope(t_(n+1) + tau) = slopes_0 + slopes_1 tau + slopes_2 tau^2 from the step that is being accepted.
  void extrapolate_slopes() {
    const Real per_h = 1 / h_;
    // Of steps whose square underflows nothing is known but a line.
    const Real per_h2 = std::isfinite(per_h * per_h) ? per_h * per_h : Real(0);
    if constexpr (!stiffly_accurate) {
      // Mean slopes belong to the middles of steps. slopes_0 + slopes_1 (-h_old / 2) was the last one.
      static_assert(s == 1, "the mean slope of a step is that of its one stage");
      // The last mean slope and the one of this step stand (h + h_old) / 2 apart.
      const Real lag = (h_ + old_h_) / 2;
      const Real b = slopes_known_ > 0 ? 1 / lag : Real(0);
      detail::assign(Y_, [&](auto access) {
        return (access(k_[0]) - (access(slopes_[0]) - access(slopes_[1]) * (old_h_ / 2))) * b;
      });
      // A line through both mean slopes, tau counted from the end of the step.
      copy_state(Y_, slopes_[1]);
      detail::assign(slopes_[0], [&](auto access) { return access(k_[0]) + access(Y_) * (h_ / 2); });
      slopes_known_ = 2;
    } else {
      const State& f0 = explicit_first ? k_[0] : start_slope_;
      const State& f1 = k_[s - 1];
      if (explicit_first || start_known_) {
        // q u^2 + (f1 - f0 + q) u + f1 with u = tau / h in [-1, 0] meets both slopes; q from the third datum.
        // Third datum: the slope of the inner stage, at u = c - 1.
        if constexpr (has_inner_stage) {
          const Real c = static_cast<Real>(tableau.c[Method::inner_stage]), scale = 1 / (c * (c - 1));
          const State& fc = k_[Method::inner_stage];
          detail::assign(slopes_[2], [&](auto access) {
            return (access(fc) - access(f0) - (access(f1) - access(f0)) * c) * scale;
          });
        } else if constexpr (order > 2) {
          // Third datum: the mean slope sum_j b_j k_j, the integral over u, (f0 + f1) / 2 - q / 6.
          detail::assign(slopes_[2], [&](auto access) {
            return Real(3) * (access(f0) + access(f1)) -
                   detail::weighted_sum<Weights, Real>(
                       Real(6), [&](std::size_t j) -> decltype(auto) { return access(k_[j]); });
          });
        }
        // (f1 - f0 + q) / h and q / h^2: from u back to tau.
        detail::assign(slopes_[1],
                       [&](auto access) { return (access(f1) - access(f0) + access(slopes_[2])) * per_h; });
        if constexpr (has_inner_stage || order > 2)
          detail::assign(slopes_[2], [&](auto access) { return access(slopes_[2]) * per_h2; });
        slopes_known_ = has_inner_stage || order > 2 ? 3 : 2;
      } else {
        slopes_known_ = 1;
      }
      copy_state(f1, slopes_[0]);
    }
  }

  /// The diagonal of A, the same for all implicit stages.
  static constexpr Real gamma = static_cast<Real>(Method::gamma);
  /// k_i, each of shape (n).
  std::array<State, s> k_;
  /// Of the stage at hand: base + z = Y, and the residual or correction d.
  State base_ = blank_state<State>(), z_ = blank_state<State>(), Y_ = blank_state<State>(),
        d_ = blank_state<State>();
  /// Valid while start_known_ and end_known_.
  State start_slope_ = blank_state<State>(),
        end_slope_ = blank_state<State>();  // f at the ends, where no stage stands there
  State old_slope_ = blank_state<State>();  ///< f at the start of the step before
  /// err, shape (n).
  mutable State error_ = blank_state<State>();
  /// Coefficients of the extrapolated slope, see extrapolate_slopes().
  std::array<State, 3> slopes_;
  Linearisation<State, Matrix> jacobian_;
  mutable ShiftedSolver<Matrix, typename State::Scalar> solver_;
  NewtonNorm<State> norm_;
  ResidualRounding<State> rounding_;
  /// Of the accepted steps, and as the attempt has changed it.
  NewtonMemory<Real> memory_, attempt_memory_;
  mutable ImplicitWork work_;  ///< error estimates solve equations too
  /// Step sizes of the last attempt and of the accepted step before.
  Real h_ = 0, old_h_ = 0;
  int slopes_known_ = 0;  ///< coefficients of slopes_ that hold: 0 .. 3
  /// extrapolates_: z of an attempt begins with the extrapolated slope, else with zero.
  bool start_known_ = false, end_known_ = false, extrapolates_ = false;
};

}  // namespace hmax
