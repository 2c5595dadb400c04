/// The amplification of linear multistep methods and of predictor-corrector pairs: the root condition.
#pragma once

#include "analysis/amplification/amplification.hpp"
#include "integrators/multistep/adams.hpp"

namespace hmax {

/// The largest order that the weights of the house are made for.
inline constexpr int most_adams_steps = 12;

/// An Adams method as the stepper of adams.hpp does it, with the order k of its predictor and the order of
/// its corrector, k or k + 1. Of pec the map is that of the predicted values, which its past consists of.
/// @param predictor_order  1 .. most_adams_steps
/// @param corrector_order  1 .. most_adams_steps + 1; of no account for AdamsMode::bashforth
Amplification adams_amplification(AdamsMode mode, int predictor_order, int corrector_order);

/// The implicit formula of Adams and Moulton alone, its equation solved exactly.
Amplification adams_moulton_amplification(int order);

/// Backward differentiation,  sum_{j = 1}^k nabla^j y_n+1 / j = z y_n+1  [hairer1993solving, III.1 (1.22)].
/// @param order  1 .. 6
Amplification bdf_amplification(int order);

}  // namespace hmax
