/// Eigen's dense eigenvalue solvers, compiled once: they are what takes longest to compile.
#pragma once

#include <Eigen/Eigenvalues>

namespace Eigen {
extern template class EigenSolver<MatrixXd>;
extern template class SelfAdjointEigenSolver<MatrixXd>;
}  // namespace Eigen
