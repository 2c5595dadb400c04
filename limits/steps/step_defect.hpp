/// Whether a method steps as its amplification says.
#pragma once

#include "catalogue/methods/method.hpp"

namespace hmax {

/// What rounding makes of a step_defect() at most; the tables of foreign engines have sixteen digits.
inline constexpr double rounding_of_steps = 1e-10;

/// How far a few steps of the code are from those that its amplification stands for, relative to their terms:
/// one step on y' = lambda y, where lambda is stiff in part, or the Jacobian that is told is another;
/// for methods that look back the recurrence of their steps; for those of positions and velocities that of
/// M q'' + C q' + K q = 0 with two bodies and coupling dampers. A coefficient that a step reads, but for
/// nodes, changes it by about as much as it changes itself, whether the limit of the step moves or not.
/// 0 for methods whose amplification is measured, or that have no code.
double step_defect(const Method& method);

}  // namespace hmax
