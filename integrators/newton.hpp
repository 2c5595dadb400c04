/// Simplified Newton iteration for the equations of implicit steps: when it has converged, when it never
/// will, which Jacobian it works with, and when that one is renewed.
///
/// A step keeps no trace of a rejected attempt: what an attempt learns (a rate of convergence, a fresh
/// Jacobian) becomes the state of the method only when the step is accepted.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include "integrators/jacobian.hpp"
#include "integrators/linear_solver.hpp"
#include "integrators/state.hpp"

namespace hmax {

/// How large a correction is, in units of what the equations have to be solved to.
/// With tolerances: root mean square of d_i / max(kappa (atol + rtol |y_i|), 4 eps |y_i|), a fraction kappa
/// of what the error test allows. Without, in runs of fixed steps: max |d_i| / (4 eps max(|y|, |Y|, |d|)), in
/// the maximum norm, that is solved to rounding.
/// @source [hairer1996solving] IV.8
template <class StateT>
class NewtonNorm {
 public:
  using State = StateT;
  using Real = real_of<State>;
  static constexpr Real rounding = 4 * std::numeric_limits<Real>::epsilon();

  explicit NewtonNorm(Real kappa = Real(0.05)) : kappa_(kappa) {}

  /// Forgets tolerances and makes room for states of shape (n).
  void init(Eigen::Index n) {
    rtol_ = atol_ = 0;
    per_weight_.resize(n);
  }
  void set_tolerances(Real rtol, Real atol) {
    rtol_ = kappa_ * rtol;
    atol_ = kappa_ * atol;
  }
  [[nodiscard]] bool has_tolerances() const { return rtol_ > 0 || atol_ > 0; }

  /// Weighs the corrections of an attempt that starts from y, shape (n).
  void prepare(const State& y) {
    if (!has_tolerances()) {
      scale_ = largest(y);
      return;
    }
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      const Real size = std::abs(y[i]);
      const Real weight = std::max(atol_ + rtol_ * size, rounding * size);
      per_weight_[i] = 1 / std::max(weight, std::numeric_limits<Real>::min());
    }
  }

  /// Square of the norm of a correction d, shape (n), that led to the iterate Y.
  [[nodiscard]] Real squared(const State& d, const State& Y) const {
    if (!has_tolerances()) {
      const Real size = largest(d);
      // The smallest numbers have no relative precision.
      const Real unit =
          std::max(rounding * std::max({scale_, largest(Y), size}), std::numeric_limits<Real>::min());
      return Eigen::numext::abs2(size / unit);
    }
    Real sum{0};
    for (Eigen::Index i = 0; i < d.size(); ++i) sum += Eigen::numext::abs2(d[i] * per_weight_[i]);
    return sum / static_cast<Real>(d.size());
  }

  /// Corrections that no longer shrink are rounding when their norm is at most this.
  [[nodiscard]] Real stall() const { return 250 * rounding / std::max(rtol_, rounding); }
  /// With a step that can be cut it is cheaper to give up early.
  [[nodiscard]] int iterations() const { return has_tolerances() ? 7 : 100; }

 private:
  /// max |v_i|; NaN when there is one.
  static Real largest(const State& v) {
    Real most{0};
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      const Real size = std::abs(v[i]);
      if (std::isnan(size)) return size;
      most = std::max(most, size);
    }
    return most;
  }

  Real kappa_, rtol_ = 0, atol_ = 0, scale_ = 0;
  State per_weight_ = blank_state<State>();
};

/// What is known of the convergence from earlier iterations with the same kind of matrix.
template <class Real>
struct NewtonMemory {
  /// theta / (1 - theta) of the last iteration: error <= eta |last correction|. As long as nothing is known
  /// it takes two corrections to believe in convergence: a Jacobian that is far too large makes small ones.
  Real eta = std::numeric_limits<Real>::infinity();
  Real theta = 0;  ///< largest rate of convergence that was seen since it was set to zero
};

enum class NewtonEnd { converged, too_slow, diverged, not_finite };

/// Iterates until the error of the equations is at most 1 in the norm of the corrections.
///   theta_k = |d_k| / |d_(k-1)|,   solved when  theta / (1 - theta) |d_k| <= 1;
/// it diverges when theta >= 1 unless rounding is all that is left, and is too slow when theta^(k_max - k) /
/// (1 - theta) |d_k| > 1. The first correction is judged by the rate of the iteration before, which is
/// trusted a little less each time: eta <- eta^(3/4).
/// @param iterations  limit k_max
/// @param stall       corrections that no longer shrink are taken for rounding up to this norm
/// @param correct     correct() makes one correction and returns the square of its norm
/// @param count       is increased by the number of corrections
/// @source [hairer1996solving] IV.8 (8.10), with 3/4 for the exponent 0.8, which costs two square roots
template <class Real, class Correct>
NewtonEnd iterate_newton(int iterations, Real stall, NewtonMemory<Real>& memory, std::int64_t& count,
                         Correct&& correct) {
  using std::sqrt, std::pow;
  Real eta = std::max(memory.eta, std::numeric_limits<Real>::epsilon());
  eta = sqrt(eta * sqrt(eta));
  // Forces of a body in space are differences of positions: beside a small motion they know few digits.
  constexpr Real noise = Real(1e-6);
  Real first = 0, last = 0, theta = 0, last_rate = 0;
  for (int k = 1; k <= iterations; ++k) {
    ++count;
    const Real norm = sqrt(correct());
    if (!(norm <= std::numeric_limits<Real>::max())) return NewtonEnd::not_finite;
    if (k > 1) {
      // Two rates in a row are averaged: with complex eigenvalues they alternate.
      const Real rate = norm / last;
      theta = k == 2 ? rate : sqrt(rate * last_rate);
      last_rate = rate;
      if (theta < 1) eta = theta / (1 - theta);
    }
    const bool shrinks = theta < 1;
    if (k == 1) first = norm;
    // A correction that no longer shrinks, far below the first one, is what f rounds to.
    const bool rounds = !shrinks && norm <= std::max(stall, noise * first);
    if (norm == 0 || (shrinks && eta * norm <= 1) || rounds) {
      if (shrinks) {
        memory.eta = eta;
        memory.theta = std::max(memory.theta, theta);
      }
      return NewtonEnd::converged;
    }
    if (!shrinks) return NewtonEnd::diverged;
    if (k > 1 && norm > stall && pow(theta, static_cast<Real>(iterations - k)) * eta * norm > theta)
      return NewtonEnd::too_slow;
    last = norm;
  }
  return last <= stall ? NewtonEnd::converged : NewtonEnd::too_slow;
}

/// The Jacobian of a method that solves equations, and the rules by which it is renewed. automatic: when the
/// convergence of an accepted step was slow, or at once when it failed with an old one.
template <class State, class Matrix>
class Linearisation {
 public:
  using Real = real_of<State>;
  /// A rate of convergence above this asks for a new Jacobian.
  static constexpr double slow = 1e-2;

  void set_update(JacobianUpdate update) { update_ = update; }

  template <System Sys>
  void init(const Sys& system) {
    source_.init(system);
    make_room(J_, system.dim());
    make_room(fresh_, system.dim());
    due_ = true;
    is_current_ = fresh_known_ = uses_fresh_ = false;
    steps_ = 0;
  }

  /// Begins an attempt from (t, y): the Jacobian that is due is taken, once for all attempts from there.
  template <System Sys>
  void begin(const Sys& system, Real t, const State& y) {
    uses_fresh_ = false;
    if (!due_) return;
    evaluate(system, t, y, J_, id_);
    due_ = false;
    is_current_ = true;
  }

  /// df/dy as this attempt uses it, and a number that differs for different ones.
  [[nodiscard]] const Matrix& matrix() const { return uses_fresh_ ? fresh_ : J_; }
  [[nodiscard]] std::int64_t id() const { return uses_fresh_ ? fresh_id_ : id_; }

  /// After a failure: turns to the Jacobian at (t, y).
  /// @returns false when that was the one in use, or when the user decides about Jacobians
  template <System Sys>
  bool renew(const Sys& system, Real t, const State& y) {
    if (update_.every != JacobianUpdate::automatic || is_current_ || uses_fresh_) return false;
    if (!fresh_known_) evaluate(system, t, y, fresh_, fresh_id_);
    fresh_known_ = uses_fresh_ = true;
    return true;
  }

  /// @param theta  rate of convergence of the step that is accepted
  void accept(Real theta) {
    if (uses_fresh_) {
      std::swap(J_, fresh_);
      id_ = fresh_id_;
    }
    is_current_ = fresh_known_ = uses_fresh_ = false;
    ++steps_;
    if (update_.every == JacobianUpdate::automatic)
      due_ = theta > Real(slow);
    else if (update_.every != JacobianUpdate::frozen)
      due_ = steps_ % update_.every == 0;
  }

 private:
  template <System Sys>
  void evaluate(const Sys& system, Real t, const State& y, Matrix& J, std::int64_t& id) {
    source_.evaluate(system, t, y, J);
    id = ++evaluations_;
  }

  /// A matrix whose kind is known arrives at the system in its shape, (n, n).
  static void make_room(Matrix& J, Eigen::Index n) {
    if constexpr (!detail::is_variant<Matrix> && !detail::is_mechanical<Matrix>) {
      J.resize(n, n);
      J.setZero();
    }
  }

  JacobianUpdate update_;
  JacobianSource<State, Matrix> source_;
  Matrix J_ = blank_matrix<Matrix>(), fresh_ = J_;
  std::int64_t id_ = 0, fresh_id_ = 0, evaluations_ = 0, steps_ = 0;
  bool due_ = true, is_current_ = false, fresh_known_ = false, uses_fresh_ = false;
};

/// (I - s J)^-1, factored only when s or J has changed.
/// @tparam Scalar  of s; complex where a method needs complex shifts of a real J
template <class Matrix, class Scalar>
class ShiftedSolver {
 public:
  ShiftedSolver() = default;
  /// A copy starts without a factorisation.
  ShiftedSolver(const ShiftedSolver& other) : solver_(other.solver_) {}
  ShiftedSolver& operator=(const ShiftedSolver& other) {
    solver_ = other.solver_;
    id_ = 0;
    return *this;
  }
  ShiftedSolver(ShiftedSolver&&) noexcept = default;
  ShiftedSolver& operator=(ShiftedSolver&&) noexcept = default;
  ~ShiftedSolver() = default;

  /// How symmetric sparse equations are solved.
  void set(LinearSolve choice) {
    if constexpr (requires { solver_.set(choice); }) solver_.set(choice);
  }

  /// Forgets its factors. Dense equations of n unknowns are then factored and solved without allocations.
  void init(Eigen::Index n) {
    id_ = 0;
    if constexpr (!detail::is_variant<Matrix> && !detail::is_mechanical<Matrix> &&
                  !std::is_base_of_v<Eigen::SparseMatrixBase<Matrix>, Matrix>) {
      A_.setIdentity(n, n);
      solver_.factor(A_);
      Eigen::Matrix<Scalar, Matrix::RowsAtCompileTime, 1> x;
      x.setZero(n);
      solver_.solve(x);
    }
  }

  /// @param id     says which J it is, > 0
  /// @param count  is increased by 1 when there was something to factor
  /// @returns false when I - s J is singular or not finite
  bool factor(const Matrix& J, std::int64_t id, Scalar s, std::int64_t& count) {
    if (id == id_ && s == s_) return regular_;
    id_ = id;
    s_ = s;
    set_shifted(J, s, A_);
    ++count;
    regular_ = solver_.factor(A_);
    return regular_;
  }

  /// x = (I - s J)^-1 x, shape (n).
  template <class Vector>
  void solve(Vector& x) {
    solver_.solve(x);
  }

 private:
  with_scalar<Matrix, Scalar> A_ = blank_matrix<with_scalar<Matrix, Scalar>>();
  LinearSolver<with_scalar<Matrix, Scalar>> solver_;
  std::int64_t id_ = 0;
  Scalar s_{};
  bool regular_ = false;
};

}  // namespace hmax
