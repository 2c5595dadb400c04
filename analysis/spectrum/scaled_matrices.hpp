/// Stiffness and damping of a structure in coordinates where its mass is one.
#pragma once

#include <Eigen/Core>

#include "analysis/spectrum/block_product.hpp"
#include "analysis/spectrum/largest_of_sum.hpp"
#include "analysis/spectrum/linear_model.hpp"

namespace hmax {

/// R^-T A R^-1 of a symmetric A with M = R^T R, for products with many vectors: of lumped masses M^-1/2 A
/// M^-1/2.
class MassScaledProduct {
 public:
  /// @param A  shape (n, n); a dense matrix is stored as a sparse one without its zeros
  MassScaledProduct(const AnyMatrix& A, const MassMatrix<double>& M);

  [[nodiscard]] Eigen::Index rows() const { return A_.rows(); }
  /// A itself where M couples; else the product itself.
  [[nodiscard]] const SymmetricProduct& unscaled() const { return A_; }
  /// y = R^-T A R^-1 x; x and y have shape (n) and must be different vectors.
  void operator()(const Eigen::VectorXd& x, Eigen::VectorXd& y) const { apply(x.data(), y.data()); }
  /// The same of numbers that stand anywhere.
  void apply(const double* x, double* y) const;

 private:
  MassMatrix<double> M_;
  SymmetricProduct A_;  ///< scaled where M is diagonal
};

struct LargestEigenpair {
  double bound = 0;        ///< the eigenvalue with its residual added: none is larger
  Eigen::VectorXd vector;  ///< in coordinates where a diagonal mass is one, of length 1 in the norm of the
                           ///< mass, shape (n)
};

/// k = R^-T K R^-1 and c = R^-T C R^-1 of symmetric K and C.
struct ScaledMatrices {
  MassMatrix<double> mass;
  MassScaledProduct k;  ///< [1/s^2]
  MassScaledProduct c;  ///< [1/s]

  /// @param part  K and C symmetric; may be released afterwards
  explicit ScaledMatrices(const MechanicalPart& part);
  [[nodiscard]] Eigen::Index size() const { return mass.size(); }
  /// u of the model for x in the coordinates of the products, where a diagonal mass is one.
  [[nodiscard]] Eigen::VectorXcd shape_of(const Eigen::VectorXcd& x) const;
  /// The largest eigenvalues, by iteration until residuals are at most `tolerance` of them.
  [[nodiscard]] LargestEigenpair largest_k(double tolerance = 1e-6) const;
  [[nodiscard]] LargestEigenpair largest_c(double tolerance = 1e-6) const;
  /// The largest eigenvalues of sums a c + b k, by Lanczos iteration. This must outlive it.
  /// @param most_c, most_k  no less than the largest eigenvalues of c [1/s] and k [1/s^2]
  [[nodiscard]] FindLargestOfSum largest_of_sum(double most_c, double most_k) const;
};

}  // namespace hmax
