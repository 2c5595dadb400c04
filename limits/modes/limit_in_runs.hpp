/// What runs that begin in the mode that limits the step show of that limit.
#pragma once

#include <cstdint>

#include "analysis/dynamics/growth.hpp"
#include "catalogue/methods/method.hpp"
#include "limits/modes/structure_start.hpp"
#include "limits/point/prediction.hpp"

namespace hmax {

/// The longest run that looks for a limit: so many numbers are stepped at most, seconds of a body.
std::int64_t most_steps(const Linearised& near);

/// The limit of a row with a limiting mode, or with the shape that limits it where the steps couple all
/// modes: watched in its amplitude, where a limit is seen soonest, as long as nothing else grows below; else
/// by the distance from rest.
/// @param run  of one part of a step, where the steps of the method are of parts; so is the result
ObservedLimit observe_limit(const Prediction& row, const Method& method, const Linearised& near,
                            const ModeStart& start, const ShowSteps& run);

}  // namespace hmax
