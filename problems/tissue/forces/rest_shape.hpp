/// The shape of a tetrahedron at rest.
#pragma once

#include <array>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// A tetrahedron at rest. Rounding to double comes last: in a sliver the volume is a difference of products.
struct RestShape {
  RestShape(const TetMesh& mesh, const std::array<TetMesh::Index, 4>& points);
  /// Bm as kernels take it, row a at g[a].
  void write_rows(double (*g)[3]) const {
    for (Eigen::Index a = 0; a < 3; ++a)
      for (Eigen::Index j = 0; j < 3; ++j) g[a][j] = gradients(a, j);
  }
  Eigen::Matrix3d gradients;  ///< Bm = (X1 - X0, X2 - X0, X3 - X0)^-1 [1/m]
  double volume;              ///< [m^3], negative when the points are in the other order
};

}  // namespace hmax
