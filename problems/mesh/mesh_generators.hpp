/// Meshes of simple bodies at any resolution.
#pragma once

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// A box with one corner at the origin, cut into cells of six tetrahedra along one diagonal
/// [kuhn1960combinatorial]: refining twice as fine cells gives the same shapes, and every inner point has 14
/// neighbours.
/// @param size   of the box [m]; @param cells  along x, y, z
/// @throws std::invalid_argument for sizes and numbers that are not positive, and for too many cells
TetMesh box_mesh(const Eigen::Vector3d& size, const Eigen::Vector3i& cells);

/// A beam along x, 4 n cells long and n x n thick: 24 n^3 tetrahedra.
TetMesh beam_mesh(double length, double width, double height, int n);

/// A cube with n cells along each edge [m]: 6 n^3 tetrahedra.
TetMesh cube_mesh(double edge, int n);

/// A ball around the origin in n shells: the twenty tetrahedra between its centre and an icosahedron, each
/// cut into n^3 [edelsbrunner2000edgewise] and pushed outward, point by point, to the sphere of its shell. 20
/// n^3 tetrahedra; shell k has 10 k^2 + 2 points.
TetMesh ball_mesh(double radius, int n);

}  // namespace hmax
