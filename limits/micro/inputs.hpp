/// What is measured in both sources.
#pragma once

#include <cstdlib>

#include <Eigen/Core>

#include "analysis/spectrum/block_product.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

inline Eigen::MatrixXd some_matrix(Eigen::Index n) {
  std::srand(1);
  return Eigen::MatrixXd::Random(n, n);
}

/// M^-1/2 K M^-1/2 of a ball of so many shells: 4 have 927 degrees of freedom, 20 about 84,000.
inline SymmetricProduct ball_product(Eigen::Index shells) {
  const TissueBody body(ball_mesh(0.1, static_cast<int>(shells)), {});
  TissueBody::DofMatrix K;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(body.dofs());
  body.stiffness(0, rest, rest, K);
  return {K, body.mass().cwiseSqrt().cwiseInverse()};
}

}  // namespace hmax
