/// Meshes as other programs make them: points that no generator would place so, in no order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "problems/mesh/files/mesh_names.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

/// A mesh by name whose points are moved at random by up to 12 % of its shortest edge along each axis, in a
/// random order. The same seed gives the same mesh.
inline TetMesh imported_mesh(const std::string& name, std::uint32_t seed) {
  const TetMesh mesh = mesh_by_name(name);
  std::mt19937 random(seed);
  const EdgeTable edges = edge_table(mesh);
  double shortest = std::numeric_limits<double>::infinity();
  for (Eigen::Index e = 0; e < edges.edges.cols(); ++e)
    shortest =
        std::min(shortest, (mesh.points.col(edges.edges(0, e)) - mesh.points.col(edges.edges(1, e))).norm());
  const auto points = static_cast<std::size_t>(mesh.point_count());
  std::vector<TetMesh::Index> place(points);
  std::iota(place.begin(), place.end(), TetMesh::Index(0));
  for (std::size_t i = points - 1; i > 0; --i) std::swap(place[i], place[random() % (i + 1)]);
  TetMesh imported = mesh;
  for (std::size_t i = 0; i < points; ++i)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      imported.points(axis, place[i]) =
          mesh.points(axis, static_cast<Eigen::Index>(i)) +
          0.12 * shortest * (2 * (static_cast<double>(random()) / 4294967295.0) - 1);
  for (TetMesh::Index& corner : imported.tetrahedra.reshaped())
    corner = place[static_cast<std::size_t>(corner)];
  return imported;
}

}  // namespace hmax
