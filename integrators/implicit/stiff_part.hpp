/// The stiff part of a split system, for whoever solves for it alone.
#pragma once

#include "integrators/mechanical.hpp"
#include "integrators/state.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// The stiff part of a split system as a system of its own, with its Jacobian. It refers to the system.
template <SplitSystem Sys>
class StiffPart {
 public:
  using State = typename Sys::State;
  using Real = real_of<State>;
  using Jacobian = jacobian_type<Sys>;

  /// @param system  must outlive this one
  explicit StiffPart(const Sys& system) : system_(system) {}
  [[nodiscard]] Eigen::Index dim() const { return system_.dim(); }
  void rhs(Real t, const State& y, State& dydt) const { system_.rhs_stiff(t, y, dydt); }
  void jacobian(Real t, const State& y, Jacobian& J) const { system_.jacobian_stiff(t, y, J); }

 private:
  const Sys& system_;
};

/// The same of a structure, whose equations are reduced to its velocities, see ShiftedMechanical.
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
  void rhs(Real t, const State& y, State& dydt) const { system_.rhs_stiff(t, y, dydt); }
  void jacobian(Real t, const State& y, Jacobian& J) const { system_.jacobian_stiff(t, y, J); }
  /// 0 where an erased system has no such matrices.
  [[nodiscard]] Eigen::Index dofs() const { return hmax::has_stiff_structure(system_) ? system_.dofs() : 0; }
  [[nodiscard]] bool has_sparse_matrices() const { return hmax::has_stiff_structure(system_); }
  [[nodiscard]] Dofs mass() const { return system_.mass(); }
  /// Asked for by the concept of second-order systems only.
  void force(Real t, const Dofs& q, const Dofs& v, Dofs& f) const {
    State y(2 * q.size()), dydt(2 * q.size());
    y << q, v;
    rhs(t, y, dydt);
    f = mass().cwiseProduct(dydt.tail(q.size()));
  }
  void stiffness(Real, const Dofs&, const Dofs&, DofMatrix& K) const { system_.stiffness_stiff(K); }
  void damping(Real, const Dofs&, const Dofs&, DofMatrix& C) const { system_.damping_stiff(C); }

 private:
  const Sys& system_;
};

namespace detail {
template <class Sys>
struct StiffEquations {
  using type = jacobian_type<Sys>;
};
template <SplitSystem Sys>
struct StiffEquations<Sys> {
  using type = equations_type<StiffPart<Sys>>;
};
}  // namespace detail

/// The type in which implicit-explicit methods keep the Jacobian of the stiff part of a system; of systems that are
/// not split jacobian_type.
template <class Sys>
using stiff_equations_type = typename detail::StiffEquations<Sys>::type;

}  // namespace hmax
