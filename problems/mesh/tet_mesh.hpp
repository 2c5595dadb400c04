/// Tetrahedral meshes: what every tissue model is made from.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace hmax {

/// Points in space and the tetrahedra between them. A mesh of the house is valid: indices are in range, no
/// tetrahedron is degenerate and all are oriented alike, so that the volume det(x1 - x0, x2 - x0, x3 - x0) /
/// 6 of each is positive. Readers and generators see to that; models rely on it.
struct TetMesh {
  using Index = std::int32_t;
  using Tetrahedra = Eigen::Matrix<Index, 4, Eigen::Dynamic>;

  Eigen::Matrix3Xd points;     ///< rest positions [m], shape (3, points)
  Tetrahedra tetrahedra;       ///< four points each, from 0, shape (4, tetrahedra)
  std::vector<Index> regions;  ///< of each tetrahedron: the material it is made of; empty: one region, 0

  [[nodiscard]] Eigen::Index point_count() const { return points.cols(); }
  [[nodiscard]] Eigen::Index tetrahedron_count() const { return tetrahedra.cols(); }
  [[nodiscard]] Index region(Eigen::Index tetrahedron) const {
    return regions.empty() ? 0 : regions[static_cast<std::size_t>(tetrahedron)];
  }
};

}  // namespace hmax
