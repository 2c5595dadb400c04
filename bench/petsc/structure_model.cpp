#include "bench/petsc/structure_model.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/petsc/damped_ends.hpp"
#include "bench/petsc/distributed_matrix.hpp"
#include "bench/petsc/structure_ends.hpp"

namespace hmax::petsc {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;
const std::string of_products = "a product with a matrix fails";

/// The rows of a vector that this rank has.
std::vector<double> own_rows(Vec vector) {
  PetscInt count = 0;
  const PetscScalar* values = nullptr;
  check(VecGetLocalSize(vector, &count), of_products);
  check(VecGetArrayRead(vector, &values), of_products);
  std::vector<double> rows(values, values + count);
  check(VecRestoreArrayRead(vector, &values), of_products);
  return rows;
}

/// A vector of PETSc over memory of somebody else.
class Placed {
 public:
  Placed(Vec vector, const double* values) : vector_(vector) { check(VecPlaceArray(vector, values), of_products); }
  ~Placed() { static_cast<void>(VecResetArray(vector_)); }
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;

 private:
  Vec vector_;
};

LinearSolver mass_solver(Mat M) {
  const std::string what = "the mass is not divided by";
  LinearSolver solver;
  check(KSPCreate(world, solver.out()), what);
  check(KSPSetOperators(solver, M, M), what);
  check(KSPSetType(solver, KSPCG), what);
  PC diagonal = nullptr;
  check(KSPGetPC(solver, &diagonal), what);
  check(PCSetType(diagonal, PCJACOBI), what);
  check(KSPSetTolerances(solver, 1e-14, 0, PETSC_DEFAULT, 500), what);
  check(KSPSetNormType(solver, KSP_NORM_NATURAL), what);
  check(KSPSetUp(solver), what);
  return solver;
}

class Model final : public DistributedModel {
 public:
  /// @param M  null for I
  /// @param C  of general damping, else null
  Model(Matrix K, Matrix M, Matrix C, StructureEnds ends)
      : K_(std::move(K)), M_(std::move(M)), C_(std::move(C)), ends_(std::move(ends)) {
    const Vector shape = find_ends(K_, M_, ends_);
    // Small eigenproblems are solved by every rank for itself, maybe by processors that round in other ways.
    std::array<double, 5> numbers{ends_.kappa_max, ends_.alpha, ends_.beta, ends_.negative.value_or(0), ends_.residual};
    MPI_Bcast(numbers.data(), numbers.size(), MPI_DOUBLE, 0, world);
    ends_.kappa_max = numbers[0], ends_.alpha = numbers[1], ends_.beta = numbers[2], ends_.residual = numbers[4];
    ends_.negative = numbers[3] < 0 ? std::optional(numbers[3]) : std::nullopt;
    check(MatCreateVecs(K_, x_.out(), out_.out()), of_products);
    noise_ = own_rows(fixed_vector(K_));
    shape_ = static_cast<Vec>(shape) ? own_rows(shape) : std::vector<double>(noise_.size(), 0.0);
    if (M_) {
      check(VecDuplicate(out_, product_.out()), of_products);
      solver_ = mass_solver(M_);
    }
    if (C_) find_most_damping();
  }

  [[nodiscard]] const StructureEnds& ends() const override { return ends_; }
  [[nodiscard]] std::size_t rows() const override { return noise_.size(); }
  [[nodiscard]] std::span<const double> fastest_shape() const override { return shape_; }
  [[nodiscard]] std::span<const double> noise() const override { return noise_; }

  void stiffness_times(const double* x, double* out) override { multiply(K_, x, out); }
  void mass_times(const double* x, double* out) override {
    if (M_)
      multiply(M_, x, out);
    else
      std::copy_n(x, rows(), out);
  }
  void reduced_stiffness_times(const double* x, double* out) override {
    if (!M_) return multiply(K_, x, out);
    const Placed in(x_, x), result(out_, out);
    check(MatMult(K_, x_, product_), of_products);
    check(KSPSolve(solver_, product_, out_), of_products);
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    check(KSPGetConvergedReason(solver_, &reason), of_products);
    // A run beyond its limit may come to what is not finite, which it then has to show.
    if (reason == KSP_DIVERGED_ITS || reason == KSP_DIVERGED_INDEFINITE_MAT)
      throw std::runtime_error("the mass is not divided by: conjugate gradients do not converge; see whether the mass matrix "
                               "is positive definite, or lump it");
  }
  SumEnd largest_of_sum(double a, double b, double tolerance) override {
    const double size = std::abs(a) * ends_.gamma_max + std::abs(b) * ends_.kappa_max;
    return shared(petsc::largest_of_sum(damped(), a, b, tolerance * size));
  }
  std::vector<std::complex<double>> largest_damped(std::size_t most) override {
    return petsc::largest_damped(damped(), most);
  }
  void add_up(std::span<double> numbers) override {
    MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_DOUBLE, MPI_SUM, world);
  }
  Going together(Going going) override {
    int least = static_cast<int>(going);
    MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT, MPI_MIN, world);
    return static_cast<Going>(least);
  }

 private:
  [[nodiscard]] Damped damped() const { return {.K = K_, .C = C_, .M = M_, .divide_by_M = solver_}; }
  /// What rank 0 has, on all ranks.
  static SumEnd shared(SumEnd end) {
    MPI_Bcast(&end, sizeof(end), MPI_BYTE, 0, world);
    return end;
  }
  /// @throws std::runtime_error  where damping excites
  void find_most_damping() {
    PetscReal size = 0;
    check(MatNorm(C_, NORM_INFINITY, &size), of_products);
    // Its sign does not depend on M.
    if (negative_end(C_, nullptr, ends_.unknowns, size))
      throw std::runtime_error("the damping matrix has a negative eigenvalue: it excites motion, and --engine petsc takes "
                               "damping that does not; leave out --engine");
    if (M_) {
      // No row of M is less than its diagonal, as far as a bound of the size needs to know.
      Vector diagonal;
      check(VecDuplicate(out_, diagonal.out()), of_products);
      check(MatGetDiagonal(M_, diagonal), of_products);
      PetscReal least = 0;
      check(VecMin(diagonal, nullptr, &least), of_products);
      size /= least;
    }
    const SumEnd most = shared(petsc::largest_of_sum(damped(), 1, 0, 1e-6 * size));
    if (!most.converged) throw std::runtime_error("the largest damping did not converge; leave out --engine");
    ends_.gamma_max = most.value + most.residual;
  }
  void multiply(Mat A, const double* x, double* out) {
    const Placed in(x_, x), result(out_, out);
    check(MatMult(A, x_, out_), of_products);
  }

  Matrix K_, M_, C_;
  StructureEnds ends_;
  std::vector<double> shape_, noise_;
  Vector x_, out_, product_;
  LinearSolver solver_;
};

}  // namespace

std::unique_ptr<DistributedModel> read_model(const DistributedStructure& structure) {
  StructureEnds ends;
  const auto matrix_of = [&](const std::string& name, bool is_mass = false) {
    return read_matrix(name, [&](const std::string& file) { return structure.read(file, is_mass); });
  };
  Matrix K = matrix_of(structure.stiffness);
  require_symmetric(K, structure.stiffness);
  MatInfo info;
  check(MatGetInfo(K, MAT_GLOBAL_SUM, &info), structure.stiffness);
  ends.entries = static_cast<std::int64_t>(info.nz_used);
  Matrix M = matrix_of(structure.mass, true);
  require_same_shape(K, structure.stiffness, M, structure.mass);
  Vector mass = lumped_mass(M, structure.lumped, structure.mass);
  ends.coupled_mass = !static_cast<Vec>(mass);
  if (ends.coupled_mass) require_symmetric(M, structure.mass);
  PetscInt rows = 0;
  check(MatGetSize(K, &rows, nullptr), structure.stiffness);
  ends.unknowns = rows;
  Matrix C;
  if (!structure.damping.empty()) {
    C = matrix_of(structure.damping);
    require_same_shape(K, structure.stiffness, C, structure.damping);
    require_symmetric(C, structure.damping);
    if (const auto rayleigh = rayleigh_of(C, K, M, mass, structure.damping)) {
      std::tie(ends.alpha, ends.beta) = *rayleigh;
      C = Matrix();
    } else {
      ends.general_damping = true;
    }
  }
  if (ends.general_damping) {
    add_rayleigh(C, structure.alpha, structure.beta, K, M, mass);
  } else {
    ends.alpha += structure.alpha;
    ends.beta += structure.beta;
  }
  if (!ends.coupled_mass) {
    M = Matrix();
    check(VecReciprocal(mass), structure.mass);
    check(VecSqrtAbs(mass), structure.mass);
    check(MatDiagonalScale(K, mass, mass), structure.stiffness);
    if (C) check(MatDiagonalScale(C, mass, mass), structure.damping);
  }
  return std::make_unique<Model>(std::move(K), std::move(M), std::move(C), std::move(ends));
}

}  // namespace hmax::petsc
