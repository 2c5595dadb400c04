#include "problems/matrices/symmetry.hpp"

#include <algorithm>
#include <cmath>

#include "problems/matrix_entries.hpp"

namespace hmax {

using Sparse = Eigen::SparseMatrix<double>;

namespace {

/// Whether both store the same entries in the same order, so that values stand side by side.
bool same_pattern(const Sparse& A, const Sparse& B) {
  return A.isCompressed() && B.isCompressed() && A.rows() == B.rows() && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1, B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

}  // namespace

std::optional<std::pair<Eigen::Index, Eigen::Index>> first_asymmetry(const Sparse& A) {
  Sparse difference = A.transpose();
  if (same_pattern(A, difference))
    difference.coeffs() = A.coeffs() - difference.coeffs();
  else
    difference = A - Sparse(difference);
  const double allowed = 1e-10 * (A.nonZeros() > 0 ? A.coeffs().cwiseAbs().maxCoeff() : 0.0);
  std::optional<std::pair<Eigen::Index, Eigen::Index>> found;
  each_entry(difference, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (!found && std::abs(value) > allowed) found = {i, j};
  });
  return found;
}

Sparse symmetrised(const Sparse& A) {
  Sparse mean = A.transpose();
  if (!same_pattern(A, mean)) return 0.5 * (A + mean);
  mean.coeffs() = 0.5 * (A.coeffs() + mean.coeffs());
  return mean;
}

}  // namespace hmax
