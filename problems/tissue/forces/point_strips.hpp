/// Strips of the points of a mesh, for threads that each compute the forces on one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel_for.hpp"
#include "problems/tissue/forces/node_rows.hpp"

namespace hmax {

/// Groups of elements in about the order of their points, and the points that they act on. All that acts on a
/// strip of points lies between a first and a last group.
class PointStrips {
 public:
  using Index = std::int32_t;

  /// The points first .. last - 1, and the blocks of elements begin .. end - 1, among which are all that act
  /// on them. These act on points from lowest to highest.
  struct Strip {
    Index first, last;
    std::size_t begin, end;
    Index lowest, highest;
  };

  /// One more group. @param end  its blocks follow those of the group before, up to this one
  /// @param lowest, highest  of the points that they act on
  void add_group(std::size_t end, Index lowest, Index highest);

  [[nodiscard]] std::size_t blocks() const { return groups_.empty() ? 0 : groups_.back().end; }

  /// Strips of all points with about as many blocks, without blocks that are in two. At most `count`; one
  /// where a strip would need most of the blocks.
  [[nodiscard]] std::vector<Strip> divide(Index points, std::size_t count) const;

 private:
  struct Group {
    std::size_t end;
    Index lowest;   ///< of this group and all after it
    Index highest;  ///< of this group and all before it
  };
  std::vector<Group> groups_;
};

/// f += what kernel(begin, end, rows) adds to rows of points by the blocks begin .. end - 1, one after the
/// other. On at most `most` threads: each computes all blocks that act on its strip of points, in their
/// order, and keeps what they add there. Sums have the same bits for any number of threads.
template <class Kernel>
void add_by_strips(const PointStrips& groups, std::size_t most, NodeRows& f, const Kernel& kernel) {
  const std::size_t count = most > 1 ? std::min(threads(), most) : 1;
  std::vector<PointStrips::Strip> strips;
  if (count > 1) strips = groups.divide(static_cast<PointStrips::Index>(f.size()), count);
  if (strips.size() < 2) return kernel(std::size_t{0}, groups.blocks(), &f.front().x);
  // The calling thread keeps them from call to call.
  thread_local std::vector<NodeRows> kept;
  std::vector<NodeRows>& own = kept;
  if (own.size() < strips.size()) own.resize(strips.size());
  parallel_for(strips.size(), [&](std::size_t i, std::size_t) {
    const PointStrips::Strip& strip = strips[i];
    NodeRows& rows = own[i];
    rows.assign(static_cast<std::size_t>(strip.highest - strip.lowest) + 1, {});
    const auto begin = f.begin() + std::max(strip.first, strip.lowest),
               end = f.begin() + std::min(strip.last, strip.highest + 1);
    const auto here = rows.begin() + (std::max(strip.first, strip.lowest) - strip.lowest);
    std::copy(begin, end, here);
    kernel(strip.begin, strip.end, &rows.front().x - std::ptrdiff_t{4} * strip.lowest);
    std::copy_n(here, end - begin, begin);
  });
}

}  // namespace hmax
