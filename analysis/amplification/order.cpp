#include "analysis/amplification/order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hmax {

namespace {

// Points that the line is fitted to: three local slopes.
constexpr std::ptrdiff_t window = 4;

/// log(error) = slope log(h) + const.
struct Line {
  double slope;   ///< of least squares
  double spread;  ///< largest difference between the slopes from point to point
};

/// Least squares: slope = sum (x - mean x)(y - mean y) / sum (x - mean x)^2, x = log h, y = log error.
Line fit(const std::vector<double>& h, const std::vector<double>& error) {
  const auto n = static_cast<double>(h.size());
  double x_mean = 0, y_mean = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    x_mean += std::log(h[i]) / n;
    y_mean += std::log(error[i]) / n;
  }
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double x = std::log(h[i]) - x_mean;
    xx += x * x;
    xy += x * (std::log(error[i]) - y_mean);
    if (i == 0) continue;
    // From one point to the next, for how well a line describes them.
    const double local = std::log(error[i - 1] / error[i]) / std::log(h[i - 1] / h[i]);
    least = std::min(least, local);
    most = std::max(most, local);
  }
  return {xy / xx, most - least};
}

}  // namespace

// For each end time: refine until the error is at most `floor`, keep the four finest, fit. The end time
// with the smallest spread of local slopes wins.
OrderObservation observe_order(const std::function<double(double t_end, double h)>& error_of,
                               std::span<const double> end_times, double floor, double most_steps) {
  OrderObservation best;
  double least_spread = std::numeric_limits<double>::infinity();
  for (const double t_end : end_times) {
    std::vector<double> h, error;
    for (double steps = 4; steps <= most_steps; steps *= std::numbers::sqrt2) {
      // A whole number of steps, so that no last step is shorter.
      const double step = t_end / std::round(steps);
      const double e = error_of(t_end, step);
      if (!(e > floor)) break;
      h.push_back(step);
      error.push_back(e);
    }
    if (std::ssize(h) < window) continue;
    h.erase(h.begin(), h.end() - window);
    error.erase(error.begin(), error.end() - window);
    const Line line = fit(h, error);
    // A run that left the range of numbers makes this not finite.
    if (!(line.spread < least_spread) || !std::isfinite(line.slope)) continue;
    least_spread = line.spread;
    best = {t_end, std::move(h), std::move(error), line.slope};
  }
  return best;
}

}  // namespace hmax
