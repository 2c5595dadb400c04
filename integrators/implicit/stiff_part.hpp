/// The stiff part of a split system, for whoever solves for it alone.
#pragma once

#include "integrators/mechanical.hpp"
#include "integrators/state.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// The stiff part of a split system f = stiff + nonstiff as a system of its own, with its Jacobian:
/// y' = stiff(t, y), shape (n). A method that solves for the stiff part alone so calls the same verbs as one
/// that solves for f. It refers to the system.
template <SplitSystem Sys>
class StiffPart {
 public:
  using State = typename Sys::State;
  using Real = real_of<State>;
  using Jacobian = jacobian_type<Sys>;

  /// @param system  must outlive this one
  explicit StiffPart(const Sys& system) : system_(system) {}
  [[nodiscard]] Eigen::Index dim() const { return system_.dim(); }
  /// dydt = stiff(t, y), shape (n).
  void rhs(Real t, const State& y, State& dydt) const { system_.rhs_stiff(t, y, dydt); }
  /// J = d stiff / dy at (t, y), shape (n, n).
  void jacobian(Real t, const State& y, Jacobian& J) const { system_.jacobian_stiff(t, y, J); }

 private:
  const Sys& system_;
};

/// The same of a structure, whose equations are reduced to its velocities, see ShiftedMechanical: one
/// symmetric matrix M + s C0 + s^2 K0 of half the size. It has the verbs of a second-order system.
template <SplitStructure Sys>
class StiffPart<Sys> {
 public:
  using State = typename Sys::State;
  using Real = real_of<State>;
  using Jacobian = jacobian_type<Sys>;
  using Dofs = typename Sys::Dofs;
  using DofMatrix = typename Sys::DofMatrix;

  /// @param system  must outlive this one
  explicit StiffPart(const Sys& system) : system_(system) {}
  [[nodiscard]] Eigen::Index dim() const { return system_.dim(); }
  /// dydt = (v, -M^-1 (K0 q + C0 v)) at y = (q, v), shape (2 dofs).
  void rhs(Real t, const State& y, State& dydt) const { system_.rhs_stiff(t, y, dydt); }
  /// J = d stiff / dy, shape (2 dofs, 2 dofs), not symmetric; the reduced equations do without it.
  void jacobian(Real t, const State& y, Jacobian& J) const { system_.jacobian_stiff(t, y, J); }
  /// 0 where an erased system has no such matrices.
  [[nodiscard]] Eigen::Index dofs() const { return hmax::has_stiff_structure(system_) ? system_.dofs() : 0; }
  /// Whether M, K0 and C0 are there and sparse; where not, the Jacobian above serves.
  [[nodiscard]] bool has_sparse_matrices() const { return hmax::has_stiff_structure(system_); }
  /// Diagonal of M [kg], shape (dofs): that of the whole system, of which the stiff part has no other.
  [[nodiscard]] Dofs mass() const { return system_.mass(); }
  /// f = -(K0 q + C0 v) [N], shape (dofs). Asked for by the concept of second-order systems only, so it may
  /// allocate: M times the accelerations, the lower half of the stiff part.
  void force(Real t, const Dofs& q, const Dofs& v, Dofs& f) const {
    State y(2 * q.size()), dydt(2 * q.size());
    y << q, v;
    rhs(t, y, dydt);
    f = mass().cwiseProduct(dydt.tail(q.size()));
  }
  /// K = K0 [N/m], shape (dofs, dofs), and C = C0 [N s/m] below: constant, so time and state do not matter.
  void stiffness(Real, const Dofs&, const Dofs&, DofMatrix& K) const { system_.stiffness_stiff(K); }
  void damping(Real, const Dofs&, const Dofs&, DofMatrix& C) const { system_.damping_stiff(C); }

 private:
  const Sys& system_;
};

namespace detail {
/// A system that is not split: no part is stiff, and nothing is reduced.
template <class Sys>
struct StiffEquations {
  using type = jacobian_type<Sys>;
};
/// A split one: of a structure its parts M, K0 and C0, of an erased system one of several kinds.
template <SplitSystem Sys>
struct StiffEquations<Sys> {
  using type = equations_type<StiffPart<Sys>>;
};
}  // namespace detail

/// The type in which implicit-explicit methods keep the Jacobian of the stiff part of a system; of systems
/// that are not split jacobian_type.
template <class Sys>
using stiff_equations_type = typename detail::StiffEquations<Sys>::type;

}  // namespace hmax
