#include "analysis/amplification/order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace hmax {

namespace {

// Points that the line is fitted to: three local slopes.
constexpr std::ptrdiff_t window = 4;
// Rounding is far below the solution.
constexpr double most_rounding = 1e-5;

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

/// All runs to one end time, coarse to fine.
OrderObservation refined(const std::function<double(double t_end, double h)>& error_of, double t_end,
                         const OrderScale& scale, double most_steps) {
  OrderObservation seen;
  seen.t_end = t_end;
  for (double steps = 4; steps <= most_steps; steps *= std::numbers::sqrt2) {
    // A whole number of steps, so that no last step is shorter.
    const double h = t_end / std::round(steps), error = error_of(t_end, h);
    if (error <= scale.floor) {
      seen.h_rounded = h;
      break;
    }
    if (!std::isfinite(error) || error >= 0.1 * scale.size) {
      // Coarser steps that seemed to converge did so by chance.
      seen.h.clear();
      seen.error.clear();
      seen.h_diverged = h;
      continue;
    }
    seen.h.push_back(h);
    seen.error.push_back(error);
  }
  return seen;
}

/// Cuts off the finest steps where none of them lowers the error by a fifth: an order of one lowers it by
/// 0.71 each time. What is less than ten times as large as the errors there is polluted by them, and goes
/// too.
/// @returns  the level where errors no longer fall; nothing where they fall to the end
std::optional<double> cut_plateau(OrderObservation& seen) {
  double least = std::numeric_limits<double>::infinity();
  std::size_t end = seen.error.size();
  for (std::size_t i = seen.error.size(); i-- > 1;) {
    least = std::min(least, seen.error[i]);
    if (least > 0.8 * seen.error[i - 1]) end = i;
  }
  if (end == seen.error.size()) return std::nullopt;
  const double level =
      *std::max_element(seen.error.begin() + static_cast<std::ptrdiff_t>(end), seen.error.end());
  while (end > 0 && seen.error[end - 1] <= 10 * level) --end;
  seen.h_rounded = seen.h[end];
  seen.h.resize(end);
  seen.error.resize(end);
  return level;
}

/// Cuts off the finest steps where errors scatter about a line, as the rounding of a method does above
/// `floor`: where the slope falls and rises again, or the other way round, by more than `most_spread` each
/// time. What is less than ten times as large as the errors there goes too.
/// @returns  the level of the errors that scatter; nothing where those of the last steps do not
std::optional<double> cut_scatter(OrderObservation& seen, double most_spread) {
  const std::ptrdiff_t n = std::ssize(seen.h);
  if (n < window) return std::nullopt;
  const auto slope = [&](std::ptrdiff_t i) {
    const auto at = static_cast<std::size_t>(n - i);
    return std::log(seen.error[at - 1] / seen.error[at]) / std::log(seen.h[at - 1] / seen.h[at]);
  };
  const double before = slope(2) - slope(3), after = slope(1) - slope(2);
  if (before * after >= 0 || std::min(std::abs(before), std::abs(after)) <= most_spread) return std::nullopt;
  const double level = *std::max_element(seen.error.end() - 2, seen.error.end());
  std::size_t end = seen.error.size() - 2;
  while (end > 0 && seen.error[end - 1] <= 10 * level) --end;
  seen.h_rounded = seen.h[end];
  seen.h.resize(end);
  seen.error.resize(end);
  return level;
}

OrderLack lack_of(const OrderObservation& seen, double level, const OrderScale& scale) {
  if (level > most_rounding * scale.size) return OrderLack::stalled;
  if (seen.h_diverged && seen.h_rounded) return OrderLack::narrow;
  if (seen.h_diverged) return OrderLack::diverged;
  return OrderLack::rounded;
}

}  // namespace

std::string_view name_of(OrderLack lack) {
  constexpr std::array<std::string_view, 6> names{"",       "diverged", "rounded",
                                                  "narrow", "stalled",  "not_asymptotic"};
  return names[static_cast<std::size_t>(lack)];
}

// For each end time: refine until the error is at most `floor`, keep the four finest, fit. The end time
// with the smallest spread of local slopes wins.
OrderObservation observe_order(const std::function<double(double t_end, double h)>& error_of,
                               std::span<const double> end_times, const OrderScale& scale,
                               double most_steps) {
  constexpr double most_spread = 0.5;
  OrderObservation best, last;
  double least_spread = std::numeric_limits<double>::infinity();
  for (const double t_end : end_times) {
    OrderObservation seen = refined(error_of, t_end, scale, most_steps);
    std::optional<double> level = cut_plateau(seen);
    // Far above rounding it is the leading term that vanishes.
    while (!seen.error.empty() && seen.error.back() <= most_rounding * scale.size)
      if (const auto scattered = cut_scatter(seen, most_spread))
        level = scattered;
      else
        break;
    if (std::ssize(seen.h) < window) {
      seen.lack = lack_of(seen, level.value_or(0), scale);
      last = std::move(seen);
      continue;
    }
    seen.h.erase(seen.h.begin(), seen.h.end() - window);
    seen.error.erase(seen.error.begin(), seen.error.end() - window);
    const Line line = fit(seen.h, seen.error);
    if (!(line.spread < least_spread)) continue;
    least_spread = line.spread;
    if (line.spread <= most_spread)
      seen.observed = line.slope;
    else
      seen.lack = OrderLack::not_asymptotic;
    best = std::move(seen);
  }
  return std::isfinite(least_spread) ? best : last;
}

}  // namespace hmax
