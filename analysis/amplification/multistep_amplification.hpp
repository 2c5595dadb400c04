/// The amplification of linear multistep methods and of predictor-corrector pairs: the root condition.
#pragma once

#include "analysis/amplification/amplification.hpp"
#include "integrators/multistep/adams.hpp"

namespace hmax {

/// The largest order that the weights of the house are made for.
inline constexpr int most_adams_steps = 12;

/// An Adams method as the stepper of adams.hpp does it, with the order k of its predictor and the order of
/// its corrector, k or k + 1. Of pec the map is that of the predicted values, which its past consists of.
/// Weights from backward differences [hairer1993solving, III.1]. With rho, sigma of a formula, pi =
/// rho(zeta) - z sigma(zeta); pece has z^2 too, since the predicted rate enters the corrector:
///   y_n+1 = y_n + z beta*_0 p_n+1 + z sum_{i >= 1} beta*_i y_n+1-i,   p_n+1 = y_n + z sum_i beta_i y_n-i.
/// @param predictor_order  1 .. most_adams_steps
/// @param corrector_order  1 .. most_adams_steps + 1; of no account for AdamsMode::bashforth
Amplification adams_amplification(AdamsMode mode, int predictor_order, int corrector_order);

/// The implicit formula of Adams and Moulton alone, its equation solved exactly.
/// y_n+1 = y_n + z sum_{i = 0} beta*_i y_n+1-i; of order k it looks back k - 1 steps, of order 1 (backward
/// Euler) one.
/// @param order  1 .. most_adams_steps + 1; order 2 is the trapezoidal rule
Amplification adams_moulton_amplification(int order);

/// Backward differentiation,  sum_{j = 1}^k nabla^j y_n+1 / j = z y_n+1  [hairer1993solving, III.1 (1.22)].
/// A(alpha)-stable with alpha = 90, 90, 86.03, 73.35, 51.84, 17.84 degrees of k = 1 .. 6
/// [hairer1996solving, V.2]; beyond 6 not zero-stable.
/// @param order  1 .. 6
Amplification bdf_amplification(int order);

}  // namespace hmax
