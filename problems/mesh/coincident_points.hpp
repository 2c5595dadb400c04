/// Points of a mesh at the same place, as files have them where every tetrahedron or every part brings its
/// own.
#pragma once

#include <vector>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// Two points coincide when their distance is at most this share of the shortest edge at either of them.
/// Beyond a half the corners of a tetrahedron could.
inline constexpr double largest_coincidence = 0.5;
/// What rounding to six digits leaves between points that were one.
inline constexpr double near_coincidence = 1e-3;

/// For each point the first one that it coincides with, directly or through others: itself where there is
/// none. Points in no tetrahedron have no edge, and coincide with those that have one. Shape (points).
/// @param tolerance  share of the shortest edge, from 0: exactly the same place
std::vector<TetMesh::Index> coincident_points(const TetMesh& mesh, double tolerance);

/// The points of tetrahedra that coincide with an earlier one, each with the first.
struct Coincidence {
  TetMesh::Index point, first;
};
std::vector<Coincidence> coincidences(const TetMesh& mesh, double tolerance);

}  // namespace hmax
