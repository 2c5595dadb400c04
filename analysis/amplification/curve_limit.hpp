/// The largest stable step over all modes of a proportionally damped model of which only the ends are known.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "analysis/spectrum/linear_model.hpp"
#include "analysis/spectrum/modes.hpp"

namespace hmax {

/// Every mode of M q'' + (alpha M + beta K) q' + K q = 0 is q'' + (alpha + beta kappa) q' + kappa q = 0 with
/// a kappa between the least and the largest eigenvalue of M^-1 K.
/// In the plane of (kappa, gamma) the modes lie on the line gamma = alpha + beta kappa.
struct DampingCurve {
  double alpha = 0;                     ///< [1/s]
  double beta = 0;                      ///< [s]
  double kappa_min = 0, kappa_max = 0;  ///< [1/s^2]

  [[nodiscard]] MechanicalMode at(double kappa) const { return {kappa, alpha + beta * kappa}; }
};

/// alpha and beta of C = alpha M + beta K, from products of the matrices with a few vectors.
/// With k = M^-1/2 K M^-1/2 and c alike, c x = alpha x + beta k x of one vector x gives both numbers; two
/// more vectors check them to 1e-11 of |c x|.
/// @return  nothing for dampings that are not of this kind: (C - alpha M - beta K) x leaves more than
/// rounding
std::optional<std::array<double, 2>> rayleigh_coefficients(const MechanicalPart& part);

/// The smallest first exit along a curve.
struct CurveLimit {
  double h_max = 0;      ///< [s]; infinity without one
  double kappa = 0;      ///< where [1/s^2]
  bool between = false;  ///< at neither end: the modes there may be stable at larger steps, none at smaller
};

/// First exits of modes, as largest_stable_step makes them [s].
using ExitsOf = std::function<std::vector<double>(std::span<const MechanicalMode>)>;

/// Both ends, `samples` places between them in proportion to kappa and as many in proportion to its
/// logarithm, and again between the neighbours of the smallest, five times: as sure as that many samples are,
/// and no dearer for a million modes than for a hundred.
/// @param exits    called with all places of a round at once, and both ends of the curve after them
/// @param samples  intervals in each of the two spacings of a round
/// @return  h_max infinity when no mode of the curve leaves
CurveLimit smallest_exit(const DampingCurve& curve, const ExitsOf& exits, int samples = 60);

}  // namespace hmax
