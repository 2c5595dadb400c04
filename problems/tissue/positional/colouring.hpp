/// Groups of things that do not act on each other.
#pragma once

#include <cstdint>
#include <vector>

namespace hmax {

/// The greedy colouring of `count` things in their order: each takes the lowest colour that none of its
/// neighbours before it has.
/// @param neighbours  of each thing, in any order, itself may be among them
/// @returns the things of each colour, rising
std::vector<std::vector<std::int32_t>> greedy_colours(
    const std::vector<std::vector<std::int32_t>>& neighbours);

/// Of things that act on each other where they share a point.
/// @param points  of each thing, negative ones do not count
std::vector<std::vector<std::int32_t>> colours_by_points(
    const std::vector<std::vector<std::int32_t>>& points);

}  // namespace hmax
