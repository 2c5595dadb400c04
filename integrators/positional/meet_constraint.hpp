/// How one compliant constraint is met: the one source of processors and devices.
#pragma once

#include <optional>

#include "core/instructions/device_code.hpp"

namespace hmax {

/// What the constraints of a step have in common, see CompliantConstraints.
struct MeetingRule {
  double square = 0;      ///< h^2 [s^2]
  double viscous = 0;     ///< g = beta / h
  double share = 1;       ///< of a constraint that is met
  bool is_stiff = false;  ///< it has no compliance
  bool operator==(const MeetingRule&) const = default;
};

/// @param share  of a constraint that is met, where it has no compliance and no damping
/// @param beta   of the damping by stiffness [s]
inline MeetingRule meeting_rule(const std::optional<double>& share, double h, double beta) {
  if (share) return {.share = *share, .is_stiff = true};
  return {.square = h * h, .viscous = beta / h};
}

/// Changes lambda and the displacements of its points.
/// @tparam Points  of point i: moves(i) whether it is free, gradient(i) where dC/dq_i stands, weight(i) w_i,
///                 q(i, axis) its displacement, which is changed, start(i, axis) that at the start of the
///                 step
template <class Points>
HMAX_DEVICE inline void meet_constraint(const MeetingRule& rule, double value, double compliance,
                                        const Points& points, int count, double& lambda) {
  if (rule.is_stiff)
    compliance = 0;
  else
    compliance = compliance / rule.square;
  double sum = 0, change = 0;  // sum of w |dC|^2, and dC.(q - q_0)
  for (int i = 0; i < count; ++i)
    if (points.moves(i)) {
      const double* const slope = points.gradient(i);
      sum = sum + (slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2]) * points.weight(i);
      const auto moved = [&](int axis) { return slope[axis] * (points.q(i, axis) - points.start(i, axis)); };
      if (rule.viscous > 0) change = change + (moved(0) + moved(1) + moved(2));
    }
  const double divisor = (1 + rule.viscous) * sum + compliance;
  if (!(divisor > 0)) return;  // nothing that it moves
  const double step = rule.share * (-value - compliance * lambda - rule.viscous * change) / divisor;
  lambda = lambda + step;
  for (int i = 0; i < count; ++i)
    if (points.moves(i)) {
      const double far = step * points.weight(i);
      for (int axis = 0; axis < 3; ++axis)
        points.q(i, axis) = points.q(i, axis) + far * points.gradient(i)[axis];
    }
}

}  // namespace hmax
