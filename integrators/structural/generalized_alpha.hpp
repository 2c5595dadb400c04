/// Implicit methods of structural dynamics, M q'' = F(t, q, v), on packed states y = (q, v): Newmark,
/// HHT-alpha and generalized-alpha are one method of four numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "integrators/implicit/jacobian.hpp"
#include "integrators/implicit/newton_settings.hpp"
#include "integrators/linear/linear_solver.hpp"
#include "integrators/stats.hpp"
#include "integrators/structural/structural.hpp"

namespace hmax {

/// The four numbers of the family.
struct AlphaParameters {
  long double alpha_m = 0;  ///< weight of the old acceleration in the equation of motion
  long double alpha_f = 0;  ///< weight of the old position, velocity and time in it
  /// q_new = q + h v + h^2 ((1/2 - beta) a + beta a_new),   v_new = v + h ((1 - gamma) a + gamma a_new).
  long double beta = 0.25L, gamma = 0.5L;

  bool operator==(const AlphaParameters&) const = default;
};

/// Newmark's method [newmark1959method]: (1/4, 1/2) is the trapezoidal rule for linear problems, (1/6, 1/2)
/// the linear acceleration method, (1/12, 1/2) that of Fox and Goodwin, (0, 1/2) central differences that
/// solve for the whole damping matrix, v_new = v + h/2 (a + a_new): without damping explicit, with it solved
/// by
///   (M + h/2 C) a_new = F(t + h, q_new, v + h/2 a),    q_new = q + h v + h^2/2 a.
/// Undamped linear problems: unconditionally stable for 2 beta >= gamma >= 1/2; with gamma = 1/2 and beta <
/// 1/4 stable for omega h < 1 / sqrt(1/4 - beta) [hughes2000finite, 9.1].
constexpr AlphaParameters newmark_parameters(long double beta, long double gamma) {
  return {0, 0, beta, gamma};
}

/// The method of Hilber, Hughes and Taylor [hilber1977improved], alpha in [-1/3, 0]; 0 is the trapezoidal
/// rule.
///   beta = (1 - alpha)^2 / 4,   gamma = 1/2 - alpha,   alpha_f = -alpha
/// The range is not checked here.
constexpr AlphaParameters hht_parameters(long double alpha) {
  return {0, -alpha, (1 - alpha) * (1 - alpha) / 4, 0.5L - alpha};
}

/// The generalized-alpha method of Chung and Hulbert [chung1993time] whose amplification of infinitely fast
/// modes is rho, in [0, 1]: 0 annihilates them within three steps, 1 keeps them.
///   alpha_m = (2 rho - 1) / (rho + 1),   alpha_f = rho / (rho + 1),
///   beta = (1 - alpha_m + alpha_f)^2 / 4,   gamma = 1/2 - alpha_m + alpha_f
/// The range is not checked here.
constexpr AlphaParameters generalized_alpha_parameters(long double rho) {
  const long double alpha_m = (2 * rho - 1) / (rho + 1), alpha_f = rho / (rho + 1);
  const long double s = 1 - alpha_m + alpha_f;
  return {alpha_m, alpha_f, s * s / 4, 0.5L - alpha_m + alpha_f};
}

/// 2 where gamma = 1/2 - alpha_m + alpha_f, else 1 [chung1993time].
constexpr int order_of(const AlphaParameters& p) {
  const long double defect = p.gamma - (0.5L - p.alpha_m + p.alpha_f);
  return defect < 1e-15L && defect > -1e-15L ? 2 : 1;
}

static_assert(newmark_parameters(0.25L, 0.5L) == AlphaParameters{} && hht_parameters(0) == AlphaParameters{});
static_assert(generalized_alpha_parameters(1) == AlphaParameters{0.5L, 0.5L, 0.25L, 0.5L});
static_assert(generalized_alpha_parameters(0) == AlphaParameters{-1, 0, 1, 1.5L});
static_assert(order_of(newmark_parameters(0.25L, 0.6L)) == 1 && order_of(hht_parameters(-0.3L)) == 2);

/// One step of the generalized-alpha method: a_new solves
///   M ((1 - alpha_m) a_new + alpha_m a) = F(t_f, q_f, v_f),     x_f = (1 - alpha_f) x_new + alpha_f x,
///   q_new = q + h v + h^2 ((1/2 - beta) a + beta a_new),        v_new = v + h ((1 - gamma) a + gamma a_new).
/// The force is evaluated once at the point between the ends, not averaged from both; for linear forces both
/// are the same. a_new is the a of the next step; the first is M^-1 F(t_0).
///
/// Simplified Newton iteration on a_new with the symmetric matrix of n rows
///   M + c C + k K,    c = r gamma h,    k = r beta h^2,    r = (1 - alpha_f) / (1 - alpha_m)
/// from a_new = a until what is still to come, as the rate of convergence foretells it, is rounding. Of a
/// linear problem the rate is remembered from step to step, so that it takes one iteration and one force a
/// step; of another one the rate of a step says nothing of the next, in which a stop may be met; with beta =
/// 0 it is remembered, which only damping that changes would make wrong. A factorisation is kept while h, K
/// and C stay. K and C are renewed as JacobianUpdate says; automatic: after a step that converged slowly.
/// Where the iteration does not converge, automatic and exact go on to Newton's method from a motionless
/// guess, with K and C at every iterate.
/// @tparam DofsT    Eigen column vector, shape (n)
/// @tparam MatrixT  type of K and C, shape (n, n): dense, sparse, or structure_type of the system
/// @cost   a force and a solution each iteration; no allocation after init() for dense matrices
/// @source [chung1993time]
template <class StateT, class DofsT, class MatrixT>
class GeneralizedAlpha {
 public:
  using State = StateT;
  using Real = real_of<State>;
  using Scalar = typename State::Scalar;
  static constexpr int order = 0;  ///< order_of(parameters)
  static constexpr int error_order = 0;
  static constexpr bool may_estimate_error = false;
  static constexpr bool is_explicit = false;

  GeneralizedAlpha() = default;
  explicit GeneralizedAlpha(const AlphaParameters& p)
      : alpha_m_(static_cast<Real>(p.alpha_m)),
        alpha_f_(static_cast<Real>(p.alpha_f)),
        beta_(static_cast<Real>(p.beta)),
        gamma_(static_cast<Real>(p.gamma)) {}

  /// When K and C are renewed, see the class.
  void set_jacobian_update(JacobianUpdate update) { update_ = update; }
  /// How symmetric sparse equations are solved.
  void set_linear_solve(LinearSolve choice) {
    if constexpr (requires { solver_.set(choice); }) solver_.set(choice);
  }

  /// How exactly equations are solved.
  void set_newton(NewtonSettings settings) {
    iterations_ = settings.iterations;
    tolerance_ = std::max(static_cast<Real>(settings.tolerance), rounding);
  }

  /// Evaluates a = M^-1 F(t, q, v) and takes K and C at the start. Dense equations allocate here only.
  /// @param y  (q, v), shape (2 n)
  template <SecondOrderSystem Sys>
  void init(const Sys& system, Real t, const State& y) {
    const Eigen::Index n = system.dofs();
    take_mass(system);
    q_ = y.head(n);
    v_ = y.tail(n);
    force_ = a_new_ = a_ = mass_;
    system.force(t, q_, v_, a_);
    if (couples())
      a_ = M_.solve(a_);
    else
      a_ = a_.cwiseQuotient(mass_);
    if constexpr (!detail::is_variant<MatrixT>) {
      K_.resize(n, n);
      C_.resize(n, n);
    }
    linearise(system, t, K_, C_);
    linearised_here_ = true;
    A_ = K_full_ = K_;
    C_full_ = C_;
    if constexpr (requires { solver_.resize(n); }) solver_.resize(n);
    factored_h_ = std::numeric_limits<Real>::quiet_NaN();
    rate_ = new_rate_ = Real(1);
    slow_ = new_slow_ = false;
    steps_ = 0;
    work_ = {};
    offset_ = 0;
    if constexpr (OffsetSystem<Sys>)
      if (has_offset(system)) {
        State X = y;
        X.setZero();
        system.offset(X);
        offset_ = norm(system, X, 0);
      }
  }

  /// y_new = (q_new, v_new) from y at t. May be repeated with another h.
  /// @returns newton_failed where the iteration fails with the kept K and C and, if this class may choose
  ///          them, also with those of every iterate; work().failure then names the reason
  template <SecondOrderSystem Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    if (!linearised_here_ && is_due()) {
      unpack(y);
      linearise(system, t, K_, C_);
      linearised_here_ = true;
      factored_h_ = std::numeric_limits<Real>::quiet_NaN();
    }
    new_rate_ = rate_;
    new_slow_ = false;
    if (factor(h)) {
      // Simplified Newton from a_new = a.
      a_new_ = a_;
      if (iterate(system, t, y, h, y_new, limit(decides() ? 10 : 100), false)) return StepStatus::ok;
    }
    // The iterates of Newton's method leave K and C alone: an attempt leaves no trace.
    factored_h_ = std::numeric_limits<Real>::quiet_NaN();
    if (!decides()) return StepStatus::newton_failed;
    stand_still(y, h);
    const bool solved = iterate(system, t, y, h, y_new, limit(40), true);
    new_rate_ = Real(1);
    new_slow_ = true;
    return solved ? StepStatus::ok : StepStatus::newton_failed;
  }

  /// Commits the last attempt: its acceleration begins the next step.
  void accept(const State&) {
    std::swap(a_, a_new_);
    linearised_here_ = false;
    ++steps_;
    rate_ = new_rate_;
    slow_ = new_slow_;
  }

  /// Cubic Hermite polynomials, q with v and v with a; no evaluation.
  template <SecondOrderSystem Sys>
  void interpolate(const Sys&, Real, Real h, const State& y, const State& y_new, Real theta,
                   State& out) const {
    detail::hermite_motion(
        h, y, y_new, [&](Eigen::Index i) { return a_[i]; }, [&](Eigen::Index i) { return a_new_[i]; }, theta,
        out);
  }

  /// Factorisations, iterations, largest error left and the last failure since init().
  [[nodiscard]] ImplicitWork work() const { return work_; }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(a_, K_, C_, factored_h_, rate_, steps_, slow_, linearised_here_);
    visit_work(visit, work_);
  }
  /// After visit_state() has read it: makes what is not written, the factors.
  template <SecondOrderSystem Sys>
  void resumed(const Sys&) {
    const ImplicitWork counted = work_;
    if (factored_h_ == factored_h_) factor(factored_h_, K_, C_);
    work_ = counted;
  }

  /// The acceleration at the start of the next step, shape (n).
  [[nodiscard]] const DofsT& acceleration() const { return a_; }

 private:
  /// A rate of convergence above this asks for new K and C.
  static constexpr double slow = 0.03;
  /// Smallest relative correction that is asked for.
  static constexpr Real rounding = 100 * std::numeric_limits<Real>::epsilon();

  /// Whether this class chooses where K and C are taken, at all times or when the iteration fails.
  [[nodiscard]] bool decides() const {
    return update_.every == JacobianUpdate::automatic || update_.every == 1;
  }

  /// The iterations that are allowed where the user sets no limit.
  [[nodiscard]] int limit(int own) const { return iterations_ > 0 ? iterations_ : own; }

  /// (q, v) of a packed state into q_ and v_.
  void unpack(const State& y) {
    const Eigen::Index n = detail::dofs_of(y);
    q_ = y.head(n);
    v_ = y.tail(n);
  }

  /// Few unknowns, of a number that the compiler knows, have masses of their own.
  static constexpr bool may_couple = DofsT::SizeAtCompileTime == Eigen::Dynamic;

  /// Whether M couples unknowns.
  [[nodiscard]] bool couples() const { return may_couple && !M_.is_diagonal(); }

  template <SecondOrderSystem Sys>
  void take_mass(const Sys& system) {
    if constexpr (may_couple) {
      M_ = mass_of(system);
      mass_ = M_.diagonal();
    } else {
      mass_ = system.mass();
    }
  }

  /// K and C at (t, q_, v_). K has no part in a method whose positions do not depend on a_new.
  template <SecondOrderSystem Sys>
  void linearise(const Sys& system, Real t, MatrixT& K, MatrixT& C) const {
    if constexpr (detail::may_hold<OperatorSum, MatrixT>)
      if (const auto structure = structure_operator_of(system)) {
        K = C = OperatorSum{{structure}};
        return;
      }
    using Own = typename Sys::DofMatrix;
    detail::write_as<Own>(C, [&](Own& own) { system.damping(t, q_, v_, own); });
    if (beta_ == 0)
      K = C;
    else
      detail::write_as<Own>(K, [&](Own& own) { system.stiffness(t, q_, v_, own); });
  }

  /// Whether K and C are renewed at the start of this step.
  [[nodiscard]] bool is_due() const {
    if (update_.every == JacobianUpdate::automatic) return slow_;
    return update_.every != JacobianUpdate::frozen && steps_ % update_.every == 0;
  }

  /// Factors A = M + c C + k K of K_ and C_ unless the factors at hand are of this h.
  /// @returns false where A is singular or not finite
  bool factor(Real h) {
    if (factored_h_ == h) return true;
    if (!factor(h, K_, C_)) return false;
    factored_h_ = h;
    return true;
  }
  bool factor(Real h, const MatrixT& K, const MatrixT& C) {
    const Real share = (1 - alpha_f_) / (1 - alpha_m_);
    const Real c = share * gamma_ * h, k = share * beta_ * h * h;
    if (couples())
      set_combination(M_.coupled()->matrix(), c, C, k, K, A_);
    else
      set_combination(mass_, c, C, k, K, A_);
    ++work_.factorisations;
    return solver_.factor(A_);
  }

  /// The a_new of q_new = q, from 0 = h v + h^2 ((1/2 - beta) a + beta a_new); a_new = a where q_new does
  /// not depend on it.
  void stand_still(const State& y, Real h) {
    const Eigen::Index n = detail::dofs_of(y);
    if (beta_ == 0)
      a_new_ = a_;
    else
      detail::for_each_dof(
          y, [&](Eigen::Index i) { a_new_[i] = -(y[n + i] / h + (Real(0.5) - beta_) * a_[i]) / beta_; });
  }

  /// Iterates on a_new_ and leaves the candidate in y_new.
  /// @param newton  K and C are taken, and A factored, at every iterate
  template <SecondOrderSystem Sys>
  bool iterate(const Sys& system, Real t, const State& y, Real h, State& y_new, int iterations, bool newton) {
    const Eigen::Index n = detail::dofs_of(y);
    const Real t_f = t + (1 - alpha_f_) * h, share = 1 / (1 - alpha_m_);
    // With beta = 0 positions do not depend on a_new: one force a step, wrong only where damping switches.
    const bool remembers = !newton && (beta_ == 0 || is_linear(system));
    Real before = 0, rate = remembers ? rate_ : Real(1);
    update_candidate(y, h, y_new);
    for (int k = 1; k <= iterations; ++k) {
      // x_f = (1 - alpha_f) x_new + alpha_f x
      detail::for_each_dof(y, [&](Eigen::Index i) {
        q_[i] = alpha_f_ * y[i] + (1 - alpha_f_) * y_new[i];
        v_[i] = alpha_f_ * y[n + i] + (1 - alpha_f_) * y_new[n + i];
      });
      if (newton) {
        linearise(system, t_f, K_full_, C_full_);
        if (!factor(h, K_full_, C_full_)) return fails("the matrix of Newton's method is singular");
      }
      // A d = (F - M ((1 - alpha_m) a_new + alpha_m a)) / (1 - alpha_m)
      system.force(t_f, q_, v_, force_);
      if (couples())
        force_ = force_ * share - M_.times(DofsT(a_new_ + alpha_m_ * share * a_));
      else
        detail::for_each_dof(y, [&](Eigen::Index i) {
          force_[i] = force_[i] * share - mass_[i] * (a_new_[i] + alpha_m_ * share * a_[i]);
        });
      work_.linear_iterations += solver_.solve(force_);
      a_new_ += force_;
      update_candidate(y, h, y_new);
      ++work_.newton;

      // As velocities: the correction, and the motion that it corrects.
      const Real length = std::abs(h), size = length * norm(system, force_, 0);
      const Real motion = norm(system, y_new, n) + length * norm(system, a_new_, 0);
      if (!(size <= std::numeric_limits<Real>::max()))
        return fails("the forces are not finite in an iterate of Newton's method");
      if (k > 1) {
        rate = size / before;
        if (rate >= 1) {
          // Nothing but rounding may be left, also of positions, which is more than that of a slow motion.
          if (size <= 50 * rounding * (motion + (norm(system, y_new, 0) + offset_) / length))
            return solved(size, motion);
          if (!newton) return fails("Newton's method diverges");
        }
        new_rate_ = rate;
        new_slow_ = rate > Real(slow);
      }
      const Real left = size * std::min(Real(1), 10 * rate);
      if (left <= tolerance_ * motion) return solved(left, motion);
      before = size;
    }
    return fails("Newton's method converges too slowly");
  }

  /// Notes why a_new was not found; always false.
  bool fails(std::string_view why) {
    work_.failure = why;
    return false;
  }
  /// Remembers the error that is left, relative to the motion; always true.
  bool solved(Real left, Real motion) {
    if (motion > 0) work_.newton_error = std::max(work_.newton_error, static_cast<double>(left / motion));
    return true;
  }

  /// The Euclidean norm of n numbers from `first` on, without a root of one number; the largest such norm of
  /// those who hold the unknowns of a system together.
  template <System Sys, class Vector>
  Real norm(const Sys& system, const Vector& vector, Eigen::Index first) const {
    using std::abs;
    if constexpr (DofsT::SizeAtCompileTime == 1)
      return abs(vector[first]);
    else
      return largest_of_all(system, vector.segment(first, mass_.size()).norm());
  }

  /// y_new of a_new_, by Newmark's formulas.
  void update_candidate(const State& y, Real h, State& y_new) const {
    const Eigen::Index n = detail::dofs_of(y);
    detail::for_each_dof(y, [&](Eigen::Index i) {
      y_new[i] = y[i] + h * (y[n + i] + h * ((Real(0.5) - beta_) * a_[i] + beta_ * a_new_[i]));
      y_new[n + i] = y[n + i] + h * ((1 - gamma_) * a_[i] + gamma_ * a_new_[i]);
    });
  }

  Real alpha_m_ = 0, alpha_f_ = 0, beta_ = Real(0.25), gamma_ = Real(0.5);
  JacobianUpdate update_{};
  Real tolerance_ = rounding;
  int iterations_ = 0;                                             ///< limit of the user; 0: none
  DofsT mass_ = blank_state<DofsT>(), a_ = mass_, a_new_ = mass_;  ///< shape (n)
  DofsT q_ = mass_, v_ = mass_, force_ = mass_;                    ///< at one iterate, shape (n)
  MassMatrix<Real> M_;  ///< M, where it may couple unknowns; else empty
  MatrixT K_ = blank_matrix<MatrixT>(), C_ = K_, K_full_ = K_,
          C_full_ = K_;  // shape (n, n): of the last renewal,
                         // and at the iterates of Newton's method
  MatrixT A_ = K_;
  LinearSolver<MatrixT> solver_;
  Real offset_ = 0;               ///< the norm of the positions that q is added to, with their rounding
  Real factored_h_ = 0;           ///< the h of the factors of K_ and C_; NaN: there are none
  Real rate_ = 1, new_rate_ = 1;  ///< of convergence, in the last accepted step and the last attempt
  std::int64_t steps_ = 0;        ///< accepted
  bool slow_ = false, new_slow_ = false;  ///< the same
  bool linearised_here_ = false;          ///< K_ and C_ are those of the start of this step
  ImplicitWork work_;
};

}  // namespace hmax
