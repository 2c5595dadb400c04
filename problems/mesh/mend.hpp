/// Mending of the tetrahedra that limit explicit steps.
#pragma once

#include <vector>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// What mending did to a mesh.
struct Mending {
  std::vector<TetMesh::Index> moved;                       ///< the points that stand elsewhere now, sorted
  double farthest = 0;                                     ///< the largest of their moves [m]
  double least_height_before = 0, least_height_after = 0;  ///< of all tetrahedra [m]
  double least_mean_height_before = 0, least_mean_height_after = 0;  ///< of all points, as in mended() [m]
};

struct MendedMesh {
  TetMesh mesh;  ///< points and tetrahedra in their order
  Mending mending;
};

/// Moves points of the tetrahedra that limit explicit steps most. The mean height h of a point over the faces
/// opposite to it, 1 / h^2 = sum of V / h_t^2 / sum of V over its tetrahedra t, measures its stiffness over
/// its mass, and undamped steps are about in proportion to the least of all. One by one, `count` times, the
/// tetrahedron of least height at the point of least mean height that still gains by it has its points moved,
/// one after another, each to where the least mean height of the points around it is largest and no
/// tetrahedron of it is lower than the lowest was. As a function of the point, V / h_t^2 = A^2 / 9 V is
/// convex and V linear: such places make a convex set, and a search along fixed directions with shrinking
/// steps climbs. It ends early where nothing gains.
///
/// Inner points go up to half of the mean length of their edges. Points where the surface is flat within 5
/// degrees slide in its plane as far; those of a curved surface or a crease go up to a twentieth, in any
/// direction; those at the rim of a plane stay. The volume of the body changes by less than a thousandth.
/// Points between regions stay.
/// @param count  0 or more
/// @param fixed  more points that stay, in any order
/// @throws std::invalid_argument when count is negative
MendedMesh mended(const TetMesh& mesh, TetMesh::Index count, const std::vector<TetMesh::Index>& fixed = {});

}  // namespace hmax
