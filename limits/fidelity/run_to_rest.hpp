/// Where a run from rest ends, with its kinetic energy taken out.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "analysis/dynamics/differences.hpp"
#include "core/mass_matrix.hpp"

namespace hmax {

struct RunToRest {
  Eigen::VectorXd
      q;  ///< displacement [m], shape (dofs); empty where it still moves, or leaves the range of numbers
  int steps = 0;
};

/// A run from q = 0 at rest whose velocities are set to zero whenever a step lowers its kinetic energy, so
/// that it comes to rest without oscillations: dynamic relaxation with kinetic damping.
/// @source [barnes1999form]
/// @param step   (q, v) -> Phi(q, v), shape (2 dofs)
/// @param mass   M, shape (dofs, dofs) [kg]
/// @param left   as of settled_state(): it ends where a step from rest goes a thousandth of that share of q
/// @param watch  called before each step; may throw
RunToRest run_to_rest(const VectorFunction& step, const MassMatrix<double>& mass, double left,
                      const std::function<void()>& watch = {});

}  // namespace hmax
