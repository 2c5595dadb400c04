/// The shape of tetrahedra of ten nodes, whose sides may be curved: shape functions, volume, integrals.
#pragma once

#include <array>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// The places of the points of an element [m], corners first, then the middles of tetrahedron_edges.
using TenPlaces = Eigen::Matrix<double, 3, 10>;

TenPlaces ten_places(const TetMesh& mesh, Eigen::Index element);

/// Its place in the unit tetrahedron, 0 <= x, y, z and x + y + z <= 1, whose corner 0 is the origin.
using UnitPlace = Eigen::Vector3d;

/// The places of the ten points in the unit tetrahedron.
const std::array<UnitPlace, 10>& unit_places();

/// The shape functions N: L (2 L - 1) of a corner, 4 L L' of a middle, L the barycentric coordinates.
Eigen::Vector<double, 10> ten_node_values(const UnitPlace& at);
/// dN/d(x, y, z), a row for each point.
Eigen::Matrix<double, 10, 3> ten_node_slopes(const UnitPlace& at);

/// Four points of equal weight that integrate polynomials of degree two: point k lies near corner k.
const std::array<UnitPlace, 4>& ten_node_rule();

/// det dX/d(x, y, z), six times the volume of a straight element. Positive in all of a good one.
double ten_node_determinant(const TenPlaces& X, const UnitPlace& at);

/// The integrals of the gradients dN/dX over an element [m^2], exact for curved sides: a row for each point.
Eigen::Matrix<double, 10, 3> integrated_gradients(const TenPlaces& X);

/// The volume of an element [m^3], exact for curved sides.
double ten_node_volume(const TenPlaces& X);

/// The volume of an element of a mesh, of ten nodes or four [m^3].
double element_volume(const TetMesh& mesh, Eigen::Index element);

/// The share of the mass of an element that each of its points has. Of ten nodes: the diagonal of the
/// consistent mass matrix of straight sides, scaled to the whole [hinton1976note]: 1/36 at a corner, 4/27 at
/// a middle. Sums of rows would be negative at corners. Of four nodes: a quarter.
double mass_share(const TetMesh& mesh, std::size_t point);

}  // namespace hmax
