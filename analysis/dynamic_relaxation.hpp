/// Static equilibria by dynamic relaxation: the motion of a body that is stopped again and again.
#pragma once

#include <Eigen/Core>

#include "analysis/static_solution.hpp"

namespace hmax {

/// Lets the body move from q under its forces by steps of central differences with h = 1, with masses
///   m_i = sum_j |K_ij| / 2,   K = -dF/dq,
/// under which such steps are stable (Gershgorin), and stops it wherever its kinetic energy has a peak. It
/// needs no linear systems and no line search; q may pass through what is not admissible. A motion that gains
/// energy goes back to where it was stopped last, and on with more mass.
/// @param model      with an energy and a load
/// @param tolerance  |F| <= tolerance |F(0)|
/// @param steps      at most
/// @returns whether q has come to rest
/// @source  [underwood1983dynamic] for the masses, [barnes1999form] for the damping
bool relax_dynamically(const StaticModel& model, Eigen::VectorXd& q, double tolerance, int steps);

}  // namespace hmax
