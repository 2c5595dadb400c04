/// Explicit methods of structural dynamics, M q'' = F(t, q, v), on packed states y = (q, v): symplectic
/// Euler, velocity Verlet, Stoermer-Verlet, central differences.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "core/mass_matrix.hpp"
#include "integrators/hermite.hpp"
#include "integrators/linear/linear_solver.hpp"
#include "integrators/state.hpp"
#include "integrators/stepper.hpp"

namespace hmax {

/// Why central differences refuse damping where the mass couples unknowns; the method stands before it.
inline constexpr std::string_view needs_lumped_masses =
    "solves for the diagonal of the damping alone, which takes lumped masses; take explicit_newmark, which solves for all "
    "of it, or lump the mass matrix";

namespace detail {
/// The number of positions in a packed state (q, v): known to the compiler for small states.
template <class State>
inline Eigen::Index dofs_of(const State& y) {
  if constexpr (is_small_state<State>)
    return State::SizeAtCompileTime / 2;
  else
    return y.size() / 2;
}

/// Calls f(i) for each degree of freedom of a packed state: unrolled for small states, one pass over memory
/// for the others.
template <class State, class F>
inline void for_each_dof(const State& y, F&& f) {
  if constexpr (is_small_state<State>) {
    unrolled(f, std::make_index_sequence<State::SizeAtCompileTime / 2>{});
  } else {
    const Eigen::Index n = dofs_of(y);
    for (Eigen::Index i = 0; i < n; ++i) f(i);
  }
}

/// The state at t + theta h: q by the cubic through (q, v) at both ends, v by the one through (v, a). Errs by
/// O(h^4) between ends whose accelerations are right.
/// @param a0, a1  callables i -> acceleration of degree of freedom i
template <class State, class A0, class A1>
inline void hermite_motion(real_of<State> h, const State& y0, const State& y1, const A0& a0, const A1& a1,
                           real_of<State> theta, State& out) {
  const Eigen::Index n = dofs_of(y0);
  for_each_dof(y0, [&](Eigen::Index i) {
    out[i] = hermite(theta, y0[i], y1[i], h * y0[n + i], h * y1[n + i]);
    out[n + i] = hermite(theta, y0[n + i], y1[n + i], h * a0(i), h * a1(i));
  });
}
}  // namespace detail

/// One step of symplectic Euler: the velocity first, then the position with the new velocity.
///   v_new = v + h M^-1 F(t, q, v),    q_new = q + h v_new
/// This is one of two methods that are called "semi-implicit Euler"; it solves no equation. The other, one
/// Newton step of implicit Euler, is linearly_implicit_euler. Order 1. Without damping it is symplectic, its
/// energy error is bounded for all times and it is stable for omega h < 2; a damper is taken explicitly,
/// which lowers the limit to h < (-c + sqrt(c^2 + 4 k m)) / k.
/// @cost   1 evaluation a step; no allocation after init()
/// @source [hairer2006geometric] I.1.2
template <class StateT>
class SymplecticEuler {
 public:
  using State = StateT;
  using Real = real_of<State>;
  static constexpr int order = 1;
  static constexpr int error_order = 0;
  static constexpr bool may_estimate_error = false;
  static constexpr bool is_explicit = true;

  /// Forgets the acceleration: the first attempt evaluates it.
  /// @param y  (q, v), shape (2 n)
  template <SecondOrderSystem Sys>
  void init(const Sys& system, Real, const State& y) {
    copy_state(y, slope_);
    copy_state(y, end_slope_);
    n_ = system.dofs();
    slope_known_ = end_slope_known_ = false;
  }

  /// y_new by one evaluation of f at (t, y), which is kept for attempts with another h.
  /// @returns always ok: no equations are solved
  template <SecondOrderSystem Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    if (!slope_known_) system.rhs(t, y, slope_);
    slope_known_ = true;
    end_slope_known_ = false;
    const Eigen::Index n = detail::dofs_of(y);
    detail::for_each_dof(y, [&](Eigen::Index i) {
      const auto v = y[n + i] + h * slope_[n + i];
      y_new[n + i] = v;
      // q_new = q + h v_new
      y_new[i] = y[i] + h * v;
    });
    return StepStatus::ok;
  }

  /// Commits the last attempt. The slope at its end is known when somebody looked between the ends.
  void accept(const State&) {
    slope_known_ = end_slope_known_;
    if (end_slope_known_) copy_state(end_slope_, slope_);
    end_slope_known_ = false;
  }

  /// Cubic Hermite polynomials; one evaluation, which the next step then saves.
  template <SecondOrderSystem Sys>
  void interpolate(const Sys& system, Real t, Real h, const State& y, const State& y_new, Real theta,
                   State& out) {
    if (!end_slope_known_) system.rhs(t + h, y_new, end_slope_);
    end_slope_known_ = true;
    detail::hermite_motion(
        h, y, y_new, [&](Eigen::Index i) { return slope_[n_ + i]; },
        [&](Eigen::Index i) { return end_slope_[n_ + i]; }, theta, out);
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(slope_known_);
    if (slope_known_) visit(slope_);
  }

 private:
  /// f = (v, a) at both ends of the step, shape (2 n).
  State slope_, end_slope_;
  Eigen::Index n_ = 0;
  bool slope_known_ = false, end_slope_known_ = false;
};

/// What the second kick of a step does about forces that depend on the velocity it is about to find.
enum class KickDamping {
  half_step,  ///< evaluates them at the velocity of the half step: velocity Verlet
  predicted,  ///< evaluates them at a predicted velocity: Stoermer-Verlet
  lumped,     ///< solves for the diagonal of the damping matrix: central differences
};

/// One step kick-drift-kick (leapfrog) at one evaluation: a_new is the a of the next step.
///   v_half = v + h/2 a,    q_new = q + h v_half,    v_new = v_half + h/2 a_new,
///   a_new = M^-1 F(t + h, q_new, v_new)
/// Order 2. Where F does not depend on v the step is symplectic and time-reversible, its energy error is
/// bounded for all times, and it is stable for omega h < 2.
///
/// With damping a_new depends on v_new. In its place
///   velocity Verlet:      M a_new = F(t + h, q_new, v_half),
///   Stoermer-Verlet:      M a_new = F(t + h, q_new, v_p),                      v_p = v + h a,
///   central differences:  (M + h/2 D) a_new = F(t + h, q_new, v_p) + h/2 D a,  D = diag(C).
/// v_half errs by O(h), so v_new by O(h^2) a step: velocity Verlet has order 1. v_p errs by O(h^2), so v_new
/// by O(h^3) a step whatever F and D are: the others keep order 2. Reversibility is lost.
///
/// The (q, v_half) of velocity Verlet are those of symplectic Euler, v_half += h M^-1 F(t, q, v_half): so is
/// its limit, omega h < 2 (sqrt(1 + zeta^2) - zeta).
///
/// Where damping is linear and diagonal, F = f(t, q) - D v, central differences solve the equation of a_new.
/// They are then the classical method of structural dynamics with its consistent start,
///   (M/h^2 + D/(2h)) q_new = f(t, q) + 2 M/h^2 q - (M/h^2 - D/(2h)) q_old,
///   q_old = q_0 - h v_0 + h^2/2 a_0    before the first step,
/// reversible, and stable for omega h < 2 whatever the damping. Stoermer-Verlet needs no damping matrix, but
/// is stable only for omega h < 2 (sqrt(1 + 4 zeta^2) - 2 zeta): c h / m < 1 where the damper is all there
/// is; velocity Verlet for c h / m < 2.
/// @cost   1 evaluation a step and one before the first; no allocation after init()
/// @source [swope1982computer], [hairer2006geometric] I.1.4, [hughes2000finite] 9.1
template <class StateT, KickDamping Damping>
class KickDriftKick {
 public:
  using State = StateT;
  using Real = real_of<State>;
  using Scalar = typename State::Scalar;
  /// Where F depends on v; otherwise 2.
  static constexpr int order = Damping == KickDamping::half_step ? 1 : 2;
  static constexpr int error_order = 0;
  static constexpr bool may_estimate_error = false;
  static constexpr bool is_explicit = true;
  static constexpr bool lumped = Damping == KickDamping::lumped;

  /// Starts with the acceleration that belongs to y. D is that of the start: the order does not depend on it.
  template <SecondOrderSystem Sys>
  void init(const Sys& system, Real t, const State& y) {
    copy_state(y, slope_);
    copy_state(y, new_slope_);
    system.rhs(t, y, slope_);
    if constexpr (lumped) {
      copy_state(y, damping_);
      copy_state(y, inverse_);
      lump_damping(system, t, y);
      inverse_of_ = Real(0);
    }
  }

  /// y_new by one evaluation of f at (t + h, q_new, v_half or v_p).
  /// @returns always ok: the damping equation is diagonal
  template <SecondOrderSystem Sys>
  StepStatus attempt(const Sys& system, Real t, const State& y, Real h, State& y_new) {
    const Eigen::Index n = detail::dofs_of(y);
    const Real half = h / 2;
    // q_new = q + h v_half, and v_half or v_p = v_half + h/2 a in the place of v_new.
    detail::for_each_dof(y, [&](Eigen::Index i) {
      const Scalar v_half = y[n + i] + half * slope_[n + i];
      y_new[i] = y[i] + h * v_half;
      y_new[n + i] = Damping == KickDamping::half_step ? v_half : v_half + half * slope_[n + i];
    });
    system.rhs(t + h, y_new, new_slope_);
    if constexpr (lumped) {
      // 1 / (1 + h/2 D / M), computed again when h changes.
      if (h != inverse_of_) [[unlikely]] {
        detail::for_each_dof(
            y, [&](Eigen::Index i) { inverse_[i] = Scalar(1) / (Scalar(1) + half * damping_[i]); });
        inverse_of_ = h;
      }
      // a_new = (M^-1 F(t + h, q_new, v_p) + h/2 M^-1 D a) / (1 + h/2 M^-1 D)
      detail::for_each_dof(y, [&](Eigen::Index i) {
        new_slope_[n + i] = (new_slope_[n + i] + half * damping_[i] * slope_[n + i]) * inverse_[i];
      });
    }
    // Not v + h/2 (a + a_new): only two operations on v wait for a_new.
    detail::for_each_dof(y, [&](Eigen::Index i) {
      const Scalar v_half = y[n + i] + half * slope_[n + i];
      y_new[n + i] = v_half + half * new_slope_[n + i];
    });
    return StepStatus::ok;
  }

  /// Commits the last attempt: its acceleration begins the next step.
  void accept(const State&) {
    if constexpr (is_small_state<State>)
      copy_state(new_slope_, slope_);
    else
      slope_.swap(new_slope_);
  }

  /// Cubic Hermite polynomials, q with v and v with a; no evaluation.
  template <SecondOrderSystem Sys>
  void interpolate(const Sys&, Real, Real h, const State& y, const State& y_new, Real theta,
                   State& out) const {
    const Eigen::Index n = detail::dofs_of(y);
    detail::hermite_motion(
        h, y, y_new, [&](Eigen::Index i) { return slope_[n + i]; },
        [&](Eigen::Index i) { return new_slope_[n + i]; }, theta, out);
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) {
    visit(slope_);
    if constexpr (lumped) visit(damping_, inverse_, inverse_of_);
  }

 private:
  /// damping_[i] = D_i / m_i, D = diag(C) at the start of the run.
  /// @throws std::invalid_argument  for a damped system whose masses are not lumped
  template <SecondOrderSystem Sys>
  void lump_damping(const Sys& system, Real t, const State& y) {
    const Eigen::Index n = system.dofs();
    const typename Sys::Dofs q = y.head(n), v = y.tail(n);
    typename Sys::DofMatrix C;
    if constexpr (!detail::is_variant<typename Sys::DofMatrix>) C.resize(n, n);
    system.damping(t, q, v, C);
    const auto lump = [&](const auto& matrix) {
      typename Sys::Dofs m;
      if constexpr (requires { system.mass_matrix(); }) {
        if (!system.mass_matrix().is_diagonal() && matrix.norm() > 0)
          throw std::invalid_argument("central_difference " + std::string(needs_lumped_masses));
        m = system.mass_matrix().diagonal();
      } else {
        m = system.mass();
      }
      for (Eigen::Index i = 0; i < n; ++i) damping_[i] = matrix.coeff(i, i) / m[i];
    };
    if constexpr (detail::is_variant<typename Sys::DofMatrix>)
      std::visit(lump, C);
    else
      lump(C);
  }

  /// slope_ = (v, a) at the start of a step, new_slope_ at its end.
  State slope_, new_slope_;
  /// Only central differences need memory for D.
  struct Nothing {};
  using IfLumped = std::conditional_t<lumped, State, Nothing>;
  [[no_unique_address]] IfLumped damping_;  ///< D / M, in the first half
  [[no_unique_address]] IfLumped inverse_;  ///< 1 / (1 + h/2 D / M), in the first half
  Real inverse_of_ = 0;                     ///< the h of inverse_
};

/// Orders where F depends on v: velocity Verlet 1, the other two 2.
template <class State>
using VelocityVerlet = KickDriftKick<State, KickDamping::half_step>;
template <class State>
using StormerVerlet = KickDriftKick<State, KickDamping::predicted>;
template <class State>
using CentralDifference = KickDriftKick<State, KickDamping::lumped>;

}  // namespace hmax
