/// Displacements of points of pieces, by the numbers of the free ones.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// Of a free point, or of a held one, -1, which stands at rest.
/// @param q  shape (3 free points)
inline Eigen::Vector3d displacement_of(const Eigen::VectorXd& q, TetMesh::Index free) {
  return free < 0 ? Eigen::Vector3d::Zero()
                  : Eigen::Vector3d(q.segment<3>(3 * static_cast<Eigen::Index>(free)));
}

/// (u1 - u0, u2 - u0, u3 - u0) of a tetrahedron, as edge_vectors() of tet_elements.hpp.
inline Eigen::Matrix3d edge_vectors_of(const Eigen::VectorXd& q,
                                       const std::array<TetMesh::Index, 4>& points) {
  const Eigen::Vector3d origin = displacement_of(q, points[0]);
  Eigen::Matrix3d Ds;
  for (std::size_t a = 1; a < 4; ++a)
    Ds.col(static_cast<Eigen::Index>(a) - 1) = displacement_of(q, points[a]) - origin;
  return Ds;
}

}  // namespace hmax
