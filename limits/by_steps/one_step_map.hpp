/// One step of a method of the catalogue as a map of states, or several.
#pragma once

#include "analysis/dynamics/differences.hpp"
#include "catalogue/methods/method.hpp"

namespace hmax {

/// y -> Phi_h(y), one step of length h [s] from t = 0 by the code that steps in every run, with the Jacobian
/// taken anew; NaN where the step diverges or its equations have no solution. One thread at a time.
/// @param problem  autonomous
/// @throws InputError when the method takes no fixed steps, h is not positive, the problem is not one for it,
///                    or its steps are no iterates of one map, because it remembers more than the last state
VectorFunction one_step_map(const Method& method, const Problem& problem, double h);

/// The same of all steps of length h [s] from t = 0 to t_end [s]; the problem may depend on time.
VectorFunction steps_map(const Method& method, const Problem& problem, double h, double t_end);

}  // namespace hmax
