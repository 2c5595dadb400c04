/// Between which damping and stiffness the modes of a structure lie whose damping couples its modes.
#pragma once

#include <vector>

#include "analysis/amplification/curve_limit.hpp"
#include "analysis/spectrum/linear_model.hpp"
#include "analysis/spectrum/modes.hpp"

namespace hmax {

/// Every eigenvalue of (lambda^2 M + lambda C + K) u = 0 solves
///   lambda^2 + gamma lambda + kappa = 0,  gamma = u* C u, kappa = u* K u, u* M u = 1,
/// and the pairs (gamma, kappa) of all shapes u are a convex set, the numerical range of c + i k
/// [horn1991topics, chapter 1]. This is a polygon around it.
struct DampingRange {
  std::vector<MechanicalMode> corners;  ///< in their order around it

  /// Leaves what has a gamma + b kappa <= c.
  void cut(double a, double b, double c);
};

/// Tangents in some twenty directions, each by a Lanczos iteration, shared by all cores; and gamma, kappa >= 0.
/// The tangent in the direction (cos t, sin t) is gamma cos t + kappa sin t <= the largest eigenvalue of c
/// cos t + k sin t, in scaled units; residuals are added to the eigenvalues, so that the polygon contains
/// the range.
/// @param part  K and C symmetric, without negative eigenvalues
DampingRange damping_range(const MechanicalPart& part);

/// The largest rho to three digits for which gamma >= rho kappa of all shapes [s]: C - rho K has no negative
/// pivot (Sylvester's law of inertia). Tells more than the tangents of slow modes, and takes some ten
/// factors.
/// @return  0 where none is found
double least_damping_per_stiffness(const MechanicalPart& part);

/// The smallest first exit in a range, and where.
struct RangeLimit {
  double h_max = 0;  ///< [s]; infinity without one
  MechanicalMode mode;
};

/// The smallest first exit of oscillating pairs, gamma^2 < 4 kappa, of the range. An exit falls with the rate
/// of a mode whose ratio of damping is kept, so that it lies on the edge of the range.
RangeLimit smallest_exit(const DampingRange& range, const ExitsOf& exits, int samples = 32);

}  // namespace hmax
