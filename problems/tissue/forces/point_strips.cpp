#include "problems/tissue/forces/point_strips.hpp"

namespace hmax {

void PointStrips::add_group(std::size_t end, Index lowest, Index highest) {
  for (auto before = groups_.rbegin(); before != groups_.rend() && before->lowest > lowest; ++before)
    before->lowest = lowest;
  groups_.push_back({end, lowest, groups_.empty() ? highest : std::max(highest, groups_.back().highest)});
}

std::vector<PointStrips::Strip> PointStrips::divide(Index points, std::size_t count) const {
  std::vector<Index> first{0};
  auto group = groups_.begin();
  for (std::size_t part = 1; part < count; ++part) {
    while (group->end <= blocks() * part / count) ++group;
    if (group->lowest > std::max(first.back(), groups_.front().lowest)) first.push_back(group->lowest);
  }
  first.push_back(points);
  std::vector<Strip> strips;
  std::size_t longest = 0;
  for (std::size_t i = 0; i + 1 < first.size(); ++i) {
    const auto begin = std::partition_point(groups_.begin(), groups_.end(),
                                            [&](const Group& g) { return g.highest < first[i]; });
    const auto end =
        std::partition_point(begin, groups_.end(), [&](const Group& g) { return g.lowest < first[i + 1]; });
    const std::size_t before = begin == groups_.begin() ? 0 : (begin - 1)->end;
    strips.push_back({first[i], first[i + 1], before, (end - 1)->end, begin->lowest, (end - 1)->highest});
    longest = std::max(longest, strips.back().end - before);
  }
  if (4 * longest > 3 * blocks()) strips.resize(1);
  return strips;
}

}  // namespace hmax
