/// Simplified Newton iteration for the equations of implicit steps: when it has converged, when it never
/// will, which Jacobian it works with, and when that one is renewed.
///
/// A step keeps no trace of a rejected attempt: what an attempt learns (a rate of convergence, a fresh
/// Jacobian) becomes the state of the method only when the step is accepted.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "integrators/implicit/jacobian.hpp"
#include "integrators/implicit/newton_settings.hpp"
#include "integrators/linear/linear_solver.hpp"
#include "integrators/state.hpp"
#include "integrators/tolerances.hpp"

namespace hmax {

/// How large a correction is, in units of what the equations have to be solved to.
/// With tolerances: root mean square of d_i / max(kappa (atol_i + rtol |y_i|), 4 eps |y_i|), a fraction kappa
/// of what the error test allows. Without, in runs of fixed steps: max |d_i| / (tol max(|y|, |Y|, |d|)), in
/// the maximum norm, where tol is 4 eps unless the user allows more.
/// @source [hairer1996solving] IV.8
template <class StateT>
class NewtonNorm {
 public:
  using State = StateT;
  using Real = real_of<State>;
  /// 4 eps: no norm asks for less.
  static constexpr Real rounding = 4 * std::numeric_limits<Real>::epsilon();

  /// @param kappa  share of the error test to which equations are solved in adaptive runs
  explicit NewtonNorm(Real kappa = Real(0.05)) : kappa_(kappa) {}

  /// Tolerance and limit of the user, for runs of fixed steps.
  void set(NewtonSettings settings) { settings_ = settings; }

  /// Forgets tolerances and makes room for states of shape (n).
  void init(Eigen::Index n) {
    rtol_ = atol_ = 0;
    atols_.resize(0);
    share_ = std::max(static_cast<Real>(settings_.tolerance), rounding);
    per_weight_.resize(n);
  }
  /// @param atol  a number, or one for each component, shape (n)
  template <class Atol>
  void set_tolerances(Real rtol, const Atol& atol) {
    rtol_ = kappa_ * rtol;
    atol_ = kappa_ * detail::largest_atol(atol);
    if constexpr (detail::is_by_component<Atol>) atols_ = kappa_ * atol;
  }
  /// Whether the run is adaptive: tolerances were set since init().
  [[nodiscard]] bool has_tolerances() const { return rtol_ > 0 || atol_ > 0; }

  /// Weighs the corrections of an attempt that starts from y, shape (n).
  template <System Sys>
  void prepare(const Sys& system, const State& y) {
    if (!has_tolerances()) {
      scale_ = largest(system, y);
      return;
    }
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      const Real size = std::abs(y[i]);
      const Real weight = std::max(atol(i) + rtol_ * size, rounding * size);
      per_weight_[i] = 1 / std::max(weight, std::numeric_limits<Real>::min());
    }
  }

  /// Square of the norm of a correction d, shape (n), that led to the iterate Y.
  template <System Sys>
  [[nodiscard]] Real squared(const Sys& system, const State& d, const State& Y) const {
    if (!has_tolerances()) {
      const Real size = largest(system, d);
      // The smallest numbers have no relative precision.
      const Real unit =
          std::max(share_ * std::max({scale_, largest(system, Y), size}), std::numeric_limits<Real>::min());
      return Eigen::numext::abs2(size / unit);
    }
    Real sum{0};
    for (Eigen::Index i = 0; i < d.size(); ++i) sum += Eigen::numext::abs2(d[i] * per_weight_[i]);
    return sum / static_cast<Real>(d.size());
  }

  /// max |v_i| of all unknowns of the system; not finite where one is not.
  template <System Sys>
  [[nodiscard]] static Real largest(const Sys& system, const State& v) {
    return largest_of_all(system, largest_component(v));
  }

  /// Whether no component of y is so near to zero that only the tolerated error of it is known. Extrapolated
  /// from there, increments may start Newton's method nearer to another solution of the stage equations, as
  /// concentrations have one that is negative: y itself is the better start. Mechanical systems gain nothing
  /// by that: what else might solve their equations lies far from any tolerance.
  [[nodiscard]] bool resolves(const State& y) const {
    if (!has_tolerances()) return true;
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (y[i] != 0 && std::abs(y[i]) * kappa_ <= atol(i)) return false;
    return true;
  }

  /// A norm relative to the largest number of the state; 0 with tolerances, which weigh numbers apart.
  [[nodiscard]] double relative(Real norm) const {
    return has_tolerances() ? 0 : static_cast<double>(norm * share_);
  }

  /// The limit of iterations. With a step that can be cut it is cheaper to give up early.
  [[nodiscard]] int iterations() const {
    if (settings_.iterations > 0) return settings_.iterations;
    return has_tolerances() ? 7 : 50;
  }
  /// Whether equations that the iteration does not solve are solved by continuation: at fixed steps, unless
  /// the user limits the iterations. Where a step can be cut it is cheaper to do that.
  [[nodiscard]] bool may_continue() const { return !has_tolerances() && settings_.iterations == 0; }

 private:
  /// kappa atol_i.
  [[nodiscard]] Real atol(Eigen::Index i) const { return atols_.size() == 0 ? atol_ : atols_[i]; }

  /// rtol_ and atol_ are kappa times those of the run; scale_ is max |y|.
  Real kappa_, rtol_ = 0, atol_ = 0, scale_ = 0, share_ = rounding;
  Eigen::Vector<Real, Eigen::Dynamic> atols_;  ///< of each component; empty: atol_ of all
  NewtonSettings settings_;
  /// 1 / max(atol_i + rtol |y_i|, 4 eps |y_i|), shape (n).
  State per_weight_ = blank_state<State>();
};

/// What is known of the convergence from earlier iterations with the same kind of matrix.
template <class Real>
struct NewtonMemory {
  /// theta / (1 - theta) of the last iteration: error <= eta |last correction|. As long as nothing is known
  /// it takes two corrections to believe in convergence: a Jacobian that is far too large makes small ones.
  Real eta = std::numeric_limits<Real>::infinity();
  Real theta = 0;  ///< largest rate of convergence that was seen since it was set to zero
  Real error = 0;  ///< norm of what the last iteration left, as its rate of convergence foretells

  /// See saved_state.hpp.
  void visit_state(auto& visit) { visit(eta, theta, error); }
};

/// Why an iteration ended.
enum class NewtonEnd { converged, too_slow, diverged, not_finite, singular };

/// The limit of iterations of continue_newton, and the mu that its callers begin with, one after the other.
inline constexpr int most_continuation = 100;
inline constexpr std::array<double, 3> first_mu{1, 10, 100};

/// What is to be said of equations that were not solved.
constexpr std::string_view to_string(NewtonEnd end) {
  switch (end) {
    case NewtonEnd::converged:
      return "converged";
    case NewtonEnd::too_slow:
      return "Newton's method converges too slowly";
    case NewtonEnd::diverged:
      return "Newton's method diverges";
    case NewtonEnd::not_finite:
      return "the forces are not finite in an iterate of Newton's method";
    case NewtonEnd::singular:
      return "the matrix of Newton's method is singular";
  }
  return "unknown";
}

/// Iterates until the error of the equations is at most one unit in the norm of the corrections: the
/// tolerance or, where it is larger, what rounding of f makes of a correction.
///   theta_k = |d_k| / |d_(k-1)|,   solved when  theta / (1 - theta) |d_k| <= 1;
/// it diverges when theta >= 1, and is too slow when theta^(k_max - k) / (1 - theta) |d_k| > 1. The first
/// correction is judged by the rate of the iteration before, which is trusted a little less each time:
/// eta <- eta^(3/4). Convergence that breaks off is the sign of rounding, whose size is then asked for: below
/// it corrections neither shrink nor grow, and their rate says nothing.
/// @param iterations  limit k_max
/// @param correct     correct() makes one correction and returns the square of its norm
/// @param rounding    rounding(estimate) is the norm of the corrections that rounding of f makes; 0 where it
///                    is neither known nor to be estimated
/// @param count       is increased by the number of corrections
/// @source [hairer1996solving] IV.8 (8.10), with 3/4 for the exponent 0.8, which costs two square roots
template <class Real, class Correct, class Rounding>
NewtonEnd iterate_newton(int iterations, NewtonMemory<Real>& memory, std::int64_t& count, Correct&& correct,
                         const Rounding& rounding) {
  using std::sqrt, std::pow;
  constexpr Real broken_off = Real(0.1);  // a rate above which the convergence may be that of rounding
  Real eta = std::max(memory.eta, std::numeric_limits<Real>::epsilon());
  // eta^(3/4)
  eta = sqrt(eta * sqrt(eta));
  // |d_(k-1)|, theta, and the rate before it.
  Real last = 0, theta = 0, last_rate = 0;
  for (int k = 1; k <= iterations; ++k) {
    ++count;
    const Real norm = sqrt(correct());
    if (!(norm <= std::numeric_limits<Real>::max())) return NewtonEnd::not_finite;
    const Real noise = rounding(k > 1 && norm > broken_off * last), unit = std::max(Real(1), noise);
    const bool rounds = k > 1 && norm <= noise;
    // theta_k = |d_k| / |d_(k-1)|
    const Real rate = k > 1 ? norm / last : Real(0);
    if (k > 1 && !rounds) {
      // Two rates in a row are averaged: with complex eigenvalues they alternate.
      theta = k == 2 ? rate : sqrt(rate * last_rate);
      last_rate = rate;
      if (theta < 1) eta = theta / (1 - theta);
    } else if (k > 1 && rate < 1) {
      eta = std::min(eta, rate / (1 - rate));  // of rounding it is an upper bound of the rate
    }
    if (norm == 0 || rounds || (theta < 1 && eta * norm <= unit)) {
      if (theta < 1) {
        memory.eta = eta;
        memory.theta = std::max(memory.theta, theta);
      }
      memory.error = std::min(eta, Real(1)) * norm;
      return NewtonEnd::converged;
    }
    if (theta >= 1) return NewtonEnd::diverged;
    // theta^(k_max - k) / (1 - theta) |d_k| > unit
    if (k > 1 && pow(theta, static_cast<Real>(iterations - k)) * eta * norm > theta * unit)
      return NewtonEnd::too_slow;
    last = norm;
  }
  return NewtonEnd::too_slow;
}

/// Newton's method by pseudo-transient continuation, for where the simplified iteration fails: stage
/// equations z = s f(base + z) are the rest states of dz/dtau = s f(base + z) - z, whose linearly implicit
/// Euler steps
///   ((1 + mu) I - s J) d = s f(base + z) - z,   J at each iterate,
/// follow the flow while mu, one over the length of a step, is large, and are Newton's as it vanishes with
/// the residual (switched evolution relaxation). Of forces with a potential it finds a minimum of the
/// incremental potential, where Newton's method alone ends at saddles or turns in circles.
/// @param mu        the first one; the larger, the closer the flow is followed and the more steps it takes
/// @param residual  residual() finds s f(base + z) - z and returns the size of its largest number
/// @param correct   correct(mu) makes the correction d of that residual and adds it to z; it returns the
/// square
///                  of its norm, or nothing when the matrix is singular
/// @param rounding  as in iterate_newton
/// @source [kelley1998convergence]
template <class Real, class Residual, class Correct, class Rounding>
NewtonEnd continue_newton(Real mu, NewtonMemory<Real>& memory, std::int64_t& count, const Residual& residual,
                          const Correct& correct, const Rounding& rounding) {
  using std::sqrt;
  // mu stays below `most`; below `newton` the steps are Newton's, and rounding may end them.
  constexpr Real most = Real(1e4), newton = Real(1e-2);
  Real before = 0;
  for (int k = 1; k <= most_continuation; ++k) {
    const Real size = residual();
    if (!(size <= std::numeric_limits<Real>::max())) return NewtonEnd::not_finite;
    // mu_k = mu_(k-1) |residual_k| / |residual_(k-1)|
    if (k > 1) mu = std::min(most, mu * size / before);
    before = size;
    const std::optional<Real> squared = correct(mu);
    ++count;
    if (!squared) return NewtonEnd::singular;
    memory.error = sqrt(*squared);
    if (!(memory.error <= std::numeric_limits<Real>::max())) return NewtonEnd::not_finite;
    if (memory.error <= 1 || (mu < newton && memory.error <= rounding(true))) return NewtonEnd::converged;
  }
  return NewtonEnd::too_slow;
}

namespace detail {
/// M of a Jacobian that was read back, see saved_state.hpp: that of the system where the matrix is a
/// mechanical one.
template <class Sys, class Matrix>
void take_mass(const Sys& system, Matrix& J) {
  if constexpr (is_variant<Matrix>)
    std::visit([&](auto& held) { take_mass(system, held); }, J);
  else if constexpr (is_mechanical<Matrix>)
    J.mass = mass_of(system);
}
}  // namespace detail

/// The Jacobian of a method that solves equations, and the rules by which it is renewed. automatic: when the
/// convergence of an accepted step was slow, or at once when it failed with an old one.
template <class State, class Matrix>
class Linearisation {
 public:
  using Real = real_of<State>;
  /// A rate of convergence above this asks for a new Jacobian.
  static constexpr double slow = 1e-2;

  /// When J is evaluated.
  void set_update(JacobianUpdate update) { update_ = update; }

  /// Forgets the Jacobian: the next attempt evaluates one.
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

  /// Whether the equations are those of a mechanical system.
  [[nodiscard]] bool is_mechanical() const {
    if constexpr (detail::is_variant<Matrix>)
      return std::visit([]<class Held>(const Held& /*J*/) { return detail::is_mechanical<Held>; }, matrix());
    else
      return detail::is_mechanical<Matrix>;
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

  /// Turns to the Jacobian at an iterate, which no later attempt uses unless this one is accepted.
  template <System Sys>
  void take(const Sys& system, Real t, const State& y) {
    evaluate(system, t, y, fresh_, fresh_id_);
    uses_fresh_ = true;
    fresh_known_ = false;
  }
  /// Whether this class chooses where Jacobians are taken.
  [[nodiscard]] bool decides() const {
    return update_.every == JacobianUpdate::automatic || update_.every == 1;
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

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(id_, evaluations_, steps_, due_, source_);
    if (!due_) visit(J_);
  }
  /// After visit_state() has read it: makes what is not written, masses and factors.
  template <System Sys>
  void resumed(const Sys& system) {
    detail::take_mass(system, J_);
  }
  /// Whether the matrix at hand serves the next attempt.
  [[nodiscard]] bool is_kept() const { return !due_; }

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
  /// J_ is that of the accepted steps, fresh_ one that the attempt at hand has evaluated.
  Matrix J_ = blank_matrix<Matrix>(), fresh_ = J_;
  /// Numbers of J_ and fresh_; how many were evaluated; accepted steps.
  std::int64_t id_ = 0, fresh_id_ = 0, evaluations_ = 0, steps_ = 0;
  /// due_: J_ is to be evaluated. is_current_, fresh_known_: J_, fresh_ are of the start of this step.
  bool due_ = true, is_current_ = false, fresh_known_ = false, uses_fresh_ = false;
};

/// The equations of an attempt from (t, y): with the Jacobian at hand, else with a new one, else by
/// continuation with one at each iterate.
/// @param memory  what the attempt has learned; forgotten with an old Jacobian
/// @param solve   solve(mu) tries once and returns whether it succeeded, by iterate_newton where mu is empty,
///                else by continue_newton from mu
/// @param mus     the first mu of each continuation, in their order
template <class StateT, class Matrix, System Sys, class Solve>
bool solve_or_continue(Linearisation<StateT, Matrix>& jacobian, const NewtonNorm<StateT>& norm,
                       NewtonMemory<real_of<StateT>>& memory, const Sys& system, real_of<StateT> t,
                       const StateT& y, std::span<const double> mus, const Solve& solve) {
  using Real = real_of<StateT>;
  if (solve(std::optional<Real>())) return true;
  if (jacobian.renew(system, t, y)) {
    memory = {};
    if (solve(std::optional<Real>())) return true;
  }
  if (!norm.may_continue() || !jacobian.decides()) return false;
  memory = {.theta = 1};
  return std::ranges::any_of(mus,
                             [&](double mu) { return solve(std::optional<Real>(static_cast<Real>(mu))); });
}

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
    ++count;
    set_shifted(J, s, A_);
    regular_ = solver_.factor(A_);
    return regular_;
  }

  /// x = (I - s J)^-1 x, shape (n).
  /// @returns iterations of conjugate gradients, 0 where factors solve
  template <class Vector>
  int solve(Vector& x) {
    return solver_.solve(x);
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(id_, s_, regular_); }
  /// After visit_state() has read it: the factors of the matrix J with this number, where it is the one that
  /// was factored.
  void resumed(const Matrix& J, std::int64_t id) {
    if (id != id_) {
      id_ = 0;  // the next attempt has another matrix
      return;
    }
    set_shifted(J, s_, A_);
    solver_.factor(A_);
  }

 private:
  /// I - s J, and its solver. id_ and s_ say which factors there are.
  with_scalar<Matrix, Scalar> A_ = blank_matrix<with_scalar<Matrix, Scalar>>();
  LinearSolver<with_scalar<Matrix, Scalar>> solver_;
  std::int64_t id_ = 0;
  Scalar s_{};
  /// Whether the factors may be used.
  bool regular_ = false;
};

}  // namespace hmax
