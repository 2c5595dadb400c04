/// The amplification of a method as steps of its code show it, for engines that bring no formula.
#pragma once

#include "analysis/amplification/amplification.hpp"
#include "catalogue/methods/method.hpp"

namespace hmax {

/// y' = lambda y in the real numbers: (u, v)' = ((Re, -Im), (Im, Re)) (u, v), y = u + i v, from y = 1. What
/// the mode says of its stiff part, its frozen Jacobian and the spectral radius is what methods are told.
Problem spiral(const Eigenmode& mode);

/// R as one step of size 1 makes it, where lambda is z.
Complex measured_step(const Method& method, const Eigenmode& mode);

/// By what a long run multiplies |y| in a step in the end. For methods that look back over several steps, of
/// which one alone says too little.
double measured_growth(const Method& method, Complex z);

/// An amplification from such steps: of one, or of a long run where a step reads those before it.
Amplification measured_amplification(const Method& method);

}  // namespace hmax
