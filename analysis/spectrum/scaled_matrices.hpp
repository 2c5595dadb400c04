/// Stiffness and damping of a structure in coordinates where its mass is one.
#pragma once

#include <Eigen/Core>

#include "analysis/spectrum/block_product.hpp"
#include "analysis/spectrum/linear_model.hpp"

namespace hmax {

/// k = M^-1/2 K M^-1/2 and c = M^-1/2 C M^-1/2 of symmetric K and C, for products with many vectors.
struct ScaledMatrices {
  Eigen::VectorXd inverse_root;  ///< the diagonal of M^-1/2, shape (n)
  SymmetricProduct k;            ///< [1/s^2]
  SymmetricProduct c;            ///< [1/s]

  /// @param part  K and C symmetric; may be released afterwards
  explicit ScaledMatrices(const MechanicalPart& part);
  [[nodiscard]] Eigen::Index size() const { return inverse_root.size(); }
  /// The largest eigenvalues, by Lanczos iteration to 1e-6, with their residuals added.
  [[nodiscard]] double largest_k() const;
  [[nodiscard]] double largest_c() const;
};

}  // namespace hmax
