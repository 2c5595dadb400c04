#include "addons/petsc/structure_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "addons/petsc/assembled_matrices.hpp"
#include "addons/petsc/damped_ends.hpp"
#include "addons/petsc/distributed_matrix.hpp"
#include "addons/petsc/structure_ends.hpp"
#include "addons/petsc/sum_inverse.hpp"
#include "problems/matrices/exchanged.hpp"

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

class Model final : public DistributedModel {
 public:
  /// @param M  null for I
  /// @param C  of general damping, else null
  /// @param is_positive  whether K is known to have no negative eigenvalue
  Model(Matrix K, Matrix M, Matrix C, StructureEnds ends, bool is_positive)
      : K_(std::move(K)), M_(std::move(M)), C_(std::move(C)), ends_(std::move(ends)) {
    const Vector shape = find_ends(K_, M_, is_positive, ends_);
    // Small eigenproblems are solved by every rank for itself, maybe by processors that round in other ways.
    std::array<double, 5> numbers{ends_.kappa_max, ends_.alpha, ends_.beta, ends_.negative.value_or(0),
                                  ends_.residual};
    MPI_Bcast(numbers.data(), numbers.size(), MPI_DOUBLE, 0, world);
    ends_.kappa_max = numbers[0], ends_.alpha = numbers[1], ends_.beta = numbers[2],
    ends_.residual = numbers[4];
    ends_.negative = numbers[3] < 0 ? std::optional(numbers[3]) : std::nullopt;
    check(MatCreateVecs(K_, x_.out(), out_.out()), of_products);
    noise_ = own_rows(fixed_vector(K_));
    shape_ = static_cast<Vec>(shape) ? own_rows(shape) : std::vector<double>(noise_.size(), 0.0);
    if (M_) {
      check(VecDuplicate(out_, product_.out()), of_products);
      solver_ = gradients_for(M_, 500);
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
    petsc::solve(solver_, product_, out_, "the mass is not divided by");
  }
  std::unique_ptr<StructureOperator::Inverse> inverse_of_sum(double a, double b) override {
    return petsc::inverse_of_sum(K_, M_, a, b);
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
  double largest(double own) override {
    // MPI_MAX may overlook NaN.
    double all = std::isfinite(own) ? own : std::numeric_limits<double>::infinity();
    MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_DOUBLE, MPI_MAX, world);
    return all;
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
      throw std::runtime_error(
          "the damping matrix has a negative eigenvalue: it excites motion, and --engine petsc takes "
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

/// What is read or assembled. M without an object, and masses, where it is diagonal.
struct Parts {
  Matrix K, M, C;
  Vector mass;
};

Parts read_files(const DistributedStructure& structure) {
  Parts parts;
  const auto matrix_of = [&](const std::string& name, bool is_mass = false) {
    return read_matrix(name, [&](const std::string& file) { return structure.read(file, is_mass); });
  };
  parts.K = matrix_of(structure.stiffness);
  require_symmetric(parts.K, structure.stiffness);
  store_diagonal(parts.K, structure.stiffness);
  parts.M = matrix_of(structure.mass, true);
  require_same_shape(parts.K, structure.stiffness, parts.M, structure.mass);
  parts.mass = lumped_mass(parts.M, structure.lumped, structure.mass);
  if (parts.mass)
    parts.M = Matrix();
  else
    require_symmetric(parts.M, structure.mass);
  if (structure.damping.empty()) return parts;
  parts.C = matrix_of(structure.damping);
  require_same_shape(parts.K, structure.stiffness, parts.C, structure.damping);
  require_symmetric(parts.C, structure.damping);
  return parts;
}

Parts assembled_parts(const StructurePieces& pieces) {
  Assembled matrices = assembled(pieces);
  return {.K = std::move(matrices.K), .M = {}, .C = std::move(matrices.C), .mass = std::move(matrices.mass)};
}

/// Takes C apart where it is a sum of M and K, and adds the damping of the options.
void take_damping(const DistributedStructure& structure, Parts& parts, StructureEnds& ends) {
  if (parts.C) {
    if (const auto rayleigh = rayleigh_of(parts.C, parts.K, parts.M, parts.mass, structure.damping)) {
      std::tie(ends.alpha, ends.beta) = *rayleigh;
      parts.C = Matrix();
    } else {
      ends.general_damping = true;
      return add_rayleigh(parts.C, structure.alpha, structure.beta, parts.K, parts.M, parts.mass);
    }
  }
  ends.alpha += structure.alpha;
  ends.beta += structure.beta;
}

}  // namespace

std::unique_ptr<DistributedModel> read_model(DistributedStructure structure) {
  const std::string what = "the matrices are not scaled";
  Parts parts = structure.pieces ? assembled_parts(*structure.pieces) : read_files(structure);
  const bool is_positive = structure.pieces.has_value();
  structure.pieces.reset();  // with its mesh
  StructureEnds ends;
  MatInfo info;
  check(MatGetInfo(parts.K, MAT_GLOBAL_SUM, &info), what);
  ends.entries = static_cast<std::int64_t>(info.nz_used);
  PetscInt rows = 0;
  check(MatGetSize(parts.K, &rows, nullptr), what);
  ends.unknowns = rows;
  ends.coupled_mass = !static_cast<Vec>(parts.mass);
  ends.look_exchanged = ends.coupled_mass && look_exchanged(parts.K, parts.M);
  take_damping(structure, parts, ends);
  if (parts.mass) {
    check(VecReciprocal(parts.mass), what);
    check(VecSqrtAbs(parts.mass), what);
    check(MatDiagonalScale(parts.K, parts.mass, parts.mass), what);
    if (parts.C) check(MatDiagonalScale(parts.C, parts.mass, parts.mass), what);
  }
  const bool exchanged = ends.look_exchanged;
  try {
    return std::make_unique<Model>(std::move(parts.K), std::move(parts.M), std::move(parts.C),
                                   std::move(ends), is_positive);
  } catch (const std::exception& error) {
    throw std::runtime_error(error.what() + (exchanged ? "; " + std::string(exchanged_matrices) : ""));
  }
}

}  // namespace hmax::petsc
