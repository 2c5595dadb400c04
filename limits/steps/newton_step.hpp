/// How long a step may be where no step is unstable: as long as Newton's method solves its equations.
#pragma once

#include <optional>

#include "catalogue/methods/method.hpp"
#include "core/size_limits.hpp"

namespace hmax {

/// The largest step from the initial state of a body whose equations a method solves.
struct NewtonStep {
  double h = 0;           ///< [s], to 5 %: every shorter one that was tried is solved
  bool is_limit = false;  ///< false: `h` is the longest step that is tried, and it is solved
  double error = 0;       ///< of the displacements after it, of the point that is furthest off [m]; NaN where
                          ///< the reference does not reach that time
  double error_bound = 0;  ///< how far the reference of that error may be off [m]
};

/// Tries steps from 1 ms on, each twice as long as the last, up to 1 s, and closes in on the first that is
/// not solved by bisection. The reference of the error takes the same time in 100 to 400 steps of newmark.
/// Nothing for what is no body or too large, and where even a step of 1 microsecond is not solved.
/// @param method  one that solves equations at fixed steps
std::optional<NewtonStep> largest_newton_step(const Method& method, const Problem& problem);

}  // namespace hmax
