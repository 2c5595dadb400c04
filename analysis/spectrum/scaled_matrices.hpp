/// Stiffness and damping of a structure in coordinates where its mass is one.
#pragma once

#include <Eigen/Core>

#include "analysis/spectrum/block_product.hpp"
#include "analysis/spectrum/linear_model.hpp"

namespace hmax {

/// R^-T A R^-1 of a symmetric A with M = R^T R, for products with many vectors: of lumped masses M^-1/2 A M^-1/2.
class MassScaledProduct {
 public:
  /// @param A  shape (n, n); a dense matrix is stored as a sparse one without its zeros
  MassScaledProduct(const AnyMatrix& A, const MassMatrix<double>& M);

  [[nodiscard]] Eigen::Index rows() const { return A_.rows(); }
  /// A itself, where M couples.
  [[nodiscard]] const SymmetricProduct& unscaled() const { return A_; }
  /// y = R^-T A R^-1 x; x and y have shape (n) and must be different vectors.
  void operator()(const Eigen::VectorXd& x, Eigen::VectorXd& y) const { apply(x.data(), y.data()); }
  /// The same of numbers that stand anywhere.
  void apply(const double* x, double* y) const;

 private:
  MassMatrix<double> M_;
  SymmetricProduct A_;  ///< scaled where M is diagonal
};

/// k = R^-T K R^-1 and c = R^-T C R^-1 of symmetric K and C.
struct ScaledMatrices {
  MassMatrix<double> mass;
  MassScaledProduct k;  ///< [1/s^2]
  MassScaledProduct c;  ///< [1/s]

  /// @param part  K and C symmetric; may be released afterwards
  explicit ScaledMatrices(const MechanicalPart& part);
  [[nodiscard]] Eigen::Index size() const { return mass.size(); }
  /// The largest eigenvalues, by iteration to 1e-6, with their residuals added.
  [[nodiscard]] double largest_k() const;
  [[nodiscard]] double largest_c() const;
};

}  // namespace hmax
