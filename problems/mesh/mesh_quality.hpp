/// Volume and shape of tetrahedra.
#pragma once

#include <array>
#include <vector>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// The corners of a tetrahedron, shape (3, 4) [m].
using Corners = Eigen::Matrix<double, 3, 4>;

inline Corners corners_of(const TetMesh& mesh, Eigen::Index tetrahedron) {
  Corners x;
  for (int i = 0; i < 4; ++i) x.col(i) = mesh.points.col(mesh.tetrahedra(i, tetrahedron));
  return x;
}

/// det(x1 - x0, x2 - x0, x3 - x0) / 6 [m^3]: negative where the tetrahedron is inverted.
double signed_volume(const Corners& x);

/// The distance of a corner from the face opposite to it, 3 V / (area of the face), least of the four [m]:
/// negative where the tetrahedron is inverted.
double least_height(const Corners& x);

/// The six dihedral angles [rad], in the order of tetrahedron_edges.
std::array<double, 6> dihedral_angles(const Corners& x);

/// Mean ratio 12 (3 V)^(2/3) / (sum of l^2 over the edges) [liu1994relationship]: 1 for the regular
/// tetrahedron, towards 0 as it degenerates in any way, 0 where V <= 0.
double mean_ratio(const Corners& x);

/// True where the volume is that of rounding: |V| <= 1e-12 l^3, l the longest edge.
bool is_degenerate(const Corners& x);

/// The length of the diagonal of the box around the points [m]; there is one at least.
double diagonal_of(const TetMesh& mesh);

struct MeshQuality {
  double volume = 0;          ///< of all tetrahedra, inverted ones negative [m^3]
  double min_mean_ratio = 1;  ///< of the worst tetrahedron
  double average_mean_ratio = 0;
  Eigen::Index worst = -1;                       ///< the tetrahedron of the smallest mean ratio
  double smallest_angle = 0, largest_angle = 0;  ///< dihedral [rad]
  double shortest_edge = 0, longest_edge = 0;    ///< [m]
  Eigen::Vector3d lower = Eigen::Vector3d::Zero(), upper = Eigen::Vector3d::Zero();  ///< bounding box [m]
};

MeshQuality quality_of(const TetMesh& mesh);

/// A tetrahedron that is nearly flat.
struct Sliver {
  Eigen::Index tetrahedron;
  double smallest_angle, mean_ratio;  ///< dihedral [rad]; [1]
};

/// The tetrahedra with a dihedral angle below `angle` [rad], the flattest first.
std::vector<Sliver> slivers_of(const TetMesh& mesh, double angle);

}  // namespace hmax
