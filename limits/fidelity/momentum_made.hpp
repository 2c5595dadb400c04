/// What a step makes of the momentum of a body that nothing acts on.
#pragma once

#include <limits>

#include <Eigen/Core>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// Momentum after a step from rest, with the forces of the material alone: what a step should keep is zero.
struct MomentumMade {
  double linear = std::numeric_limits<double>::quiet_NaN();  ///< |sum m v| / sum m |v|
  double angular =
      std::numeric_limits<double>::quiet_NaN();  ///< |sum m r x v| / sum m |r x v|, about the centre
};

/// Of a body that is let go from displacements q without loads, supports and damping. NaN where the step
/// cannot be done.
/// @param q  shape (dofs)
/// @param h  [s]
MomentumMade momentum_made(const Method& method, const Problem& problem, const Eigen::VectorXd& q, double h);

}  // namespace hmax
