/// The largest stable step of a method near an operating point, predicted from its modes and the
/// amplification.
#pragma once

#include <string>

#include "limits/linearised_problem.hpp"
#include "limits/point/prediction.hpp"

namespace hmax {

/// Depends on nothing but its arguments.
/// @param modes  those of point.model, as by mode_set()
Prediction predict(const Method& method, const OperatingPoint& point, const ModeSet& modes);
inline Prediction predict(const Method& method, const Linearised& near) {
  return predict(method, near.point, near.modes);
}

/// What the model does by itself where one of its modes grows: how fast, in which time it doubles, and what
/// to do.
std::string growth_in_words(const Mode& growing, const OperatingPoint& point);

}  // namespace hmax
