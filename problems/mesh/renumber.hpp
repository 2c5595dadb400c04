/// An order of points and tetrahedra in which neighbours lie near each other in memory.
#pragma once

#include <vector>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// Where each point and tetrahedron of a renumbered mesh stood before.
struct Renumbering {
  std::vector<TetMesh::Index> points;      ///< points[i] was the number of what is point i now
  std::vector<TetMesh::Index> tetrahedra;  ///< the same for tetrahedra
};

/// Reverse Cuthill-McKee on the edges [cuthill1969reducing], each part from an end found as in
/// [george1979implementation]; points in no tetrahedron last. The elements follow their points, and the parts
/// of one of ten nodes stay together.
Renumbering local_order(const TetMesh& mesh);

/// The mesh in the new order; the four corners of a tetrahedron keep theirs.
TetMesh renumbered(const TetMesh& mesh, const Renumbering& order);

/// Undoes renumbered().
TetMesh restored(const TetMesh& mesh, const Renumbering& order);

/// Values of each point (or tetrahedron) in the order they had before. @param now  one column each
template <class Columns>
Columns restored(const Columns& now, const std::vector<TetMesh::Index>& order) {
  Columns before(now.rows(), now.cols());
  for (std::size_t i = 0; i < order.size(); ++i) before.col(order[i]) = now.col(static_cast<Eigen::Index>(i));
  return before;
}

}  // namespace hmax
