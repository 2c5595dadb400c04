/// Tetrahedral meshes: what every tissue model is made from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace hmax {

/// Points in space and the tetrahedra between them. A mesh of the house is valid: indices are in range, no
/// tetrahedron is degenerate and all are oriented alike, so that the volume det(x1 - x0, x2 - x0, x3 - x0) /
/// 6 of each is positive. Readers and generators see to that; models rely on it.
struct TetMesh {
  using Index = std::int32_t;
  using Tetrahedra = Eigen::Matrix<Index, 4, Eigen::Dynamic>;
  using TenNode = Eigen::Matrix<Index, 10, Eigen::Dynamic>;

  Eigen::Matrix3Xd points;     ///< rest positions [m], shape (3, points)
  Tetrahedra tetrahedra;       ///< four points each, from 0, shape (4, tetrahedra)
  std::vector<Index> regions;  ///< of each tetrahedron: the material it is made of; empty: one region, 0
  /// Tetrahedra of ten nodes: four corners, then the middles of their edges in the order of tetrahedron_edges
  /// (topology.hpp), shape (10, elements). The tetrahedra 8 e to 8 e + 7 are then the parts of element e as
  /// refine.hpp cuts it, so that the mesh is also a linear one. Empty: the tetrahedra are the elements.
  TenNode ten_node{};

  [[nodiscard]] Eigen::Index point_count() const { return points.cols(); }
  [[nodiscard]] Eigen::Index tetrahedron_count() const { return tetrahedra.cols(); }
  [[nodiscard]] Index region(Eigen::Index tetrahedron) const {
    return regions.empty() ? 0 : regions[static_cast<std::size_t>(tetrahedron)];
  }

  [[nodiscard]] bool has_ten_nodes() const { return ten_node.cols() > 0; }
  [[nodiscard]] Eigen::Index element_count() const {
    return has_ten_nodes() ? ten_node.cols() : tetrahedra.cols();
  }
  /// The points of an element: ten or four.
  [[nodiscard]] std::span<const Index> element(Eigen::Index e) const {
    return has_ten_nodes() ? std::span(ten_node.data() + 10 * e, 10)
                           : std::span(tetrahedra.data() + 4 * e, 4);
  }
  /// How many tetrahedra an element has, and the first of them.
  [[nodiscard]] Eigen::Index parts() const { return has_ten_nodes() ? 8 : 1; }
  [[nodiscard]] Eigen::Index first_part(Eigen::Index e) const { return parts() * e; }
};

}  // namespace hmax
