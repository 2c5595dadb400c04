#include "analysis/spectrum/eigen_solvers.hpp"

namespace Eigen {
template class EigenSolver<MatrixXd>;
template class SelfAdjointEigenSolver<MatrixXd>;
}  // namespace Eigen
