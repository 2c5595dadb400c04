#include "core/dense_solvers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace Eigen {
template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);
template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::computeFromTridiagonal(
    const VectorXd&, const VectorXd&, int);
template GeneralizedSelfAdjointEigenSolver<MatrixXd>& GeneralizedSelfAdjointEigenSolver<MatrixXd>::compute(
    const MatrixXd&, const MatrixXd&, int);
template void FullPivLU<MatrixXd>::computeInPlace();
template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
template void PartialPivLU<MatrixXd>::compute();
template void PartialPivLU<MatrixXcd>::compute();
template void CompleteOrthogonalDecomposition<MatrixXd>::computeInPlace();
template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
}  // namespace Eigen

namespace hmax {

SortedEigenpairs::SortedEigenpairs(const Eigen::MatrixXd& A) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(A);
  if (solver.info() != Eigen::Success) return;
  const Eigen::VectorXcd& lambda = solver.eigenvalues();
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

Eigen::VectorXcd dense_eigenvalues(const Eigen::MatrixXd& A) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues();
}

double largest_eigenvalue_of(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

// Of A and of A^-1 the largest singular value alone: the least one of A would lose digits in A^T A.
double condition_of(const Eigen::MatrixXd& A) {
  const double size = A.cwiseAbs().maxCoeff();
  if (size == 0) return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd scaled = A / size, inverse = scaled.partialPivLu().inverse();
  const Eigen::MatrixXd of_inverse = inverse.transpose() * inverse;
  if (!of_inverse.allFinite()) return std::numeric_limits<double>::infinity();
  return std::sqrt(largest_eigenvalue_of(scaled.transpose() * scaled) * largest_eigenvalue_of(of_inverse));
}

Eigen::VectorXd minimum_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                      std::optional<double> threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  if (threshold) solver.setThreshold(*threshold);
  return solver.compute(A).solve(b);
}

Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& A) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).householderQ() *
         Eigen::MatrixXd::Identity(A.rows(), A.cols());
}

}  // namespace hmax
