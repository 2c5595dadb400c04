#include "problems/matrices/symmetry.hpp"

#include <cmath>

#include "problems/matrix_entries.hpp"

namespace hmax {

using Sparse = Eigen::SparseMatrix<double>;

std::optional<std::pair<Eigen::Index, Eigen::Index>> first_asymmetry(const Sparse& A) {
  const Sparse difference = A - Sparse(A.transpose());
  const double allowed = 1e-10 * (A.nonZeros() > 0 ? A.coeffs().cwiseAbs().maxCoeff() : 0.0);
  std::optional<std::pair<Eigen::Index, Eigen::Index>> found;
  each_entry(difference, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (!found && std::abs(value) > allowed) found = {i, j};
  });
  return found;
}

Sparse symmetrised(const Sparse& A) { return 0.5 * (A + Sparse(A.transpose())); }

}  // namespace hmax
