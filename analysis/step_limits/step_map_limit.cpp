#include "analysis/step_limits/step_map_limit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "analysis/spectrum/lanczos.hpp"
#include "core/dense_solvers.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

double norm_of(const VectorXd& y, const LinearOperator& inner) {
  return inner ? std::sqrt(std::max(0.0, y.dot(inner(y)))) : y.norm();
}

/// The real motion of an eigenvector: that part of its plane that is largest.
VectorXd real_motion(const Eigen::VectorXcd& vector) {
  return vector.real().norm() >= vector.imag().norm() ? VectorXd(vector.real()) : VectorXd(vector.imag());
}

/// The dominant motion of S^power.
DominantEigenvalue dominant_of_power(const StepMap& map, const VectorXd& start, int power,
                                     Eigen::Index most_products, const StepMapSettings& settings) {
  return dominant_eigenvalue([&](const VectorXd& y) { return map(y, power); }, start,
                             {.basis = settings.basis,
                              .kept = settings.basis / 3,
                              .most_products = most_products,
                              .threshold = std::exp(power * settings.weak_growth),
                              .inner = settings.inner});
}

/// By the matrix of the map, column by column, and the QR algorithm.
StepGrowth dense_growth(const StepMap& map, Eigen::Index n, double weak_growth) {
  MatrixXd S(n, n);
  for (Eigen::Index j = 0; j < n; ++j) S.col(j) = map(VectorXd::Unit(n, j), 1);
  if (!S.allFinite()) return {infinity, true, start_vector(n)};
  const SortedEigenpairs pairs(S);
  const double rate = std::log(std::abs(pairs.values.front()));
  return {rate, rate > weak_growth, real_motion(pairs.vectors.col(0))};
}

StepGrowth linear_growth(const StepMap& map, const VectorXd& start, const StepMapSettings& settings) {
  if (start.size() <= settings.dense_to) return dense_growth(map, start.size(), settings.weak_growth);
  int power = settings.power;
  DominantEigenvalue found = dominant_of_power(map, start, power, settings.most_products, settings);
  const auto threshold = [&] { return std::exp(power * settings.weak_growth); };
  // Slow growth beside motions that neither grow nor decay: the Ritz values of a short iteration lie within
  // those, and tell nothing of it. A motion that has gone for thousands of steps consists mostly of what
  // grows.
  if (std::isfinite(std::abs(found.value)) && !found.converged && !found.exceeds(threshold()) &&
      !found.stays_below(threshold()) && settings.long_power > power) {
    power = settings.long_power;
    VectorXd grown = start;
    for (int product = 0; product < settings.long_products && grown.allFinite(); ++product) {
      grown = map(grown, power);
      grown /= norm_of(grown, settings.inner);
    }
    if (!grown.allFinite()) return {infinity, true, start};
    found = dominant_of_power(map, grown, power, settings.basis, settings);
  }
  const double size = std::abs(found.value);
  if (!std::isfinite(size)) return {infinity, true, start};
  const bool grows = found.exceeds(threshold());
  return {std::log(size) / power, grows, real_motion(found.vector),
          grows || found.converged || found.stays_below(threshold())};
}

/// The mean of the last half of `rates`.
double late_mean(const std::vector<double>& rates) {
  const auto half = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2);
  return std::accumulate(half, rates.end(), 0.0) / static_cast<double>(rates.end() - half);
}

/// The orbit of one start: the mean growth over its second half, until twice the length no longer changes it.
StepGrowth orbit_growth(const StepMap& map, VectorXd y, const StepMapSettings& settings) {
  std::vector<double> rates;
  y /= norm_of(y, settings.inner);
  double before = infinity;
  for (std::size_t known = 8; rates.size() < static_cast<std::size_t>(settings.blocks);) {
    VectorXd next = map(y, settings.power);
    const double size = norm_of(next, settings.inner);
    if (!std::isfinite(size)) return {infinity, true, y};
    if (!(size > 0)) return {-infinity, false, y};
    rates.push_back(std::log(size) / settings.power);
    y = next / size;
    if (rates.size() < known) continue;
    const double now = late_mean(rates);
    if (std::abs(now) > 0.01 && std::abs(now - before) < 0.1 * std::abs(now)) break;
    before = now;
    known *= 2;
  }
  const double rate = late_mean(rates);
  return {rate, rate > settings.weak_growth, y};
}

StepGrowth homogeneous_growth(const StepMap& map, const VectorXd& start, const StepMapSettings& settings) {
  StepGrowth largest = orbit_growth(map, start, settings);
  if (!largest.grows) {
    const StepGrowth other = orbit_growth(map, start.reverse(), settings);
    if (other.rate > largest.rate) largest = other;
  }
  return largest;
}

}  // namespace

StepGrowth growth_of_steps(const StepMap& map, const VectorXd& start, const StepMapSettings& settings) {
  return settings.linear ? linear_growth(map, start, settings) : homogeneous_growth(map, start, settings);
}

StepMapLimit first_growing_step(const StepMapAt& map_at, Eigen::Index n, const StepMapSettings& settings) {
  // Every step size begins with a part of every motion: from the motion of the one before an iteration may
  // converge to a mode that does not grow, and miss one that does.
  const VectorXd start = start_vector(n);
  VectorXd motion = start;
  bool resolved = true;
  const auto growth_at = [&](double h) {
    if (settings.watch) settings.watch();
    StepGrowth growth = growth_of_steps(map_at(h), start, settings);
    if (growth.motion.allFinite()) motion = growth.motion;
    resolved = resolved && growth.resolved;
    return growth;
  };
  double low = settings.least, high = low;
  while (growth_at(low).grows) {
    low /= 4;
    if (low < 1e-3 * settings.least) return {.h_max = 0, .motion = motion};
  }
  double above = 0;
  while (true) {
    high = low * settings.stride;
    if (high > settings.most) return {.h_max = infinity, .motion = motion, .resolved = resolved};
    const StepGrowth growth = growth_at(high);
    above = growth.rate;
    if (growth.grows) break;
    low = high;
  }
  // Growth begins at a corner: by the line through the last two steps that grow, and by halves.
  VectorXd critical = motion;
  double farther = 0, of_farther = 0, root = 0;
  for (int tries = 0; tries < 40 && high - low > settings.resolution * high; ++tries) {
    double next = (low + high) / 2;
    const bool has_line =
        farther > high && std::isfinite(of_farther) && of_farther > above && high < 1.1 * low;
    if (has_line) {
      const double crossing = high - (above - settings.weak_growth) * (farther - high) / (of_farther - above);
      // Where lines agree the corner is known better than any step beside it would show.
      if (crossing > low && std::abs(crossing - root) < settings.resolution * high) break;
      root = crossing;
      next = std::clamp(crossing + 0.2 * (high - crossing), low + 0.05 * (high - low),
                        high - 0.05 * (high - low));
    }
    const StepGrowth growth = growth_at(next);
    if (!growth.grows) {
      low = next;
      continue;
    }
    farther = high;
    of_farther = above;
    high = next;
    above = growth.rate;
    critical = motion;
  }
  return {
      .h_max = root > low && root < high ? root : (low + high) / 2, .motion = critical, .resolved = resolved};
}

}  // namespace hmax
