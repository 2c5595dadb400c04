#include "problems/tissue/positional/colouring.hpp"

#include <algorithm>
#include <cstddef>

namespace hmax {

std::vector<std::vector<std::int32_t>> greedy_colours(
    const std::vector<std::vector<std::int32_t>>& neighbours) {
  std::vector<std::vector<std::int32_t>> colours;
  std::vector<std::size_t> colour_of(neighbours.size(), neighbours.size());
  std::vector<std::size_t> taken_by;  // of each colour: the last thing that has a neighbour of it
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    for (const std::int32_t other : neighbours[i])
      if (const std::size_t colour = colour_of[static_cast<std::size_t>(other)]; colour < colours.size())
        taken_by[colour] = i + 1;
    const auto free = std::ranges::find_if(taken_by, [&](std::size_t last) { return last != i + 1; });
    const auto colour = static_cast<std::size_t>(free - taken_by.begin());
    if (free == taken_by.end()) {
      colours.emplace_back();
      taken_by.push_back(0);
    }
    colours[colour].push_back(static_cast<std::int32_t>(i));
    colour_of[i] = colour;
  }
  return colours;
}

std::vector<std::vector<std::int32_t>> colours_by_points(
    const std::vector<std::vector<std::int32_t>>& points) {
  std::int32_t most = -1;
  for (const std::vector<std::int32_t>& own : points)
    for (const std::int32_t point : own) most = std::max(most, point);
  std::vector<std::vector<std::int32_t>> at_point(static_cast<std::size_t>(most + 1));
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const std::int32_t point : points[i])
      if (point >= 0) at_point[static_cast<std::size_t>(point)].push_back(static_cast<std::int32_t>(i));
  std::vector<std::vector<std::int32_t>> neighbours(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const std::int32_t point : points[i])
      if (point >= 0) {
        const std::vector<std::int32_t>& others = at_point[static_cast<std::size_t>(point)];
        neighbours[i].insert(neighbours[i].end(), others.begin(), others.end());
      }
  return greedy_colours(neighbours);
}

}  // namespace hmax
