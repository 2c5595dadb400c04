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

}  // namespace hmax
