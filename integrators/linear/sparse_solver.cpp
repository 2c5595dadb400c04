#include "integrators/linear/sparse_solver.hpp"

namespace hmax {

template class SparseSolver<double>;
template void SparseSolver<double>::solve(Eigen::VectorXd&);

}  // namespace hmax
