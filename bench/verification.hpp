/// Predicted limits beside what integration with the code itself shows.
#pragma once

#include "bench/predict.hpp"

namespace hmax {

/// Integrates the problem with the code of the method on both sides of the prediction, from the limiting mode
/// plus a seeded perturbation, and puts what it shows into the row. Nothing where there is no number to
/// verify: methods that choose their steps, growing models.
void verify(Prediction& prediction, const Method& method, const Problem& problem, const Linearised& near);

}  // namespace hmax
