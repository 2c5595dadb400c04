/// Predicted limits beside what integration with the code itself shows.
#pragma once

#include "bench/limits/operating_point.hpp"
#include "bench/limits/prediction.hpp"

namespace hmax {

/// Integrates the problem with the code of the method on both sides of the prediction, from the limiting mode
/// plus a seeded perturbation, and puts what it shows into the row; `bound` becomes `newton` where the
/// equations of steps without limit are not solved. Nothing where there is no number to verify (methods that
/// choose their steps, growing models, models without a mode that moves); a `note` where runs would take too
/// much: driven models of many states, dense factors of large Jacobians.
void verify(Prediction& row, const Method& method, const Problem& problem, const Linearised& near);

}  // namespace hmax
