/// Cofactors of small matrices.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hmax {

/// dJ/dF of J = det F, J F^-T where F is regular: columns f2 x f3, f3 x f1, f1 x f2, shape (3, 3).
template <class Real>
[[nodiscard]] Eigen::Matrix<Real, 3, 3> cofactors(const Eigen::Matrix<Real, 3, 3>& F) {
  Eigen::Matrix<Real, 3, 3> C;
  for (int j = 0; j < 3; ++j) C.col(j) = F.col((j + 1) % 3).cross(F.col((j + 2) % 3));
  return C;
}

}  // namespace hmax
