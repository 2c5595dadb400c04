/// Limits on structures so large that only their slowest and their fastest mode are known.
#pragma once

#include <string>
#include <vector>

#include "bench/predict.hpp"

namespace hmax {

/// Puts the ends of the spectrum of a large structure with proportional damping into `near`. False, and
/// nothing done, for all other models.
/// @param small  up to so many degrees of freedom a structure is not large
bool set_curve(Linearised& near, Eigen::Index small = most_dense_modes);

/// The least limit of a method along the curve of all modes between those ends.
struct LimitOnCurve {
  double h_max = 0;               ///< [s]
  Complex lambda;                 ///< of the mode that sets it
  std::vector<ModeMargin> modes;  ///< both ends, and the limiting mode where it lies between
  std::string note;               ///< a sentence where it does: no mode may lie exactly there
};

/// @param radius  that the method is told [1/s]
LimitOnCurve limit_on_curve(const Amplification& amplification, const Linearised& near, double radius);

}  // namespace hmax
