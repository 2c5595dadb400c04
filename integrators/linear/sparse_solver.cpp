/// Explicit instantiations: solvers of double and long double, and Eigen's L U for all four scalars,
/// compiled once, here.
#include "integrators/linear/sparse_solver.hpp"

namespace hmax {

template class SparseSolver<double>;
template class SparseSolver<long double>;
template int SparseSolver<double>::solve(Eigen::VectorXd&);

}  // namespace hmax

namespace Eigen {
template void SparseLU<SparseMatrix<double>, COLAMDOrdering<int>>::analyzePattern(const SparseMatrix<double>&);
template void SparseLU<SparseMatrix<double>, COLAMDOrdering<int>>::factorize(const SparseMatrix<double>&);
template void SparseLU<SparseMatrix<long double>, COLAMDOrdering<int>>::analyzePattern(const SparseMatrix<long double>&);
template void SparseLU<SparseMatrix<long double>, COLAMDOrdering<int>>::factorize(const SparseMatrix<long double>&);
template void SparseLU<SparseMatrix<std::complex<double>>, COLAMDOrdering<int>>::analyzePattern(const SparseMatrix<std::complex<double>>&);
template void SparseLU<SparseMatrix<std::complex<double>>, COLAMDOrdering<int>>::factorize(const SparseMatrix<std::complex<double>>&);
template void SparseLU<SparseMatrix<std::complex<long double>>, COLAMDOrdering<int>>::analyzePattern(const SparseMatrix<std::complex<long double>>&);
template void SparseLU<SparseMatrix<std::complex<long double>>, COLAMDOrdering<int>>::factorize(const SparseMatrix<std::complex<long double>>&);
}  // namespace Eigen
