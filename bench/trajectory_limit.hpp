/// Limits of the step where the model does not stay near rest: along a motion, and from a start of its own.
#pragma once

#include <optional>
#include <vector>

#include "bench/catalogue.hpp"

namespace hmax {

/// h_max of the tangent along a motion. It is no proof: a step longer than the least may be stable where the
/// motion passes that point quickly, and a shorter one unstable where modes turn into one another. It says
/// where to expect the limit, and why it is not that of rest.
struct TrajectoryLimit {
  std::vector<double> t,
      h_max;         ///< [s]; NaN where the tangent itself grows, infinity where it limits no step
  double least = 0;  ///< the smallest of them; infinity when nothing limits, NaN when no point has an answer
  double t_least = 0;       ///< where it occurs [s]
  Eigen::VectorXd y_least;  ///< the state there, shape (dim)
  double growing = 0;       ///< share of the points whose tangent grows
};

/// The motion from y0 to t_end is that of dormand_prince_54 at a tolerance of 1e-10, looked at `points`
/// times. Nothing for methods without an amplification, or that the problem does not suit.
/// @throws InputError  when t_end is no end of a run, or the motion does not reach it within the attempts
/// that adaptive runs have
std::optional<TrajectoryLimit> limit_along(const Method& method, const Problem& problem, double t_end,
                                           int points = 400);

/// The largest step up to which every run at fixed step from y0 to t_end stays within three times the largest
/// distance from the origin of the true motion, to one part in ten thousand: found upwards in strides of 2 %
/// from a tenth of `guess`, then by bisection. Infinity when steps up to a hundred guesses, or a tenth of the
/// run, do; nothing when the first one already does not, or the run is shorter than twenty guesses, or takes
/// more steps than that.
std::optional<double> limit_from_start(const Method& method, const Problem& problem, double t_end,
                                       double guess);

}  // namespace hmax
