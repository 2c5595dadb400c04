#include "analysis/foreign_steps/observed_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/spectrum/lanczos.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

constexpr std::int64_t samples = 256;

/// Steps between samples; their lengths differ, so that no period hides between them.
std::vector<std::int64_t> strides_of(std::int64_t steps) {
  std::vector<std::int64_t> strides;
  const std::int64_t mean = std::max<std::int64_t>(1, steps / samples);
  for (std::int64_t done = 0, k = 0; done < steps; ++k) {
    const std::int64_t stride = std::min(steps - done, mean > 2 ? mean + k % 3 - 1 : mean);
    strides.push_back(stride);
    done += stride;
  }
  return strides;
}

/// Distances after each stride, relative to that at the start; the last one is infinite where the run
/// diverged.
std::vector<double> distances(ForeignStepper& engine, const StateCoordinates& coordinates,
                              const VectorXd& scale, int slot, double h, const GrowthRun& run) {
  const std::vector<std::int64_t> strides = strides_of(run.steps);
  std::vector<double> found;
  engine.restore(slot);
  const VectorXd start = engine.state();
  std::vector<VectorXd> undisturbed;
  for (std::size_t k = 0; run.follow && k < strides.size(); ++k) {
    const bool done = engine.step(h, strides[k]);
    undisturbed.push_back(done ? engine.state() : VectorXd::Constant(start.size(), std::nan("")));
    if (run.watch) run.watch();
    if (!undisturbed.back().allFinite()) return {1, std::numeric_limits<double>::infinity()};
  }
  VectorXd numbers = start_vector(scale.size());
  numbers /= numbers.cwiseAbs().maxCoeff();
  engine.restore(slot);
  engine.set_state(coordinates.at(start, run.amplitude * numbers.cwiseProduct(scale)));
  // In float the disturbance is what is left of it.
  const auto distance = [&](const VectorXd& y) {
    return coordinates.of(y, engine.state()).cwiseQuotient(scale).norm();
  };
  const double first = std::max(distance(start), 1e-3 * run.amplitude);
  for (std::size_t k = 0; k < strides.size(); ++k) {
    const bool done = engine.step(h, strides[k]);
    const double now =
        done ? distance(run.follow ? undisturbed[k] : start) : std::numeric_limits<double>::infinity();
    if (run.watch) run.watch();
    found.push_back(now / first);
    if (!std::isfinite(now)) found.back() = std::numeric_limits<double>::infinity();
    if (!(now <= run.bound * std::sqrt(static_cast<double>(scale.size())))) {
      // Free motion at constant velocity gets there too.
      const double half =
          *std::max_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(k / 2 + 1));
      if (found.back() > 6 * (k > 1 ? half : 1)) found.back() = std::numeric_limits<double>::infinity();
      break;
    }
  }
  return found;
}

}  // namespace

bool run_grows(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale, int slot,
               double h, const GrowthRun& run) {
  const std::vector<double> found = distances(engine, coordinates, scale, slot, h, run);
  if (!std::isfinite(found.back())) return true;
  const auto count = static_cast<std::ptrdiff_t>(found.size());
  const auto largest = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
    return *std::max_element(found.begin() + from, found.begin() + to);
  };
  const double early = largest(0, std::max<std::ptrdiff_t>(1, count / 16));
  const double second = largest(count / 4, std::max(count / 4 + 1, count / 2)),
               last = largest(3 * count / 4, count);
  // What grew in the first quarter already may have come to an end of its own, such as a limit cycle.
  return last > 4 * second || last > run.most * early;
}

double growth_of_run(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale,
                     int slot, double h, const GrowthRun& run) {
  return std::log(distances(engine, coordinates, scale, slot, h, run).back());
}

}  // namespace hmax
