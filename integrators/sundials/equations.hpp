/// The linear equations (I - gamma J) x = b inside a Newton iteration of SUNDIALS: our Jacobians, and our
/// solver or KLU, as a SUNMatrix and a SUNLinearSolver of the library.
#pragma once

#include <memory>
#include <new>

#include <Eigen/SparseCore>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include "integrators/linear/linear_solver.hpp"
#include "integrators/sundials/vector.hpp"

namespace hmax::sundials {

/// Frees a matrix of the library by its own function.
struct DestroyMatrix {
  void operator()(SUNMatrix A) const { SUNMatDestroy(A); }
};
using MatrixHandle = std::unique_ptr<_generic_SUNMatrix, DestroyMatrix>;
/// Frees a solver of the library by its own function.
struct FreeLinearSolver {
  void operator()(SUNLinearSolver solver) const { SUNLinSolFree(solver); }
};
using LinearSolverHandle = std::unique_ptr<_generic_SUNLinearSolver, FreeLinearSolver>;

/// The matrix I - gamma J in the type of our Jacobian. The library never looks inside: it is written by a
/// function of ours and read by a solver of ours.
template <class Matrix>
Matrix& matrix_of(SUNMatrix A) {
  return *static_cast<Matrix*>(A->content);
}

/// An empty matrix of ours as a SUNMatrix of the kind `custom`; sized by the first set_shifted().
/// @throws std::bad_alloc
template <class Matrix>
MatrixHandle make_matrix(SUNContext context) {
  auto content = std::make_unique<Matrix>();
  SUNMatrix A = SUNMatNewEmpty(context);
  if (A == nullptr) throw std::bad_alloc();
  // custom: the library does not look inside.
  A->ops->getid = [](SUNMatrix) { return SUNMATRIX_CUSTOM; };
  A->ops->destroy = [](SUNMatrix made) {
    delete static_cast<Matrix*>(made->content);
    SUNMatFreeEmpty(made);
  };
  // From here on the operation `destroy` frees it.
  A->content = content.release();
  return MatrixHandle(A);
}

/// LinearSolver<Matrix> as a SUNLinearSolver: set up by factoring, solved by substitution. A singular matrix
/// is a failure that the library may recover from, with a shorter step.
/// @tparam State   the state in the vectors of the run;  @tparam Matrix  type of I - gamma J
/// @throws std::bad_alloc
template <class State, class Matrix>
LinearSolverHandle make_linear_solver(SUNContext context) {
  using Solver = LinearSolver<Matrix>;
  auto content = std::make_unique<Solver>();
  SUNLinearSolver made = SUNLinSolNewEmpty(context);
  if (made == nullptr) throw std::bad_alloc();
  // direct: one setup serves all solutions until the next setup.
  made->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; };
  made->ops->getid = [](SUNLinearSolver) { return SUNLINEARSOLVER_CUSTOM; };
  // Exceptions may not pass through the library: they become its flags.
  made->ops->setup = [](SUNLinearSolver solver, SUNMatrix A) -> int {
    try {
      return static_cast<Solver*>(solver->content)->factor(matrix_of<Matrix>(A)) ? SUNLS_SUCCESS
                                                                                 : SUNLS_LUFACT_FAIL;
    } catch (const std::bad_alloc&) {
      return SUNLS_MEM_FAIL;
    } catch (...) {  // whoever called the library leaves, see integrate()
      return SUNLS_PACKAGE_FAIL_UNREC;
    }
  };
  made->ops->solve = [](SUNLinearSolver solver, SUNMatrix, N_Vector x, N_Vector b, realtype) -> int {
    try {
      State& solution = state_of<State>(x);
      // Solved in place, in the vector of the solution.
      if (x != b) solution = state_of<State>(b);
      static_cast<Solver*>(solver->content)->solve(solution);
      return SUNLS_SUCCESS;
    } catch (const std::bad_alloc&) {
      return SUNLS_MEM_FAIL;
    } catch (...) {  // whoever called the library leaves, see integrate()
      return SUNLS_PACKAGE_FAIL_UNREC;
    }
  };
  made->ops->free = [](SUNLinearSolver solver) -> int {
    delete static_cast<Solver*>(solver->content);
    solver->content = nullptr;
    SUNLinSolFreeEmpty(solver);
    return SUNLS_SUCCESS;
  };
  // From here on the operation `free` frees it.
  made->content = content.release();
  return LinearSolverHandle(made);
}

/// A sparse matrix of the library for the pattern of I - gamma J, shape (n, n), by columns.
/// @throws std::bad_alloc
MatrixHandle make_klu_matrix(const Eigen::SparseMatrix<double>& pattern, SUNContext context);
/// KLU for such a matrix: L U with its own order and pivoting, analysed at the first setup.
/// @param like  any vector of the run
LinearSolverHandle make_klu_solver(N_Vector like, SUNMatrix A, SUNContext context);

/// Copies a matrix into one made by make_klu_matrix; it gets more memory where there are more entries.
/// @throws std::bad_alloc
void copy_to_klu_matrix(const Eigen::SparseMatrix<double>& from, SUNMatrix A);

}  // namespace hmax::sundials
