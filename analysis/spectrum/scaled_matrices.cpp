#include "analysis/spectrum/scaled_matrices.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "analysis/spectrum/davidson.hpp"
#include "analysis/spectrum/lanczos.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// Scaled by diagonal masses; one that couples is left to each product.
SymmetricProduct product_of(const AnyMatrix& A, const MassMatrix<double>& M) {
  const VectorXd scale =
      M.is_diagonal() ? VectorXd(M.diagonal().cwiseSqrt().cwiseInverse()) : VectorXd::Ones(M.size());
  if (is_sparse(A)) return {std::get<Sparse>(A), scale};
  return {Sparse(std::get<Eigen::MatrixXd>(A).sparseView()), scale};
}

/// An eigenvalue lies within the residual of the Ritz value; the Ritz value is below the largest.
LargestEigenpair largest(const MassScaledProduct& A, const MassMatrix<double>& M, double tolerance) {
  const LanczosPair pair = largest_eigenpair(std::cref(A.unscaled()), M, {.tolerance = tolerance});
  return {pair.value + pair.residual, pair.vector};
}

}  // namespace

MassScaledProduct::MassScaledProduct(const AnyMatrix& A, const MassMatrix<double>& M)
    : M_(M), A_(product_of(A, M)) {}

void MassScaledProduct::apply(const double* x, double* y) const {
  if (M_.is_diagonal()) return A_.apply(x, y);
  VectorXd shape = Eigen::Map<const VectorXd>(x, rows()), force(rows());
  M_.coupled()->root_solve(shape);
  A_(shape, force);
  M_.coupled()->transposed_root_solve(force);
  std::copy_n(force.data(), rows(), y);
}

ScaledMatrices::ScaledMatrices(const MechanicalPart& part)
    : mass(part.mass), k(part.K, part.mass), c(part.C, part.mass) {}

Eigen::VectorXcd ScaledMatrices::shape_of(const Eigen::VectorXcd& x) const {
  return mass.is_diagonal() ? mass.root_solve(x) : x;
}

LargestEigenpair ScaledMatrices::largest_k(double tolerance) const { return largest(k, mass, tolerance); }
LargestEigenpair ScaledMatrices::largest_c(double tolerance) const { return largest(c, mass, tolerance); }

FindLargestOfSum ScaledMatrices::largest_of_sum(double most_c, double most_k) const {
  return [this, most_c, most_k](double a, double b, double tolerance) -> LargestOfSum {
    // Shifted so that no eigenvalue is negative.
    const double shift = std::max(-a, 0.0) * most_c + std::max(-b, 0.0) * most_k;
    Eigen::VectorXd damped(size()), stiffened(size());
    LanczosPair pair = largest_eigenpair(
        [&](const Eigen::VectorXd& x, Eigen::VectorXd& y) {
          c(x, damped);
          k(x, y);
          y = shift * x + a * damped + b * y;
        },
        size(), {.tolerance = tolerance});
    c(pair.vector, damped);
    k(pair.vector, stiffened);
    return {.value = pair.value - shift,
            .residual = pair.residual,
            .gamma = pair.vector.dot(damped),
            .kappa = pair.vector.dot(stiffened),
            .converged = pair.converged,
            .vector = std::move(pair.vector)};
  };
}

}  // namespace hmax
