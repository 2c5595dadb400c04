/// Radau IIA of order 5: the collocation method for tight stiff work.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "integrators/implicit/anderson.hpp"
#include "integrators/implicit/newton.hpp"
#include "integrators/implicit/radau_coefficients.hpp"
#include "integrators/implicit/residual_rounding.hpp"
#include "integrators/slope_at.hpp"
#include "integrators/state.hpp"
#include "integrators/stats.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// One step of the three-stage Radau IIA method,
///   z_i = h sum_j a_ij f(t + c_j h, y + z_j),    y_new = y + z_3.
/// In w = T^-1 z each simplified Newton iteration solves one real and one complex equation of dimension n,
///   (I - h/gamma J) dw_1 = h/gamma g_1 - w_1,
///   (I - h/(alpha + i beta) J)(dw_2 + i dw_3) = h/(alpha + i beta) (g_2 + i g_3) - (w_2 + i w_3),   g = T^-1
///   f(z).
/// @tparam StateT  Eigen column vector of a real scalar, shape (n)
/// @tparam Matrix  equations_type of the system
/// @cost   three f and both solutions an iteration, two factorisations when h or J has changed; no allocation
///         after init() for dense J
/// @source [hairer1996solving] IV.5 method, IV.8 transformation, starting values, error estimate
template <class StateT, class Matrix = jacobian_of<StateT>>
class RadauIIA5 {
 public:
  using State = StateT;
  using Real = real_of<State>;
  using Complex = std::complex<Real>;
  static_assert(std::is_same_v<typename State::Scalar, Real>,
                "the complex equation stands for two real ones");
  static constexpr int order = 5;        ///< of y_new at the end of a step
  static constexpr int error_order = 4;  ///< err = O(h^4), of the embedded result of order 3
  static constexpr bool may_estimate_error = true;
  static constexpr bool is_explicit = false;

  /// When J is evaluated; automatic: after an accepted step with slow convergence, and after a failure with
  /// an old J.
  void set_jacobian_update(JacobianUpdate update) { jacobian_.set_update(update); }
  /// How symmetric sparse equations are solved.
  void set_linear_solve(LinearSolve choice) { real_.set(choice); }
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
    visit(old_polynomial_, slope_, slope_known_, memory_, old_h_, jacobian_, real_, complex_, rounding_);
    visit_work(visit, work_);
  }
  /// After visit_state() has read it: makes what is not written, masses and factors.
  template <System Sys>
  void resumed(const Sys& system) {
    if (!jacobian_.is_kept()) return;
    jacobian_.resumed(system);
    real_.resumed(jacobian_.matrix(), jacobian_.id());
    complex_.resumed(jacobian_.matrix(), jacobian_.id());
  }

  /// Sizes all vectors, forgets slopes, factors and the rate of convergence.
  /// @param y  state of the run, shape (n)
  template <System Sys>
  void init(const Sys& system, Real, const State& y) {
    const Eigen::Index n = y.size();
    for (auto* vectors : {&z_, &w_, &f_, &Y_, &polynomial_, &old_polynomial_})
      for (State& v : *vectors) v.setZero(n);
    slope_.setZero(n);
    error_.setZero(n);
    pair_.setZero(n);
    jacobian_.init(system);
    real_.init(n);
    complex_.init(n);
    norm_.init(n);
    rounding_.init(system);
    work_ = {};
    memory_ = {};
    slope_known_ = polynomial_known_ = false;
    old_h_ = 0;
  }

  /// y_new = y + z_3. May be repeated with another h.
  /// @returns newton_failed where the stage equations are not solved; work().failure then names the reason
  template <System Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    h_ = h;
    polynomial_known_ = false;
    jacobian_.begin(system, t, y);
    norm_.prepare(system, y);
    if (!slope_known_) {
      system.rhs(t, y, slope_);
      slope_known_ = true;
    }
    // What the attempt learns of the convergence is kept by accept() alone.
    attempt_memory_ = memory_;
    extrapolates_ = old_h_ != 0 && (jacobian_.is_mechanical() || norm_.resolves(y));
    if (!extrapolates_) attempt_memory_ = {};  // what is known is of better starts
    if (!solve(system, t, y, h)) return StepStatus::newton_failed;
    detail::assign(y_new, [&](auto access) { return access(y) + access(z_[2]); });
    return StepStatus::ok;
  }

  /// Commits the last attempt: y_new is the new state, and its collocation polynomial predicts the next
  /// stages.
  void accept(const State&) {
    if (!polynomial_known_) make_polynomial();
    // The next attempt predicts from this polynomial, and may be repeated.
    for (std::size_t j = 0; j < 3; ++j) copy_state(polynomial_[j], old_polynomial_[j]);
    // f at the end as the collocation polynomial has it: f(t + h, y_new) would multiply the error of y_new by
    // the stiffness.
    // y'(t + h) = (p_0 - (c_2 - 1) (p_1 - (c_1 - 1) p_2)) / h, see make_polynomial().
    const Real per_h = 1 / h_;
    detail::assign(slope_, [&](auto access) {
      return (access(polynomial_[0]) - c2m1 * (access(polynomial_[1]) - c1m1 * access(polynomial_[2]))) *
             per_h;
    });
    jacobian_.accept(attempt_memory_.theta);
    memory_ = {attempt_memory_.eta};
    old_h_ = h_;
  }

  /// Square of the weighted norm of err = (I - h/gamma J)^-1 (h/gamma f(t, y) + e . z). An error too large
  /// for the step is damped once more by the same matrix: what is left of it for infinite stiffness vanishes.
  /// This is f(t, y + err) in place of f(t, y), with f linearised. [hairer1996solving, IV.8 (8.19), (8.20)]
  /// @param norm  RmsNorm or MatlabNorm, which carry the tolerances
  template <class Norm>
  Real error_squared(Real h, const State& y, const State& y_new, const Norm& norm) const {
    const Real h_gamma = h / gamma;
    // h / gamma f(t, y) + e_1 z_1 + e_2 z_2 + e_3 z_3
    detail::assign(error_, [&](auto access) {
      return access(slope_) * h_gamma + access(z_[0]) * e(0) + access(z_[1]) * e(1) + access(z_[2]) * e(2);
    });
    const auto weigh = [&] {
      work_.linear_iterations += real_.solve(error_);
      return norm.squared(y, y_new, [&](Eigen::Index d) { return error_[d]; });
    };
    // A large estimate is filtered once more.
    const Real squared = weigh();
    return squared < 1 ? squared : weigh();
  }

  /// out = y(t + theta h) by the collocation polynomial of degree 3 through y and the three stages; no
  /// evaluation.
  /// @param theta  in [0, 1]: 1 is y_new
  template <System Sys>
  void interpolate(const Sys&, Real, Real, const State&, const State& y_new, Real theta, State& out) {
    if (!polynomial_known_) make_polynomial();
    const Real u = theta - 1;
    // y_new + u (p_0 + (u - (c_2 - 1)) (p_1 + (u - (c_1 - 1)) p_2))
    detail::assign(out, [&](auto access) {
      return access(y_new) + (access(polynomial_[0]) +
                              (access(polynomial_[1]) + access(polynomial_[2]) * (u - c1m1)) * (u - c2m1)) *
                                 u;
    });
  }

 private:
  /// One vector of shape (n) for each stage, or for each component of the transformed equations.
  using Three = std::array<State, 3>;
  static constexpr Real gamma = static_cast<Real>(radau::gamma);
  static constexpr Real c(std::size_t i) { return static_cast<Real>(radau::tableau.c[i]); }
  static constexpr Real e(std::size_t i) { return static_cast<Real>(radau::e[i]); }
  /// c_1 - 1 and c_2 - 1: nodes counted from the end of the step.
  static constexpr Real c1m1 = c(0) - 1, c2m1 = c(1) - 1;

  /// The stages of an attempt, with another Jacobian or by continuation where the first try fails.
  template <System Sys>
  bool solve(const Sys& system, Real t, const State& y, Real h) {
    // The three stages have no potential together: a slower flow would not come nearer.
    if (solve_or_continue(
            jacobian_, norm_, attempt_memory_, system, t, y, std::span(first_mu).first(1),
            [&](std::optional<Real> continuation) { return solve_stages(system, t, y, h, continuation); }))
      return true;
    if (!norm_.may_continue() || !jacobian_.decides()) return false;
    attempt_memory_ = {.theta = 1};
    return solve_accelerated(system, t, y, h);
  }

  /// The last resort of fixed steps. One Jacobian serves three stages that lie far apart, so that iterations
  /// may converge too slowly from the best start: they are accelerated, from z = 0, with the Jacobian at the
  /// second stage, which is renewed.
  template <System Sys>
  bool solve_accelerated(const Sys& system, Real t, const State& y, Real h) {
    constexpr int most = 200, renewed = 40;
    const SlopeAt<Sys> slopes[]{{system, t + c(0) * h}, {system, t + c(1) * h}, {system, t + h}};
    for (State* v : {&z_[0], &z_[1], &z_[2], &w_[0], &w_[1], &w_[2]}) v->setZero();
    Y_[1] = y;
    AndersonMixing<State, 3> mixing;
    for (int k = 0; k < most; ++k) {
      if (k % renewed == 0) {
        jacobian_.take(system, t + c(1) * h, Y_[1]);
        mixing.forget();
        if (!factor(h)) return ends(NewtonEnd::singular);
      }
      find_residual(slopes, y, h);
      ++work_.newton;
      attempt_memory_.error = std::sqrt(find_corrections(system, 1));
      if (!(attempt_memory_.error <= std::numeric_limits<Real>::max())) return ends(NewtonEnd::not_finite);
      // The residual has left f in the place of z = s f, which rounding is measured by. At a new Jacobian z
      // may still be 0, so that nothing is estimated there.
      transform<Forward>(w_, z_);
      const bool solved = attempt_memory_.error <= std::max(Real(1), rounding(system, h, k % renewed != 0));
      if (!solved) {
        mixing.step(w_, f_);
      } else {
        for (std::size_t i = 0; i < 3; ++i) w_[i] += f_[i];
      }
      transform<Forward>(w_, z_);
      if (solved) return ends(NewtonEnd::converged);
    }
    return ends(NewtonEnd::too_slow);
  }

  /// Notes how an iteration has ended. @returns whether it has converged
  bool ends(NewtonEnd end) {
    if (end != NewtonEnd::converged) {
      work_.failure = to_string(end);
      return false;
    }
    // Zero in adaptive runs, see NewtonNorm::relative().
    work_.newton_error = std::max(work_.newton_error, norm_.relative(attempt_memory_.error));
    return true;
  }

  /// h / (alpha + i beta), the shift of the complex equation.
  static Complex complex_shift(Real h) {
    return h / Complex(static_cast<Real>(radau::alpha), static_cast<Real>(radau::beta));
  }
  /// Factors I - h/gamma J and I - h/(alpha + i beta) J unless the factors at hand are of this h and J.
  /// @returns false where one of them is singular or not finite
  bool factor(Real h) {
    return real_.factor(jacobian_.matrix(), jacobian_.id(), h / gamma, work_.factorisations) &&
           complex_.factor(jacobian_.matrix(), jacobian_.id(), complex_shift(h), work_.factorisations);
  }

  /// One try to solve the stage equations; z_ and w_ hold the solution where it succeeds.
  /// @param continuation  the first mu of continue_newton, with the Jacobian at the last stage, which then
  ///                      replaces iterate_newton
  template <System Sys>
  bool solve_stages(const Sys& system, Real t, const State& y, Real h, std::optional<Real> continuation) {
    // g(t + c_i h) is evaluated once for all iterations.
    const SlopeAt<Sys> slopes[]{{system, t + c(0) * h}, {system, t + c(1) * h}, {system, t + h}};
    const auto rounds = [&](bool estimate) { return rounding(system, h, estimate); };
    NewtonEnd end = NewtonEnd::singular;
    // Continuation begins with all stages at y.
    if (continuation) {
      for (std::size_t i = 0; i < 3; ++i) {
        z_[i].setZero();
        w_[i].setZero();
      }
      end = continue_newton<Real>(
          *continuation, attempt_memory_, work_.newton,
          [&] {
            find_residual(slopes, y, h);
            Real size = 0;
            for (const State& part : f_) size = std::max(size, norm_.largest(system, part));
            return size;
          },
          [&](Real mu) -> std::optional<Real> {
            jacobian_.take(system, t + h, Y_[2]);
            if (!factor(h / (1 + mu))) return std::nullopt;
            return correct(system, 1 / (1 + mu));
          },
          rounds);
    } else if (factor(h)) {
      predict(h);
      end = iterate_newton(
          norm_.iterations(), attempt_memory_, work_.newton,
          [&] {
            find_residual(slopes, y, h);
            return correct(system, 1);
          },
          rounds);
    }
    return ends(end);
  }

  /// Leaves the right-hand sides of the equations for dw, of the iterate w, z, in f_:
  ///   f_0 = h/gamma g_1 - w_1,   f_1 + i f_2 = h/(alpha + i beta) (g_2 + i g_3) - (w_2 + i w_3).
  /// z_ is overwritten.
  template <class Slopes>
  void find_residual(const Slopes& slopes, const State& y, Real h) {
    for (std::size_t i = 0; i < 3; ++i) {
      detail::assign(Y_[i], [&](auto access) { return access(y) + access(z_[i]); });
      slopes[i](Y_[i], f_[i]);
    }
    transform<Inverse>(f_, z_);  // g, in the place of z
    const Real h_gamma = h / gamma, re = complex_shift(h).real(), im = complex_shift(h).imag();
    detail::assign(f_[0], [&](auto access) { return h_gamma * access(z_[0]) - access(w_[0]); });
    detail::assign(f_[1],
                   [&](auto access) { return re * access(z_[1]) - im * access(z_[2]) - access(w_[1]); });
    detail::assign(f_[2],
                   [&](auto access) { return re * access(z_[2]) + im * access(z_[1]) - access(w_[2]); });
  }

  /// Solves for dw, of which a share is added to w; z becomes that of the new w.
  /// @returns the mean square of the norms of what was added
  template <System Sys>
  Real correct(const Sys& system, Real share) {
    const Real squared = find_corrections(system, share);
    for (std::size_t i = 0; i < 3; ++i)
      detail::assign(w_[i], [&](auto access) { return access(w_[i]) + access(f_[i]); });
    transform<Forward>(w_, z_);
    return squared;
  }

  /// Leaves a share of dw in f_. @returns the mean square of its norms
  template <System Sys>
  Real find_corrections(const Sys& system, Real share) {
    // The complex equation stands for two real ones: (f_1, f_2) = (Re, Im).
    for (Eigen::Index d = 0; d < pair_.size(); ++d) pair_[d] = Complex(f_[1][d], f_[2][d]);
    work_.linear_iterations += real_.solve(f_[0]);
    complex_.solve(pair_);
    for (Eigen::Index d = 0; d < pair_.size(); ++d) {
      f_[1][d] = pair_[d].real();
      f_[2][d] = pair_[d].imag();
    }
    Real sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      detail::assign(f_[i], [&](auto access) { return share * access(f_[i]); });
      sum += norm_.squared(system, f_[i], Y_[2]);
    }
    return sum / 3;
  }

  /// The norm of what rounding of f makes of a correction. That of each stage is as large as the real
  /// equation makes it; the transformation enlarges it by about 5.
  template <System Sys>
  Real rounding(const Sys& system, Real h, bool estimate) {
    return 5 * rounding_(system, estimate, jacobian_.matrix(), jacobian_.id(), h / gamma, Y_[2], z_[2], norm_,
                         [&](State& x) { work_.linear_iterations += real_.solve(x); });
  }

  /// z = T w.
  struct Forward {
    static constexpr const radau::Matrix3& matrix = radau::T;
  };
  /// w = T^-1 z.
  struct Inverse {
    static constexpr const radau::Matrix3& matrix = radau::T_inverse;
  };
  /// Row I of the 3 x 3 matrix.
  template <class Which, std::size_t I>
  struct MatrixRow {
    static constexpr std::size_t size = 3;
    static constexpr long double weight(std::size_t j) { return Which::matrix[I][j]; }
  };
  /// out_i = sum_j M_ij in_j.
  template <class Which>
  static void transform(const Three& in, Three& out) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (detail::assign(out[I],
                      [&](auto access) {
                        return detail::weighted_sum<MatrixRow<Which, I>, Real>(
                            Real(1), [&](std::size_t j) -> decltype(auto) { return access(in[j]); });
                      }),
       ...);
    }
    (std::make_index_sequence<3>{});
  }

  /// z from the polynomial of the last step continued to this one; zero at the first, and where that says
  /// nothing.
  void predict(Real h) {
    for (std::size_t i = 0; i < 3; ++i) {
      // u of t + c_i h, counted from the end of the last step in its step size.
      const Real u = extrapolates_ ? c(i) * h / old_h_ : Real(0);
      detail::assign(z_[i], [&](auto access) {
        return (access(old_polynomial_[0]) +
                (access(old_polynomial_[1]) + access(old_polynomial_[2]) * (u - c1m1)) * (u - c2m1)) *
               u;
      });
    }
    transform<Inverse>(z_, w_);
  }

  /// Newton's form of the polynomial through z at c_3 = 1, c_2, c_1 and 0, in u = theta - 1, less its value
  /// at the end:  u (p_0 + (u - (c_2 - 1))(p_1 + (u - (c_1 - 1)) p_2)).
  void make_polynomial() {
    // Divided differences p_0 = z[c_3, c_2], p_1 = z[c_3, c_2, c_1], p_2 = z[c_3, c_2, c_1, 0]; z(0) = 0.
    const Real per_c1 = 1 / c(0), per_c2 = 1 / c(1), per_c12 = 1 / (c(0) - c(1));
    detail::assign(polynomial_[0], [&](auto access) { return (access(z_[1]) - access(z_[2])) * (1 / c2m1); });
    detail::assign(polynomial_[1], [&](auto access) {
      return ((access(z_[0]) - access(z_[1])) * per_c12 - access(polynomial_[0])) * (1 / c1m1);
    });
    detail::assign(polynomial_[2], [&](auto access) {
      return access(polynomial_[1]) -
             ((access(z_[0]) - access(z_[1])) * per_c12 - access(z_[0]) * per_c1) * per_c2;
    });
    polynomial_known_ = true;
  }

  /// z_i = Y_i - y, w = T^-1 z, slopes or residuals, and the arguments Y_i.
  Three z_, w_, f_, Y_;
  /// p_0, p_1, p_2 of the last attempt and of the accepted step before.
  Three polynomial_, old_polynomial_;
  State slope_ = blank_state<State>();  ///< f at the start of the step
  /// err, shape (n).
  mutable State error_ = blank_state<State>();
  /// dw_2 + i dw_3, shape (n).
  Eigen::Matrix<Complex, State::RowsAtCompileTime, 1> pair_;
  Linearisation<State, Matrix> jacobian_;
  /// Solvers of the real and of the complex equation.
  mutable ShiftedSolver<Matrix, Real> real_;
  ShiftedSolver<Matrix, Complex> complex_;
  /// Stages are solved to 0.03 of the error test.
  NewtonNorm<State> norm_{Real(0.03)};
  ResidualRounding<State> rounding_;
  /// Of the accepted steps, and as the attempt has changed it.
  NewtonMemory<Real> memory_, attempt_memory_;
  mutable ImplicitWork work_;  ///< error estimates solve equations too
  /// Of the last attempt and of the accepted step before; 0: there is none.
  Real h_ = 0, old_h_ = 0;
  /// The attempt begins with the polynomial of the step before.
  bool extrapolates_ = false;
  bool slope_known_ = false, polynomial_known_ = false;
};

}  // namespace hmax
