#include "analysis/spectrum/eigen_solvers.hpp"

#include <algorithm>
#include <numeric>

namespace Eigen {
template class EigenSolver<MatrixXd>;
template class SelfAdjointEigenSolver<MatrixXd>;
}  // namespace Eigen

namespace hmax {

SortedEigenpairs::SortedEigenpairs(const Eigen::MatrixXd& A) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  if (solver.info() != Eigen::Success) return;
  const Eigen::VectorXcd lambda = solver.eigenvalues();
  const Eigen::MatrixXcd unsorted = solver.eigenvectors();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(A.rows()));
  std::iota(order.begin(), order.end(), Eigen::Index(0));
  std::ranges::stable_sort(
      order, [&](Eigen::Index a, Eigen::Index b) { return std::abs(lambda[a]) > std::abs(lambda[b]); });
  vectors.resize(A.rows(), A.rows());
  for (const Eigen::Index i : order) {
    vectors.col(static_cast<Eigen::Index>(values.size())) = unsorted.col(i).normalized();
    values.push_back(lambda[i]);
  }
}

}  // namespace hmax
