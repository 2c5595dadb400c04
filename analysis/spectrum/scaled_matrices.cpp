#include "analysis/spectrum/scaled_matrices.hpp"

#include <algorithm>

#include "analysis/spectrum/lanczos.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// A dense matrix is stored as a sparse one without its zeros.
SymmetricProduct product_of(const AnyMatrix& A, const VectorXd& scale) {
  if (is_sparse(A)) return {std::get<Sparse>(A), scale};
  return {Sparse(std::get<Eigen::MatrixXd>(A).sparseView()), scale};
}

/// An eigenvalue lies within the residual of the Ritz value; the Ritz value is below the largest.
double largest(const SymmetricProduct& A) {
  const LanczosPair pair =
      largest_eigenpair([&](const VectorXd& x, VectorXd& y) { A(x, y); }, A.rows(), {.with_vector = false});
  return pair.value + pair.residual;
}

}  // namespace

ScaledMatrices::ScaledMatrices(const MechanicalPart& part)
    : inverse_root(part.mass.cwiseSqrt().cwiseInverse()),
      k(product_of(part.K, inverse_root)),
      c(product_of(part.C, inverse_root)) {}

double ScaledMatrices::largest_k() const { return largest(k); }
double ScaledMatrices::largest_c() const { return largest(c); }

}  // namespace hmax
