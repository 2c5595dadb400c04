#include "problems/mesh/mesh_quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "problems/mesh/topology.hpp"

namespace hmax {

namespace {

double longest_square(const Corners& x) {
  double longest = 0;
  for (const auto& [i, j] : tetrahedron_edges)
    longest = std::max(longest, (x.col(i) - x.col(j)).squaredNorm());
  return longest;
}

}  // namespace

double signed_volume(const Corners& x) {
  return (x.col(1) - x.col(0)).dot((x.col(2) - x.col(0)).cross(x.col(3) - x.col(0))) / 6;
}

double least_height(const Corners& x) {
  double largest = 0;  // of twice the area, squared
  for (const auto& [a, b, c] : tetrahedron_faces)
    largest = std::max(largest, (x.col(b) - x.col(a)).cross(x.col(c) - x.col(a)).squaredNorm());
  return 6 * signed_volume(x) / std::sqrt(largest);
}

std::array<double, 6> dihedral_angles(const Corners& x) {
  Eigen::Matrix<double, 3, 4> normals;
  for (int i = 0; i < 4; ++i) {
    const auto& [a, b, c] = tetrahedron_faces[static_cast<std::size_t>(i)];
    normals.col(i) = (x.col(b) - x.col(a)).cross(x.col(c) - x.col(a));
  }
  std::array<double, 6> angles{};
  for (std::size_t e = 0; e < 6; ++e) {
    // The faces that meet in an edge are those opposite to the two other corners.
    const auto& [k, l] = tetrahedron_edges[5 - e];
    const Eigen::Vector3d m = normals.col(k), n = normals.col(l);
    angles[e] = std::numbers::pi - std::atan2(m.cross(n).norm(), m.dot(n));
  }
  return angles;
}

double mean_ratio(const Corners& x) {
  const double volume = signed_volume(x);
  if (!(volume > 0)) return 0;
  double squares = 0;
  for (const auto& [i, j] : tetrahedron_edges) squares += (x.col(i) - x.col(j)).squaredNorm();
  return 12 * std::cbrt(9 * volume * volume) / squares;
}

bool is_degenerate(const Corners& x) {
  const double longest = std::sqrt(longest_square(x));
  return !(std::abs(signed_volume(x)) > 1e-12 * longest * longest * longest);
}

double diagonal_of(const TetMesh& mesh) {
  return (mesh.points.rowwise().maxCoeff() - mesh.points.rowwise().minCoeff()).norm();
}

MeshQuality quality_of(const TetMesh& mesh) {
  MeshQuality quality;
  if (mesh.point_count() > 0) {
    quality.lower = mesh.points.rowwise().minCoeff();
    quality.upper = mesh.points.rowwise().maxCoeff();
  }
  if (mesh.tetrahedron_count() == 0) return quality;
  quality.min_mean_ratio = quality.smallest_angle = quality.shortest_edge =
      std::numeric_limits<double>::infinity();
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    const Corners x = corners_of(mesh, t);
    quality.volume += signed_volume(x);
    const double ratio = mean_ratio(x);
    quality.average_mean_ratio += ratio;
    if (ratio < quality.min_mean_ratio || std::isnan(ratio)) {
      quality.min_mean_ratio = ratio;
      quality.worst = t;
    }
    for (const double angle : dihedral_angles(x)) {
      quality.smallest_angle = std::min(quality.smallest_angle, angle);
      quality.largest_angle = std::max(quality.largest_angle, angle);
    }
    for (const auto& [i, j] : tetrahedron_edges) {
      const double length = (x.col(i) - x.col(j)).norm();
      quality.shortest_edge = std::min(quality.shortest_edge, length);
      quality.longest_edge = std::max(quality.longest_edge, length);
    }
  }
  quality.average_mean_ratio /= static_cast<double>(mesh.tetrahedron_count());
  return quality;
}

std::vector<Sliver> slivers_of(const TetMesh& mesh, double angle) {
  std::vector<Sliver> slivers;
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    const Corners x = corners_of(mesh, t);
    const double smallest = std::ranges::min(dihedral_angles(x));
    if (smallest < angle) slivers.push_back({t, smallest, mean_ratio(x)});
  }
  std::ranges::stable_sort(slivers, {}, &Sliver::smallest_angle);
  return slivers;
}

}  // namespace hmax
