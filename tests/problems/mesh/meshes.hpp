/// Small meshes that tests share.
#pragma once

#include <Eigen/Dense>

#include "problems/mesh/mesh_generators.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

/// The corner of a cube of edge 1.
inline TetMesh unit_tetrahedron() {
  TetMesh mesh;
  mesh.points.resize(3, 4);
  mesh.points << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.tetrahedra.resize(4, 1);
  mesh.tetrahedra << 0, 1, 2, 3;
  return mesh;
}

/// All edges of length sqrt(2).
inline TetMesh regular_tetrahedron() {
  TetMesh mesh = unit_tetrahedron();
  mesh.points << 0, 1, 0, 1, 0, 0, 1, 1, 0, 1, 1, 0;
  if (signed_volume(corners_of(mesh, 0)) < 0) mesh.tetrahedra << 0, 1, 3, 2;
  return mesh;
}

/// Volume inside the surface by the divergence theorem: the sum of det(a, b, c) / 6 over its triangles.
inline double enclosed_volume(const TetMesh& mesh) {
  double volume = 0;
  const MeshSurface surface = surface_of(mesh);
  for (const auto& triangle : surface.triangles.colwise()) {
    Eigen::Matrix3d corners;
    for (int i = 0; i < 3; ++i) corners.col(i) = mesh.points.col(triangle(i));
    volume += corners.determinant() / 6;
  }
  return volume;
}

/// True when every tetrahedron has a positive volume.
inline bool all_positive(const TetMesh& mesh) {
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
    if (!(signed_volume(corners_of(mesh, t)) > 0)) return false;
  return true;
}

}  // namespace hmax
