/// Eigen's dense solvers, compiled once: they are what takes longest to compile.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

// The decompositions themselves, and no more of their classes: members that nobody calls take as long to
// compile. Arguments of type MatrixXd use these instances; an expression instantiates its own.
namespace Eigen {
extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);
extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::computeFromTridiagonal(
    const VectorXd&, const VectorXd&, int);
extern template GeneralizedSelfAdjointEigenSolver<MatrixXd>&
GeneralizedSelfAdjointEigenSolver<MatrixXd>::compute(const MatrixXd&, const MatrixXd&, int);
extern template void FullPivLU<MatrixXd>::computeInPlace();
extern template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template void PartialPivLU<MatrixXd>::compute();
extern template void PartialPivLU<MatrixXcd>::compute();
extern template void CompleteOrthogonalDecomposition<MatrixXd>::computeInPlace();
extern template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
}  // namespace Eigen

namespace hmax {

/// The eigenpairs of a real matrix, the largest modulus first; conjugates, which have one modulus, side by
/// side.
struct SortedEigenpairs {
  std::vector<std::complex<double>> values;  ///< none where the QR algorithm does not converge
  Eigen::MatrixXcd vectors;                  ///< columns of length 1, shape (n, n)

  /// @param A  shape (n, n), finite; 25 n^3 operations
  explicit SortedEigenpairs(const Eigen::MatrixXd& A);
};

/// The eigenvalues of a real matrix, shape (n, n), in Eigen's order.
Eigen::VectorXcd dense_eigenvalues(const Eigen::MatrixXd& A);

/// The largest eigenvalue of a symmetric matrix, shape (n, n), n > 0, finite.
double largest_eigenvalue_of(const Eigen::MatrixXd& A);

/// |A| |A^-1| in the norm of the largest singular value; infinity, or some 1e16 and more, where A is
/// singular.
/// @param A  shape (n, n), n > 0, finite
double condition_of(const Eigen::MatrixXd& A);

/// The shortest x with the least |A x - b|, by a complete orthogonal decomposition.
/// @param A  shape (m, n), of any rank
/// @param threshold  pivots below this share of the largest are zero; Eigen's default otherwise
Eigen::VectorXd minimum_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                      std::optional<double> threshold = std::nullopt);

/// Orthonormal columns that span those of A, shape (m, n), m >= n.
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& A);

}  // namespace hmax
