/// The order of convergence that a method shows: the slope of log error over log h.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace hmax {

/// The points that the slope was fitted to, coarse to fine; all empty when the errors fall nowhere.
/// observed = sum (x_i - x)(y_i - y) / sum (x_i - x)^2 with x = log h, y = log error and their means.
struct OrderObservation {
  double t_end = 0;                ///< end time of the runs [s]
  std::vector<double> h, error;    ///< steps [s], and errors at t_end
  std::optional<double> observed;  ///< slope of the line of least squares
};

/// Refines the step by the square root of 2, from a quarter of the run on, until errors come near rounding,
/// and fits a line to the four finest points.
///
/// The global error is C(t) h^p + D(t) h^(p+1) + ... [hairer1993solving] section II.8. The finest steps above
/// rounding show p best, but not at a time where C(t) is near zero, as happens again and again in an
/// oscillation: there the next term rules and the slope drifts. So several end times are tried, and the one
/// whose three local slopes agree best is reported. The order that is expected has no say in the choice.
/// @param error_of   error at t_end of a run with step h, both in s; t_end is a whole number of steps
/// @param end_times  [s], positive
/// @param floor      errors up to this are rounding or the reference's own and take no part
/// @param most_steps of one run
/// @return  `observed` empty when no end time has four errors above `floor` that are finite
/// @cost    runs of 4, 5.7, 8, ... most_steps steps for each end time
OrderObservation observe_order(const std::function<double(double t_end, double h)>& error_of,
                               std::span<const double> end_times, double floor, double most_steps = 20000);

}  // namespace hmax
