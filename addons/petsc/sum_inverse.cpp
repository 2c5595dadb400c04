#include "addons/petsc/sum_inverse.hpp"

#include <stdexcept>
#include <string>

namespace hmax::petsc {
namespace {

const std::string of_sum = "a sum of mass and stiffness is not divided by";

/// A product with a M + b K.
struct Sum {
  Mat K, M;  ///< M null for I
  double a, b;
};

/// out = (a M + b K) x
PetscErrorCode multiply(Mat shell, Vec x, Vec out) {
  Sum* sum = nullptr;
  PetscCall(MatShellGetContext(shell, static_cast<void*>(&sum)));
  PetscCall(MatMult(sum->K, x, out));
  if (!sum->M) {
    PetscCall(VecAXPBY(out, sum->a, sum->b, x));
    return 0;
  }
  PetscCall(VecScale(out, sum->b / sum->a));
  PetscCall(MatMultAdd(sum->M, x, out, out));
  PetscCall(VecScale(out, sum->a));
  return 0;
}

/// out = a diag(M) + b diag(K)
PetscErrorCode diagonal(Mat shell, Vec out) {
  Sum* sum = nullptr;
  PetscCall(MatShellGetContext(shell, static_cast<void*>(&sum)));
  PetscCall(MatGetDiagonal(sum->K, out));
  if (!sum->M) {
    PetscCall(VecScale(out, sum->b));
    PetscCall(VecShift(out, sum->a));
    return 0;
  }
  Vec of_M = nullptr;
  PetscCall(VecDuplicate(out, &of_M));
  PetscCall(MatGetDiagonal(sum->M, of_M));
  PetscCall(VecAXPBY(out, sum->a, sum->b, of_M));
  PetscCall(VecDestroy(&of_M));
  return 0;
}

class SumInverse final : public StructureOperator::Inverse {
 public:
  SumInverse(Mat K, Mat M, double a, double b) : sum_{K, M, a, b} {
    MPI_Comm world = MPI_COMM_WORLD;
    PetscInt rows = 0;
    check(MatGetLocalSize(K, &rows, nullptr), of_sum);
    check(MatCreateShell(world, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, &sum_, shell_.out()), of_sum);
    check(MatShellSetOperation(shell_, MATOP_MULT, reinterpret_cast<void (*)()>(multiply)), of_sum);
    check(MatShellSetOperation(shell_, MATOP_GET_DIAGONAL, reinterpret_cast<void (*)()>(diagonal)), of_sum);
    check(MatCreateVecs(K, x_.out(), right_.out()), of_sum);
    solver_ = gradients_for(shell_, 5000);
  }

  int apply(double* x) override {
    const Placed in(x_, x);
    check(sum_.M ? MatMult(sum_.M, x_, right_) : VecCopy(x_, right_), of_sum);
    return solve(solver_, right_, x_, "the equations of a step are not solved");
  }

 private:
  Sum sum_;
  Matrix shell_;
  Vector x_, right_;
  LinearSolver solver_;
};

}  // namespace

LinearSolver gradients_for(Mat A, PetscInt most) {
  LinearSolver solver;
  check(KSPCreate(MPI_COMM_WORLD, solver.out()), of_sum);
  check(KSPSetOperators(solver, A, A), of_sum);
  check(KSPSetType(solver, KSPCG), of_sum);
  PC of_diagonal = nullptr;
  check(KSPGetPC(solver, &of_diagonal), of_sum);
  check(PCSetType(of_diagonal, PCJACOBI), of_sum);
  check(KSPSetTolerances(solver, 1e-14, 0, PETSC_DEFAULT, most), of_sum);
  check(KSPSetNormType(solver, KSP_NORM_NATURAL), of_sum);
  check(KSPSetUp(solver), of_sum);
  return solver;
}

int solve(KSP solver, Vec b, Vec x, const std::string& what) {
  check(KSPSolve(solver, b, x), what);
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(solver, &reason), what);
  // A run beyond its limit may come to what is not finite, which it then has to show.
  if (reason == KSP_DIVERGED_ITS || reason == KSP_DIVERGED_INDEFINITE_MAT)
    throw std::runtime_error(
        what +
        ": conjugate gradients do not converge; see whether the mass matrix is positive definite, "
        "or lump it");
  PetscInt iterations = 0;
  check(KSPGetIterationNumber(solver, &iterations), what);
  return static_cast<int>(iterations);
}

std::unique_ptr<StructureOperator::Inverse> inverse_of_sum(Mat K, Mat M, double a, double b) {
  return std::make_unique<SumInverse>(K, M, a, b);
}

}  // namespace hmax::petsc
