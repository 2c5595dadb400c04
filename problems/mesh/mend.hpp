/// Mending of the flattest tetrahedra, which limit explicit steps.
#pragma once

#include <vector>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// What mending did to a mesh.
struct Mending {
  std::vector<TetMesh::Index> moved;                       ///< the points that stand elsewhere now, sorted
  double farthest = 0;                                     ///< the largest of their moves [m]
  double least_height_before = 0, least_height_after = 0;  ///< of all tetrahedra [m]
};

struct MendedMesh {
  TetMesh mesh;  ///< points and tetrahedra in their order
  Mending mending;
};

/// Moves points of the tetrahedra of least height: explicit steps are limited by height / wave speed. One by
/// one, `count` times, the tetrahedron of least height that still gains by it has its points moved, one
/// after another, each to where the least height of all tetrahedra around it is largest. Where none of these
/// is inverted, that height is a quasi-concave function of the point, 3 V linear and areas of faces convex;
/// a search along fixed directions with shrinking steps climbs it. It ends early where nothing gains.
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
