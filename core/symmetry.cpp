#include "core/symmetry.hpp"

#include <algorithm>
#include <cmath>

namespace hmax {

using Sparse = Eigen::SparseMatrix<double>;

namespace {

/// Whether both store the same entries in the same order, so that values stand side by side.
bool same_pattern(const Sparse& A, const Sparse& B) {
  return A.isCompressed() && B.isCompressed() && A.rows() == B.rows() && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.cols() + 1, B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

template <class Visit>
void for_each_entry(const Sparse& A, const Visit& visit) {
  for (Eigen::Index j = 0; j < A.outerSize(); ++j)
    for (Sparse::InnerIterator entry(A, j); entry; ++entry) visit(entry.row(), j, entry.value());
}

}  // namespace

std::optional<std::pair<Eigen::Index, Eigen::Index>> first_asymmetry(const Sparse& A, double noise) {
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(A.rows());
  for_each_entry(A, [&](Eigen::Index i, Eigen::Index j, double value) {
    for (const Eigen::Index k : {i, j}) largest(k) = std::max(largest(k), std::abs(value));
  });
  const double let_pass = A.rows() > 0 ? noise * largest.maxCoeff() : 0;
  Sparse difference = A.transpose();
  if (same_pattern(A, difference))
    difference.coeffs() = A.coeffs() - difference.coeffs();
  else
    difference = A - Sparse(difference);
  std::optional<std::pair<Eigen::Index, Eigen::Index>> found;
  for_each_entry(difference, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (found || value == 0) return;
    const double a = largest(i), b = largest(j);
    const double allowed = std::max({1e-9 * std::sqrt(a) * std::sqrt(b), 1e-14 * std::max(a, b), let_pass});
    if (std::abs(value) > allowed) found = {i, j};
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
