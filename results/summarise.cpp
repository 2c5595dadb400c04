#include <algorithm>
#include <cmath>
#include <limits>

#include "results/row.hpp"

namespace hmax {

std::vector<double> comparable_times(const Row& row) {
  return row.explored ? std::vector<double>{} : row.cpu_s;
}

TimingSummary summarise(std::vector<double> samples) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (samples.empty() ||
      std::any_of(samples.begin(), samples.end(), [](double x) { return std::isnan(x); })) {
    return {nan, nan, nan, nan};
  }
  std::sort(samples.begin(), samples.end());
  // [hyndman1996sample] type 7: position 1 + (n - 1) p among the order statistics x_(1) <= ... <= x_(n).
  const auto quantile = [&](double p) {
    const double position = p * static_cast<double>(samples.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    const double fraction = position - static_cast<double>(below);
    if (fraction == 0) return samples[below];
    return samples[below] + fraction * (samples[below + 1] - samples[below]);
  };
  return {.median = quantile(0.5), .q1 = quantile(0.25), .q3 = quantile(0.75), .p99 = quantile(0.99)};
}

}  // namespace hmax
