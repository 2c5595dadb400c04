#include "analysis/foreign_steps/slow_motions.hpp"

#include <algorithm>
#include <cmath>

namespace hmax {

std::vector<StepMotion> slowest_motions(const std::vector<StepMotion>& motions, const Eigen::VectorXd& scale,
                                        std::size_t count) {
  constexpr double most_error = 1e-3;
  std::vector<StepMotion> slow = motions;
  std::erase_if(slow, [](const StepMotion& each) { return !(each.error <= most_error); });
  const auto oscillates = [](const StepMotion& each) { return each.rate.imag() > 0; };
  if (std::ranges::any_of(slow, oscillates))
    std::erase_if(slow, [&](const StepMotion& each) { return !oscillates(each); });
  std::ranges::sort(slow, {}, [](const StepMotion& each) { return std::abs(each.rate); });
  if (slow.size() > count) slow.erase(slow.begin() + static_cast<std::ptrdiff_t>(count), slow.end());
  for (StepMotion& each : slow) each.shape.array() *= scale.array();
  return slow;
}

std::vector<ShownMode> continued_motions(const std::vector<StepMotion>& slow,
                                         const std::vector<StepMotion>& motions,
                                         const Eigen::VectorXd& scale) {
  std::vector<ShownMode> modes;
  for (const StepMotion& of : slow) {
    const Eigen::VectorXcd shape = (of.shape.array() / scale.array()).matrix().normalized();
    FoundMode found;
    for (const StepMotion& each : motions) found.look(each.rate, std::abs(shape.dot(each.shape)), each.error);
    const double omega = std::abs(of.rate);
    modes.push_back(found.shown({.omega = omega, .zeta = -of.rate.real() / omega}));
  }
  return modes;
}

}  // namespace hmax
