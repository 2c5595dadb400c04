/// Sparse equations through KLU, which comes with the library.
#include <algorithm>

#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include "integrators/sundials/equations.hpp"

namespace hmax::sundials {

/// Both sides store columns, with row indices that ascend; the indices of the library have 64 bits, those of
/// Eigen 32, so that each is converted on the way. Values are copied along with the pattern.
MatrixHandle make_klu_matrix(const Eigen::SparseMatrix<double>& pattern, SUNContext context) {
  SUNMatrix A = SUNSparseMatrix(pattern.rows(), pattern.cols(), pattern.nonZeros(), CSC_MAT, context);
  if (A == nullptr) throw std::bad_alloc();
  MatrixHandle made(A);
  copy_to_klu_matrix(pattern, A);
  return made;
}

/// The library looks at the kind and the size of both and keeps neither. A null pointer is taken for a want
/// of memory: matrices and vectors of another kind, which it refuses too, do not come here.
LinearSolverHandle make_klu_solver(N_Vector like, SUNMatrix A, SUNContext context) {
  LinearSolverHandle made(SUNLinSol_KLU(like, A, context));
  if (!made) throw std::bad_alloc();
  return made;
}

/// Arrays of `from`: where columns begin, shape (n + 1), then rows and values, shape (entries). It must be
/// compressed, as differences of two sparse matrices are.
void copy_to_klu_matrix(const Eigen::SparseMatrix<double>& from, SUNMatrix A) {
  // More entries than before: the library needs more memory.
  if (from.nonZeros() > SUNSparseMatrix_NNZ(A) &&
      SUNSparseMatrix_Reallocate(A, from.nonZeros()) != SUNMAT_SUCCESS)
    throw std::bad_alloc();
  std::copy_n(from.outerIndexPtr(), from.outerSize() + 1, SUNSparseMatrix_IndexPointers(A));
  std::copy_n(from.innerIndexPtr(), from.nonZeros(), SUNSparseMatrix_IndexValues(A));
  std::copy_n(from.valuePtr(), from.nonZeros(), SUNSparseMatrix_Data(A));
}

}  // namespace hmax::sundials
