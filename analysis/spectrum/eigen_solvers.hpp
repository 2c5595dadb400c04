/// Eigen's dense eigenvalue solvers, compiled once: they are what takes longest to compile.
#pragma once

#include <complex>
#include <vector>

#include <Eigen/Eigenvalues>

namespace Eigen {
extern template class EigenSolver<MatrixXd>;
extern template class SelfAdjointEigenSolver<MatrixXd>;
}  // namespace Eigen

namespace hmax {

/// The eigenpairs of a real matrix, the largest modulus first; conjugates, which have one modulus, side by side.
struct SortedEigenpairs {
  std::vector<std::complex<double>> values;  ///< none where the QR algorithm does not converge
  Eigen::MatrixXcd vectors;                  ///< columns of length 1, shape (n, n)

  /// @param A  shape (n, n), finite; 25 n^3 operations
  explicit SortedEigenpairs(const Eigen::MatrixXd& A);
};

}  // namespace hmax
