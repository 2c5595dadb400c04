/// The state in which the steps of a method come to rest.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "analysis/dynamics/differences.hpp"

namespace hmax {

struct SettledState {
  Eigen::VectorXd q;     ///< displacements [m], shape (dofs); the last iterate where nothing settles
  bool settled = false;  ///< |Phi_q(q, 0) - q| is nothing beside |q|
  double residual = 0;   ///< |Phi_q(q, 0) - q| / |q|, or beside a larger size
  int steps = 0;         ///< evaluations of Phi
};

/// A root of Phi_q(q, 0) = q, where Phi_q are the displacements after a step from rest: the map that lets the
/// body go from where it is, iterated with Anderson's acceleration. A root may be unstable.
/// @param step   y -> Phi(y), y = (q, v) of shape (2 dofs); NaN where a step cannot be done
/// @param start  q of shape (dofs), not zero
/// @param left   about which share of its distance the slowest part of q goes in a step from rest, at most 1:
///               the residual is so much smaller than the error
/// @param watch  called before each step; may throw
/// @param size   |q| that residuals are compared with where q is smaller
SettledState settled_state(const VectorFunction& step, const Eigen::VectorXd& start, double left = 1,
                           const std::function<void()>& watch = {}, double size = 0);

}  // namespace hmax
