#include "addons/petsc/damped_ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "addons/petsc/distributed_matrix.hpp"
#include "addons/petsc/structure_ends.hpp"

namespace hmax::petsc {
namespace {

using Complex = std::complex<double>;
const MPI_Comm world = MPI_COMM_WORLD;
const std::string of_damped = "the eigenvalues of damped motion are not found";

Vector like(Vec x) {
  Vector copy;
  check(VecDuplicate(x, copy.out()), of_damped);
  return copy;
}

/// x^T A y of a symmetric A; null for I.
double form(Mat A, Vec x, Vec y) {
  PetscScalar value = 0;
  if (!A) {
    check(VecDot(x, y, &value), of_damped);
    return value;
  }
  const Vector image = like(y);
  check(MatMult(A, y, image), of_damped);
  check(VecDot(x, image, &value), of_damped);
  return value;
}

/// u^T A u of u = x + i y, without a conjugate.
Complex form(Mat A, Vec x, Vec y, bool is_real) {
  if (is_real) return form(A, x, x);
  return {form(A, x, x) - form(A, y, y), 2 * form(A, x, y)};
}

/// The root nearest to lambda of the quadratic that its vector x + i y makes: off by the square of its error.
Complex refined(const Damped& matrices, Complex lambda, Vec x, Vec y) {
  const bool is_real = lambda.imag() == 0;
  const Complex m = form(matrices.M, x, y, is_real), c = form(matrices.C, x, y, is_real) / m,
                k = form(matrices.K, x, y, is_real) / m;
  const Complex root = std::sqrt(c * c - 4.0 * k);
  const Complex plus = (-c + root) / 2.0, minus = (-c - root) / 2.0;
  const Complex nearest = std::abs(plus - lambda) < std::abs(minus - lambda) ? plus : minus;
  // Of a nearly double eigenvalue the quadratic is nearly singular.
  return std::abs(nearest - lambda) < 1e-6 * std::abs(lambda) ? nearest : lambda;
}

PolynomialSolver solver_of(const Damped& matrices, Mat M, std::size_t most) {
  PolynomialSolver pep;
  check(PEPCreate(world, pep.out()), of_damped);
  std::array<Mat, 3> all{matrices.K, matrices.C, M};
  check(PEPSetOperators(pep, 3, all.data()), of_damped);
  check(PEPSetProblemType(pep, PEP_HERMITIAN), of_damped);
  check(PEPSetType(pep, PEPTOAR), of_damped);
  check(PEPSetWhichEigenpairs(pep, PEP_LARGEST_MAGNITUDE), of_damped);
  check(PEPSetScale(pep, PEP_SCALE_SCALAR, PETSC_DEFAULT, nullptr, nullptr, PETSC_DEFAULT, PETSC_DEFAULT),
        of_damped);
  check(PEPSetTolerances(pep, 1e-9, 1000), of_damped);
  PetscInt rows = 0;
  check(MatGetSize(matrices.K, &rows, nullptr), of_damped);
  const auto wanted = std::min<PetscInt>(static_cast<PetscInt>(2 * most), rows);
  check(PEPSetDimensions(pep, wanted, std::min<PetscInt>(2 * wanted + 36, rows), PETSC_DEFAULT), of_damped);
  ST transformation = nullptr;
  KSP divide = nullptr;
  PC diagonal = nullptr;
  check(PEPGetST(pep, &transformation), of_damped);
  check(STGetKSP(transformation, &divide), of_damped);
  check(KSPSetType(divide, matrices.M ? KSPCG : KSPPREONLY), of_damped);
  check(KSPGetPC(divide, &diagonal), of_damped);
  check(PCSetType(diagonal, PCJACOBI), of_damped);
  check(KSPSetTolerances(divide, 1e-13, 0, PETSC_DEFAULT, 500), of_damped);
  const Vector start = fixed_vector(matrices.K);
  Vec space = start;
  check(PEPSetInitialSpace(pep, 1, &space), of_damped);
  check(PEPSetOptionsPrefix(pep, "hmax_"), of_damped);
  check(PEPSetFromOptions(pep), of_damped);
  return pep;
}

}  // namespace

SumEnd largest_of_sum(const Damped& matrices, double a, double b, double tolerance) {
  const std::string what = "the largest eigenvalue of damping and stiffness is not found";
  Matrix sum;
  check(MatDuplicate(matrices.K, MAT_COPY_VALUES, sum.out()), what);
  check(MatScale(sum, b), what);
  if (a != 0) check(MatAXPY(sum, a, matrices.C, DIFFERENT_NONZERO_PATTERN), what);
  const Solver eps = solver_for(sum, matrices.M, EPS_LARGEST_REAL, tolerance);
  check(EPSSetConvergenceTest(eps, EPS_CONV_ABS), what);
  PetscInt rows = 0, found = 0;
  check(MatGetSize(sum, &rows, nullptr), what);
  check(EPSSetDimensions(eps, 1, std::min<PetscInt>(rows, 40), PETSC_DEFAULT), what);
  check(EPSSetTolerances(eps, tolerance, 300), what);
  check(EPSSolve(eps), what);
  check(EPSGetConverged(eps, &found), what);
  SumEnd end;
  end.converged = found > 0;
  if (!end.converged) return end;
  Vector u, residual;
  check(MatCreateVecs(sum, u.out(), residual.out()), what);
  check(EPSGetEigenpair(eps, 0, &end.value, nullptr, u, nullptr), what);
  normalise(u, matrices.M);
  end.gamma = form(matrices.C, u, u);
  end.kappa = form(matrices.K, u, u);
  // r = (a C + b K - value M) u, in the norm of M^-1.
  const Vector weighted = like(u);
  check(matrices.M ? MatMult(matrices.M, u, weighted) : VecCopy(u, weighted), what);
  check(MatMult(sum, u, residual), what);
  check(VecAXPY(residual, -end.value, weighted), what);
  if (matrices.divide_by_M) check(KSPSolve(matrices.divide_by_M, residual, weighted), what);
  PetscScalar square = 0;
  check(VecDot(residual, matrices.divide_by_M ? static_cast<Vec>(weighted) : static_cast<Vec>(residual),
               &square),
        what);
  end.residual = std::sqrt(std::max(square, 0.0));
  return end;
}

std::vector<Complex> largest_damped(const Damped& matrices, std::size_t most) {
  const Matrix identity = matrices.M ? Matrix() : diagonal_like(matrices.K, 1);
  const PolynomialSolver pep =
      solver_of(matrices, matrices.M ? matrices.M : static_cast<Mat>(identity), most);
  check(PEPSolve(pep), of_damped);
  PetscInt found = 0;
  check(PEPGetConverged(pep, &found), of_damped);
  std::vector<Complex> values;
  Vector x, y;
  check(MatCreateVecs(matrices.K, x.out(), y.out()), of_damped);
  for (PetscInt i = 0; i < found && values.size() < most; ++i) {
    PetscScalar real = 0, imaginary = 0;
    check(PEPGetEigenpair(pep, i, &real, &imaginary, x, y), of_damped);
    if (imaginary < 0) continue;
    Complex lambda = refined(matrices, {real, imaginary}, x, y);
    if (imaginary == 0) lambda.imag(0);
    // An undamped motion must not grow by rounding.
    if (lambda.real() > 0 && lambda.real() <= 1e-9 * std::abs(lambda)) lambda.real(0);
    values.push_back(lambda);
  }
  if (values.empty())
    throw std::runtime_error(
        "the largest eigenvalues of damped motion did not converge; leave out --engine, or give --alpha and "
        "--beta in place of the damping matrix");
  std::ranges::sort(values, [](Complex p, Complex q) { return std::abs(p) > std::abs(q); });
  // Small problems are solved by every rank for itself, maybe by processors that round in other ways.
  MPI_Bcast(values.data(), static_cast<int>(values.size()), MPI_C_DOUBLE_COMPLEX, 0, world);
  std::vector<Complex> pairs;
  for (const Complex lambda : values) {
    pairs.push_back(lambda);
    if (lambda.imag() != 0) pairs.push_back(std::conj(lambda));
  }
  return pairs;
}

}  // namespace hmax::petsc
