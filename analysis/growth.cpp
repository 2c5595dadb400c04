#include "analysis/growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hmax {

namespace {

/// From one quarter to the other growth in proportion to time makes at most a factor of four.
const double in_proportion = std::log(4.0) + 0.02;

}  // namespace

double observed_growth(const ShowSteps& run, const Distance& distance, double h, std::int64_t steps,
                       double noise) {
  double start = 0, early = 0, late = 0;
  std::int64_t n = 0;
  bool broken = false;
  const bool ended = run(h, steps, [&](const Eigen::Ref<const Eigen::VectorXd>& y) {
    const double here = distance(y);
    broken = broken || !std::isfinite(here);
    if (n == 0)
      start = here;
    else if (n > steps / 4 && n <= steps / 2)
      early = std::max(early, here);
    else if (n > 3 * steps / 4)
      late = std::max(late, here);
    ++n;
  });
  if (!ended || broken || n < steps) return std::numeric_limits<double>::infinity();
  constexpr double least = std::numeric_limits<double>::min();
  const double growth = std::log(late) - std::log(std::max({early, noise * start, least}));
  // What a nonlinear model has caught far out before the quarters that are compared has grown all the same.
  constexpr double far_out = 1e4;
  return start > 0 && late > far_out * start ? std::max(growth, std::log(late / start)) : growth;
}

ObservedLimit observe_limit(const ShowSteps& run, const Distance& distance, double predicted,
                            const ExpectedGrowth& expected) {
  constexpr double least = 512, most = most_observed_steps;
  const double threshold = expected.linear ? in_proportion : expected.visible;
  // Half of the run lies between the two quarters that are compared; what dies away has a quarter of it.
  const double to_grow = 2 * threshold / (expected.share * expected.above);
  const double to_decay = 4 * expected.fall / -expected.beside;
  ObservedLimit limit;
  limit.steps = static_cast<std::int64_t>(std::clamp(std::ceil(std::max(to_grow, to_decay)), least, most));
  const auto grows = [&](double h) { return observed_growth(run, distance, h, limit.steps) > threshold; };
  limit.below_decays = !grows(0.999 * predicted);
  limit.above_grows = grows(1.001 * predicted);
  double low = 0.999 * predicted, high = 1.001 * predicted;
  // Where the prediction fails the truth is sought outwards from it.
  constexpr double farthest = 1e3;
  if (!limit.below_decays) {
    do {
      high = low;
      low /= 1.1;
    } while (low > predicted / farthest && grows(low));
    if (low <= predicted / farthest) {
      limit.h = 0;
      return limit;
    }
  }
  if (limit.below_decays && !limit.above_grows) {
    do {
      low = high;
      high *= 1.1;
    } while (high < farthest * predicted && !grows(high));
    if (high >= farthest * predicted) {
      limit.h = std::numeric_limits<double>::infinity();
      return limit;
    }
  }
  while (high - low > 1e-6 * high) {
    const double middle = (low + high) / 2;
    (grows(middle) ? high : low) = middle;
  }
  limit.h = (low + high) / 2;
  return limit;
}

ShowSteps without_root(ShowSteps run, Eigen::VectorXd rest,
                       std::function<std::complex<double>(double h)> root) {
  return [=](double h, std::int64_t steps, const auto& show) {
    const std::complex<double> r = root(h);
    Eigen::VectorXd before(rest.size()), here(rest.size()), shown(rest.size());
    std::int64_t n = 0;
    return run(h, steps + 2, [&](const Eigen::Ref<const Eigen::VectorXd>& y) {
      if (n >= 2) {
        shown = y - 2 * r.real() * here + std::norm(r) * before - (std::norm(r) - 2 * r.real()) * rest;
        show(shown);
      }
      before.swap(here);
      here = y;
      ++n;
    });
  };
}

bool grows_at(const ShowSteps& run, const Distance& distance, double h) {
  // From one quarter to the other linear growth makes at most a factor of 4, so does not count.
  // What is left of a mode that every step annihilates is what equations are solved to.
  constexpr double noise = 1e-6;
  return observed_growth(run, distance, h, 4096, noise) > in_proportion;
}

}  // namespace hmax
