/// The largest stable step of a method on a problem, predicted from spectrum and amplification.
#pragma once

#include "bench/limits/linearised_problem.hpp"
#include "bench/limits/prediction.hpp"

namespace hmax {

/// Predicts for one method.
/// @param near  the problem linearised, as by linearised(problem)
Prediction predict(const Method& method, const Problem& problem, const Linearised& near);

}  // namespace hmax
