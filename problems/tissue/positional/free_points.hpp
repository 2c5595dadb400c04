/// Displacements of points of pieces, by the numbers of the free ones.
#pragma once

#include <array>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// The three numbers of a free point, or of a held one, -1, which stands at rest.
/// @param q  shape (3 free points)
[[gnu::always_inline]] inline const double* displacement_at(const double* q, TetMesh::Index free) {
  static constexpr std::array<double, 3> held{};
  return free < 0 ? held.data() : q + 3 * static_cast<Eigen::Index>(free);
}

inline Eigen::Vector3d displacement_of(const Eigen::VectorXd& q, TetMesh::Index free) {
  return Eigen::Map<const Eigen::Vector3d>(displacement_at(q.data(), free));
}

}  // namespace hmax
