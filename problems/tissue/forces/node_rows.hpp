/// Rows of the points of a mesh: what the kernels of tissue models read and write.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace hmax {

/// Position [m], velocity [m/s] or force [N] of one point, padded so that a row is one aligned register.
struct alignas(32) NodeRow {
  double x = 0, y = 0, z = 0, unused = 0;
};

/// One row for every point of a mesh, supported or free, in the order of the mesh.
using NodeRows = std::vector<NodeRow>;

[[nodiscard]] inline Eigen::Map<Eigen::Vector3d> as_vector(NodeRow& row) {
  return Eigen::Map<Eigen::Vector3d>(&row.x);
}
[[nodiscard]] inline Eigen::Map<const Eigen::Vector3d> as_vector(const NodeRow& row) {
  return Eigen::Map<const Eigen::Vector3d>(&row.x);
}
/// Those of vectors, shape (3, points).
[[nodiscard]] inline NodeRows node_rows(const Eigen::Matrix3Xd& vectors) {
  NodeRows rows(static_cast<std::size_t>(vectors.cols()));
  for (Eigen::Index i = 0; i < vectors.cols(); ++i)
    as_vector(rows[static_cast<std::size_t>(i)]) = vectors.col(i);
  return rows;
}

}  // namespace hmax
