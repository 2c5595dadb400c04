#include "addons/petsc/structure_ends.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace hmax::petsc {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;
const std::string of_eigenvalues = "the largest eigenvalue is not found";

/// alpha and beta of c = alpha m + beta k, products of the matrices with one vector: least squares, refined,
/// since what the mass adds to the damping may be small.
std::pair<double, double> fitted(Vec c, Vec k, Vec m, const std::string& what) {
  PetscReal of_k = 0, of_m = 0;
  check(VecNorm(k, NORM_2, &of_k), what);
  check(VecNorm(m, NORM_2, &of_m), what);
  if (of_k == 0) of_k = 1;
  PetscScalar km = 0;
  check(VecDot(k, m, &km), what);
  km /= of_k * of_m;
  const double determinant = 1 - km * km;
  const bool apart = determinant > 1e-12;
  double alpha = 0, beta = 0;
  Vector rest;
  check(VecDuplicate(c, rest.out()), what);
  for (int round = 0; round < 6; ++round) {
    check(VecCopy(c, rest), what);
    check(VecAXPY(rest, -alpha, m), what);
    check(VecAXPY(rest, -beta, k), what);
    PetscScalar along_k = 0, along_m = 0;
    check(VecDot(rest, k, &along_k), what);
    check(VecDot(rest, m, &along_m), what);
    along_k /= of_k;
    along_m /= of_m;
    if (apart) beta += (along_k - km * along_m) / determinant / of_k;
    alpha += (apart ? (along_m - km * along_k) / determinant : along_m) / of_m;
  }
  return {alpha, beta};
}

}  // namespace

Vector fixed_vector(Mat K) {
  const std::string what = "a vector is not made";
  Vector vector;
  check(MatCreateVecs(K, vector.out(), nullptr), what);
  PetscInt begin = 0, end = 0;
  check(VecGetOwnershipRange(vector, &begin, &end), what);
  PetscScalar* values = nullptr;
  check(VecGetArray(vector, &values), what);
  for (PetscInt i = begin; i < end; ++i) {
    // Vigna's splitmix64 of the row.
    std::uint64_t z = (static_cast<std::uint64_t>(i) + 1) * 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    values[i - begin] = static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53 - 0.5;
  }
  check(VecRestoreArray(vector, &values), what);
  return vector;
}

void add_rayleigh(Mat C, double alpha, double beta, Mat K, Mat M, Vec lumped) {
  const std::string what = "damping is not added";
  if (beta != 0) check(MatAXPY(C, beta, K, DIFFERENT_NONZERO_PATTERN), what);
  if (alpha == 0) return;
  if (!lumped) return check(MatAXPY(C, alpha, M, DIFFERENT_NONZERO_PATTERN), what);
  Vector diagonal;
  check(VecDuplicate(lumped, diagonal.out()), what);
  check(VecCopy(lumped, diagonal), what);
  check(VecScale(diagonal, alpha), what);
  check(MatDiagonalSet(C, diagonal, ADD_VALUES), what);
}

std::optional<std::pair<double, double>> rayleigh_of(Mat C, Mat K, Mat M, Vec lumped,
                                                     const std::string& file) {
  Vector c, k, m;
  check(MatCreateVecs(K, c.out(), k.out()), file);
  check(VecDuplicate(k, m.out()), file);
  const Vector x = fixed_vector(K);
  check(MatMult(C, x, c), file);
  check(MatMult(K, x, k), file);
  check(lumped ? VecPointwiseMult(m, lumped, x) : MatMult(M, x, m), file);
  const auto [alpha, beta] = fitted(c, k, m, file);
  PetscReal size = 0, rest = 0;
  check(MatNorm(C, NORM_FROBENIUS, &size), file);
  add_rayleigh(C, -alpha, -beta, K, M, lumped);
  check(MatNorm(C, NORM_FROBENIUS, &rest), file);
  if (rest <= 1e-10 * size) return std::pair(alpha, beta);
  add_rayleigh(C, alpha, beta, K, M, lumped);
  return std::nullopt;
}

Solver solver_for(Mat K, Mat M, EPSWhich which, PetscReal tolerance) {
  Solver eps;
  check(EPSCreate(world, eps.out()), of_eigenvalues);
  check(EPSSetOperators(eps, K, M), of_eigenvalues);
  check(EPSSetProblemType(eps, M ? EPS_GHEP : EPS_HEP), of_eigenvalues);
  check(EPSSetWhichEigenpairs(eps, which), of_eigenvalues);
  check(EPSSetTolerances(eps, tolerance, 10'000), of_eigenvalues);
  check(EPSSetConvergenceTest(eps, EPS_CONV_REL), of_eigenvalues);
  check(EPSSetType(eps, M ? EPSGD : EPSKRYLOVSCHUR), of_eigenvalues);
  const Vector start = fixed_vector(K);
  Vec space = start;
  check(EPSSetInitialSpace(eps, 1, &space), of_eigenvalues);
  return eps;
}

void normalise(Vec u, Mat M) {
  if (!M) return check(VecNormalize(u, nullptr), of_eigenvalues);
  Vector product;
  check(VecDuplicate(u, product.out()), of_eigenvalues);
  check(MatMult(M, u, product), of_eigenvalues);
  PetscScalar square = 0;
  check(VecDot(u, product, &square), of_eigenvalues);
  check(VecScale(u, 1 / std::sqrt(square)), of_eigenvalues);
}

namespace {

Vector find_largest(Mat K, Mat M, StructureEnds& ends) {
  PetscReal size = 0;
  check(MatNorm(K, NORM_INFINITY, &size), of_eigenvalues);
  if (size == 0) return {};
  const Solver eps = solver_for(K, M, EPS_LARGEST_REAL, 1e-10);
  const auto most = static_cast<PetscInt>(std::min<std::int64_t>(ends.unknowns, 40));
  check(EPSSetDimensions(eps, 1, most, PETSC_DEFAULT), of_eigenvalues);
  check(EPSSetOptionsPrefix(eps, "hmax_"), of_eigenvalues);
  check(EPSSetFromOptions(eps), of_eigenvalues);
  check(EPSSolve(eps), of_eigenvalues);
  PetscInt found = 0, iterations = 0;
  check(EPSGetConverged(eps, &found), of_eigenvalues);
  check(EPSGetIterationNumber(eps, &iterations), of_eigenvalues);
  if (found == 0)
    throw std::runtime_error("the largest eigenvalue of " + std::to_string(ends.unknowns) +
                             " unknowns did not converge in " + std::to_string(iterations) +
                             " restarts; leave out --engine");
  PetscScalar kappa = 0;
  Vector shape;
  check(MatCreateVecs(K, shape.out(), nullptr), of_eigenvalues);
  check(EPSGetEigenpair(eps, 0, &kappa, nullptr, shape, nullptr), of_eigenvalues);
  normalise(shape, M);
  check(EPSComputeError(eps, 0, EPS_ERROR_RELATIVE, &ends.residual), of_eigenvalues);
  EPSType type = nullptr;
  check(EPSGetType(eps, &type), of_eigenvalues);
  ends.kappa_max = kappa;
  ends.iterations = static_cast<int>(iterations);
  ends.solver = type;
  return shape;
}

/// The least Ritz value so far.
PetscErrorCode keep_least(EPS /*eps*/, PetscInt /*iterations*/, PetscInt converged, PetscScalar* values,
                          PetscScalar* /*imaginary*/, PetscReal* /*errors*/, PetscInt count, void* context) {
  auto& least = *static_cast<double*>(context);
  for (PetscInt i = 0; i < std::min(count, converged + 1); ++i) least = std::min(least, values[i]);
  return 0;
}

}  // namespace

std::optional<double> negative_end(Mat K, Mat M, std::int64_t unknowns, double kappa_max) {
  const std::string what = "the least eigenvalue is not found";
  const Solver eps = solver_for(K, M, EPS_SMALLEST_REAL, 1e-8);
  check(EPSSetDimensions(eps, 1, static_cast<PetscInt>(std::min<std::int64_t>(unknowns, 40)), PETSC_DEFAULT),
        what);
  const bool is_only_end = !(kappa_max > 0);  // then it is the rate of growth
  check(EPSSetTolerances(eps, 1e-8, is_only_end ? 300 : M ? 60 : 4), what);
  double least = std::numeric_limits<double>::infinity();
  check(EPSMonitorSet(eps, keep_least, &least, nullptr), what);
  const PetscErrorCode end = EPSSolve(eps);
  // PETSC_ERR_USER_INPUT: a vector u with u^T M u < 0. Where the search spans all unknowns, rounding leaves
  // such a rest; the Ritz values seen before are eigenvalues then.
  if (end != PETSC_ERR_USER_INPUT || !std::isfinite(least)) check(end, what);
  if (least < -1e-8 * std::max(kappa_max, 0.0)) return least;
  return std::nullopt;
}

Vector find_ends(Mat K, Mat M, bool is_positive, StructureEnds& ends) {
  Vector shape = find_largest(K, M, ends);
  if (!is_positive && shape) ends.negative = negative_end(K, M, ends.unknowns, ends.kappa_max);
  return shape;
}

}  // namespace hmax::petsc
