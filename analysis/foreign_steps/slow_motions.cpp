#include "analysis/foreign_steps/slow_motions.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

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
  // Each motion of the step continues one of the slow ones, the most like first: an oscillation, or two
  // decays, continue one that oscillates, and one decay another.
  struct Likeness {
    double like;
    std::size_t of, each;
  };
  std::vector<Likeness> pairs;
  for (std::size_t of = 0; of < slow.size(); ++of) {
    const Eigen::VectorXcd shape = (slow[of].shape.array() / scale.array()).matrix().normalized();
    for (std::size_t each = 0; each < motions.size(); ++each)
      pairs.push_back({std::abs(shape.dot(motions[each].shape)), of, each});
  }
  std::ranges::sort(pairs, std::ranges::greater{}, &Likeness::like);
  const auto decays_of = [](const StepMotion& motion) { return motion.rate.imag() > 0 ? 2 : 1; };
  std::vector<int> sought;
  for (const StepMotion& of : slow) sought.push_back(decays_of(of));
  std::vector<bool> taken(motions.size());
  std::vector<FoundMode> found(slow.size());
  for (const auto& [like, of, each] : pairs) {
    if (taken[each] || sought[of] <= 0) continue;
    taken[each] = true;
    sought[of] -= decays_of(motions[each]);
    found[of].look(motions[each].rate, like, motions[each].error);
  }
  std::vector<ShownMode> modes;
  for (std::size_t of = 0; of < slow.size(); ++of) {
    const double omega = std::abs(slow[of].rate);
    modes.push_back(found[of].shown({.omega = omega, .zeta = -slow[of].rate.real() / omega}));
  }
  return modes;
}

}  // namespace hmax
