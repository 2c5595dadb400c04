#include <algorithm>
#include <cmath>
#include <limits>

#include "results/row.hpp"

namespace hmax {

bool is_on_device(const Row& row) { return !row.key.device.empty(); }

const std::vector<double>& times_of(const Row& row) { return is_on_device(row) ? row.device_s : row.cpu_s; }

std::string_view name_of_time(const RowKey& key) { return key.device.empty() ? "CPU time" : "device time"; }

std::vector<double> comparable_times(const Row& row) {
  return row.explored ? std::vector<double>{} : times_of(row);
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
