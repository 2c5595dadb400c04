/// Predicted limits beside what integration with the code itself shows.
#pragma once

#include "bench/predict.hpp"

namespace hmax {

/// Integrates the problem with the code of the method on both sides of the prediction, from the limiting mode
/// plus a seeded perturbation, and puts what it shows into the row; `bound` becomes `newton` where the
/// equations of steps without limit are not solved. Nothing where there is no number to verify (methods that
/// choose their steps, growing models, models without a mode that moves); a `note` where runs would take too
/// much: driven models of many states, dense factors of large Jacobians.
void verify(Prediction& row, const Method& method, const Problem& problem, const Linearised& near);

/// Whether runs on a model of so many states are not worth their time: Odeint's implicit steppers know no
/// sparse matrices, and make new factors for every step.
bool is_too_slow(const Method& method, Eigen::Index states);

}  // namespace hmax
