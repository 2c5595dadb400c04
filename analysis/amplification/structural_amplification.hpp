/// The amplification of the methods that step positions and velocities, on q'' + gamma q' + kappa q = 0.
/// Their maps are 2 x 2 or, with the acceleration that a step hands to the next, 3 x 3 matrices; here are
/// their characteristic polynomials, rational in h.
#pragma once

#include "analysis/amplification/amplification.hpp"
#include "integrators/structural/generalized_alpha.hpp"
#include "integrators/structural/structural.hpp"

namespace hmax {

/// zeta^2 - (2 - h gamma - h^2 kappa) zeta + 1 - h gamma
/// v' = v - h (gamma v + kappa q), q' = q + h v': the matrix of (q, v) is
///   (1 - h^2 kappa, h (1 - h gamma); -h kappa, 1 - h gamma)
/// with determinant 1 - h gamma. It leaves at zeta = -1, 4 - 2 h gamma - h^2 kappa = 0: omega h = 2
/// undamped, with omega = sqrt(kappa); h = (-gamma + sqrt(gamma^2 + 4 kappa)) / kappa damped.
Amplification symplectic_euler_amplification();

/// With s = zeta - 1, W = (1 + zeta) / 2 and the acceleration a carried along.
///
/// For forces at the velocity of the half step, whose (q, v_half) are those of symplectic Euler:
///   s^2 + h^2 kappa zeta + h gamma s.
///
/// For forces at the predicted velocity v + h a:
///   zeta s^2 + h^2 kappa zeta^2 + h gamma (W s + s^2).
///
/// With the damping of the dof itself solved for:
///   s^2 + h^2 kappa zeta + h gamma (zeta^2 - 1) / 2,
/// of several dofs
///   zeta s^2 M + h^2 zeta^2 K + h (W s + s^2) C + h s^3 / 2 diag C.
/// Undamped all of these are the velocity Verlet method [swope1982computer],
/// s^2 + h^2 kappa zeta, but for roots at zero: omega h <= 2.
Amplification kick_drift_kick_amplification(KickDamping damping);

/// With W = 1 - gamma + gamma zeta, B = 1/2 - beta + beta zeta of the method's beta and gamma,
/// F = (1 - alpha_f) zeta + alpha_f and M = (1 - alpha_m) zeta + alpha_m,
///   M s^2 + h gamma F W s + h^2 kappa F (W + B s),
/// where gamma is that of the mode [hughes2000finite, 9.3], [chung1993time].
/// Newmark's method has alpha_m = alpha_f = 0: unconditionally stable for 2 beta >= gamma >= 1/2; else,
/// with gamma = 1/2 and undamped, omega h <= 1 / sqrt(1/4 - beta).
Amplification generalized_alpha_amplification(const AlphaParameters& parameters);

/// Whether the steps of a method of order two in q and v are stable for every oscillation q'' + gamma q' +
/// kappa q = 0 with gamma >= 0, kappa > 0 and every h: from its conditions at damping ratios 0 ... 10.
/// Zeta = 0, 1e-3, 0.01, 0.1, 0.3, 0.6, 1, 2 and 10 with kappa = 1: other kappa only rescale h. Proved for
/// each ratio, not between them.
bool is_unconditionally_stable(const Amplification& amplification);

/// Whether nothing is left of infinitely fast oscillations after the steps that the method looks back.
/// By the spectral radius in the limit h sqrt(kappa) -> infinity, below `annihilated`.
bool annihilates_fast_modes(const Amplification& amplification);

}  // namespace hmax
