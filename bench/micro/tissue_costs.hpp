/// What the loops over tetrahedra and springs cost at least, beside the processor's peaks.
#pragma once

#include "problems/tissue/forces/kernels/kernels.hpp"
#include "problems/tissue/forces/node_rows.hpp"

namespace hmax::micro {

/// Of one element: operations, and bytes when its record and its share of the points are read and written
/// once.
struct Cost {
  double operations, bytes;
};

/// What a body has.
struct BodyCounts {
  double points, edges, tetrahedra;
  double entries;  ///< of its stiffness
};

static_assert(SpringSlice::lanes == TetBlock::lanes);
inline constexpr double block_lanes = TetBlock::lanes, tetrahedron_bytes = sizeof(TetBlock) / block_lanes,
                        spring_bytes = (sizeof(SpringBlock) + sizeof(SpringEnds)) / block_lanes,
                        slot_bytes = sizeof(TetSlots) / block_lanes, row_bytes = sizeof(NodeRow);

/// Positions are read, forces read and written: three rows a point.
inline Cost cost_of_force(const BodyCounts& body) {
  return {210, tetrahedron_bytes + 3 * row_bytes * body.points / body.tetrahedra};
}
/// Per spring, one on each edge.
inline Cost cost_of_springs(const BodyCounts& body) {
  return {31, spring_bytes + 3 * row_bytes * body.points / body.edges};
}
/// Displacements are read, three rows of the block of each edge read and written, the entries written.
inline Cost cost_of_stiffness(const BodyCounts& body) {
  const double bytes =
      row_bytes * body.points + 2 * 3 * row_bytes * body.edges + sizeof(double) * body.entries;
  return {588, tetrahedron_bytes + slot_bytes + bytes / body.tetrahedra};
}

}  // namespace hmax::micro
