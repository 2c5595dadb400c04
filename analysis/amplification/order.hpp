/// The order of convergence that a method shows: the slope of log error over log h.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace hmax {

/// Why no order is observed.
enum class OrderLack {
  none,           ///< an order is observed
  diverged,       ///< errors as large as the solution, also at the finest steps
  rounded,        ///< errors at rounding level, also at the coarsest steps
  narrow,         ///< too few steps lie between errors as large as the solution and rounding
  stalled,        ///< errors that finer steps do not lower, far above rounding
  not_asymptotic  ///< errors fall, but not yet as a power of h
};
/// "diverged", "rounded", "narrow", "stalled", "not_asymptotic"; empty for none.
std::string_view name_of(OrderLack lack);

/// The points that the slope was fitted to, coarse to fine; where no slope is, those of the last end time
/// that was tried. observed = sum (x_i - x)(y_i - y) / sum (x_i - x)^2 with x = log h, y = log error and
/// their means.
struct OrderObservation {
  double t_end = 0;                ///< end time of the runs [s]
  std::vector<double> h, error;    ///< steps [s], and errors at t_end, finite
  std::optional<double> observed;  ///< slope of the line of least squares
  OrderLack lack = OrderLack::none;
  std::optional<double> h_diverged;  ///< the smallest step with an error as large as the solution [s]
  std::optional<double> h_rounded;   ///< the largest step with an error at rounding level [s]
};

/// What errors are compared with.
struct OrderScale {
  double floor = 0;  ///< errors up to this are rounding or the reference's own and take no part
  double size = std::numeric_limits<double>::infinity();  ///< of the solution: errors from a tenth of it on
                                                          ///< do not converge
};

/// Refines the step by the square root of 2, from a quarter of the run on, until errors come near rounding,
/// and fits a line to the four finest points of the asymptotic range.
///
/// The global error is C(t) h^p + D(t) h^(p+1) + ... [hairer1993solving] section II.8. The finest steps above
/// rounding show p best, but not at a time where C(t) is near zero, as happens again and again in an
/// oscillation: there the next term rules and the slope drifts. So several end times are tried, and the one
/// whose three local slopes agree best is reported. The order that is expected has no say in the choice.
///
/// The range begins behind the last step whose error is a tenth of the solution or not finite. It ends where
/// finer steps no longer lower the error by a fifth, or errors scatter: rounding above `floor`, and ten times
/// that. Slopes that differ by more than 0.5 are no order.
/// @param error_of   error at t_end of a run with step h, both in s; t_end is a whole number of steps
/// @param end_times  [s], positive
/// @param most_steps of one run
/// @cost    runs of 4, 5.7, 8, ... most_steps steps for each end time
OrderObservation observe_order(const std::function<double(double t_end, double h)>& error_of,
                               std::span<const double> end_times, const OrderScale& scale,
                               double most_steps = 20000);

}  // namespace hmax
