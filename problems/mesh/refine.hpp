/// Uniform refinement of tetrahedral meshes.
#pragma once

#include <array>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// No mesh of the house has more tetrahedra; what would make more is refused.
inline constexpr Eigen::Index most_tetrahedra = 100'000'000;

/// Each tetrahedron into eight of equal volume: one at each corner, and the octahedron between them cut along
/// its shortest diagonal (of equal ones the first), which keeps shapes from getting worse and worse
/// [zhang1995successive]. The points of the mesh come first, then the middles of edges_of(mesh) in
/// their order; the parts of tetrahedron t are 8 t to 8 t + 7 and inherit its region.
/// @param times  how often, one after the other
/// @throws std::invalid_argument when times is negative or the result would be too large
TetMesh refined(const TetMesh& mesh, int times = 1);

/// Corners, then the middles of the edges in the order of tetrahedron_edges.
using TenPoints = std::array<TetMesh::Index, 10>;

/// The eight parts of a tetrahedron with these points, as refined() cuts it: part k < 4 is at corner k. Where
/// curved sides would turn parts over, along the shortest diagonal that keeps them positive.
std::array<std::array<TetMesh::Index, 4>, 8> parts_of(const Eigen::Matrix3Xd& points, const TenPoints& own);

/// refined() once, with the parts of each tetrahedron kept together as one of ten nodes (TetMesh::ten_node).
TetMesh ten_node_mesh(const TetMesh& mesh);

}  // namespace hmax
