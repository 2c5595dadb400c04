#include "problems/tissue/forces/tet_elements.hpp"

namespace hmax {

Eigen::Matrix3d edge_vectors(const NodeRows& u, const std::array<TetMesh::Index, 4>& points) {
  Eigen::Matrix3d Ds;
  for (std::size_t a = 1; a < 4; ++a)
    Ds.col(static_cast<Eigen::Index>(a) - 1) =
        as_vector(u[static_cast<std::size_t>(points[a])]) - as_vector(u[static_cast<std::size_t>(points[0])]);
  return Ds;
}

void subtract_pull(const RestShape& rest, const std::array<TetMesh::Index, 4>& points,
                   const Eigen::Matrix3d& stress, NodeRows& f) {
  const Eigen::Matrix3d pull = rest.volume * stress * rest.gradients.transpose();
  for (std::size_t a = 1; a < 4; ++a)
    as_vector(f[static_cast<std::size_t>(points[a])]) -= pull.col(static_cast<Eigen::Index>(a) - 1);
  as_vector(f[static_cast<std::size_t>(points[0])]) += pull.rowwise().sum();
}

}  // namespace hmax
