#include "addons/petsc/distributed_matrix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <vector>

namespace hmax::petsc {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

int rank() {
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  return rank;
}

int ranks() {
  int size = 1;
  MPI_Comm_size(world, &size);
  return size;
}

/// Throws the same on all ranks where rank 0 has something to say.
void agree_with_rank_0(std::string message) {
  auto length = static_cast<unsigned long>(message.size());
  MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG, 0, world);
  message.resize(length);
  MPI_Bcast(message.data(), static_cast<int>(length), MPI_CHAR, 0, world);
  if (length > 0) throw std::runtime_error(message);
}

/// Whether a file begins as a matrix of PETSc with indices of this build.
bool is_own_format(const std::string& file) {
  int answer = 0;
  if (rank() == 0) {
    std::array<unsigned char, sizeof(PetscInt)> bytes{};
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
    std::uint64_t id = 0;
    for (const unsigned char byte : bytes) id = 256 * id + byte;
    answer = stream && id == MAT_FILE_CLASSID ? 1 : 0;
  }
  MPI_Bcast(&answer, 1, MPI_INT, 0, world);
  return answer == 1;
}

Matrix loaded(const std::string& file) {
  Viewer viewer;
  const std::string what = file + " cannot be read";
  check(PetscViewerBinaryOpen(world, file.c_str(), FILE_MODE_READ, viewer.out()), what);
  Matrix matrix;
  check(MatCreate(world, matrix.out()), what);
  check(MatSetType(matrix, MATAIJ), what);
  check(MatLoad(matrix, viewer), what);
  return matrix;
}

/// The rows of one rank, in the integers of PETSc.
struct Block {
  std::vector<PetscInt> first, column;
  std::vector<double> value;
};

Block block_of(const MatrixRows& rows, std::int64_t begin, std::int64_t end) {
  Block block;
  const auto first = rows.first.begin() + begin, last = rows.first.begin() + end;
  for (auto at = first; at <= last; ++at) block.first.push_back(static_cast<PetscInt>(*at - *first));
  block.column.assign(rows.column.begin() + *first, rows.column.begin() + *last);
  block.value.assign(rows.value.begin() + *first, rows.value.begin() + *last);
  return block;
}

void send(const Block& block, int to) {
  const auto entries = static_cast<int>(block.value.size());
  MPI_Send(block.first.data(), static_cast<int>(block.first.size()), MPIU_INT, to, 0, world);
  MPI_Send(block.column.data(), entries, MPIU_INT, to, 1, world);
  MPI_Send(block.value.data(), entries, MPI_DOUBLE, to, 2, world);
}

Block received(std::int64_t rows) {
  Block block;
  block.first.resize(static_cast<std::size_t>(rows + 1));
  MPI_Recv(block.first.data(), static_cast<int>(rows + 1), MPIU_INT, 0, 0, world, MPI_STATUS_IGNORE);
  const PetscInt entries = block.first.back();
  block.column.resize(static_cast<std::size_t>(entries));
  block.value.resize(static_cast<std::size_t>(entries));
  MPI_Recv(block.column.data(), static_cast<int>(entries), MPIU_INT, 0, 1, world, MPI_STATUS_IGNORE);
  MPI_Recv(block.value.data(), static_cast<int>(entries), MPI_DOUBLE, 0, 2, world, MPI_STATUS_IGNORE);
  return block;
}

Matrix dealt_out(const std::string& file, const ReadRows& read) {
  MatrixRows rows;
  std::string message;
  if (rank() == 0) try {
      rows = read(file);
      if (rows.first.back() > std::numeric_limits<int>::max())
        message =
            file +
            " has more than 2^31 entries, which rank 0 cannot deal out; write it in the binary format of PETSc";
    } catch (const std::exception& error) {
      message = error.what();
    }
  agree_with_rank_0(message);
  std::array<std::int64_t, 2> shape{rows.rows, rows.columns};
  MPI_Bcast(shape.data(), 2, MPI_INT64_T, 0, world);
  // Blocks as PetscSplitOwnership makes them, which MatLoad takes as well.
  const auto begin_of = [&](int of) {
    return of * (shape[0] / ranks()) + std::min<std::int64_t>(of, shape[0] % ranks());
  };
  const std::int64_t own = begin_of(rank() + 1) - begin_of(rank());
  if (rank() == 0)
    for (int to = 1; to < ranks(); ++to) send(block_of(rows, begin_of(to), begin_of(to + 1)), to);
  const Block block = rank() == 0 ? block_of(rows, 0, own) : received(own);
  rows = {};
  Matrix matrix;
  const std::string what = file + " cannot be dealt out";
  check(MatCreate(world, matrix.out()), what);
  check(MatSetSizes(matrix, static_cast<PetscInt>(own), PETSC_DECIDE, static_cast<PetscInt>(shape[0]),
                    static_cast<PetscInt>(shape[1])),
        what);
  check(MatSetType(matrix, MATAIJ), what);
  // One of them applies, on one rank the first.
  check(MatSeqAIJSetPreallocationCSR(matrix, block.first.data(), block.column.data(), block.value.data()),
        what);
  check(MatMPIAIJSetPreallocationCSR(matrix, block.first.data(), block.column.data(), block.value.data()),
        what);
  return matrix;
}

}  // namespace

Matrix read_matrix(const std::string& file, const ReadRows& read) {
  Matrix matrix = is_own_format(file) ? loaded(file) : dealt_out(file, read);
  PetscInt rows = 0, columns = 0;
  check(MatGetSize(matrix, &rows, &columns), file);
  if (rows != columns || rows == 0)
    throw std::runtime_error(file + " has the shape " + std::to_string(rows) + " x " +
                             std::to_string(columns) +
                             ", and a matrix of a structure is square; give another file");
  PetscReal size = 0;
  check(MatNorm(matrix, NORM_INFINITY, &size), file);
  if (!std::isfinite(size))
    throw std::runtime_error(file + " holds a value that is not finite; export the matrix again");
  return matrix;
}

Matrix diagonal_like(Mat A, double value) {
  const std::string what = "a diagonal matrix is not made";
  Matrix diagonal;
  PetscInt rows = 0;
  check(MatGetLocalSize(A, &rows, nullptr), what);
  check(MatCreateAIJ(world, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE, 1, nullptr, 0, nullptr,
                     diagonal.out()),
        what);
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(diagonal, &begin, &end), what);
  for (PetscInt i = begin; i < end; ++i) check(MatSetValue(diagonal, i, i, value, INSERT_VALUES), what);
  check(MatAssemblyBegin(diagonal, MAT_FINAL_ASSEMBLY), what);
  check(MatAssemblyEnd(diagonal, MAT_FINAL_ASSEMBLY), what);
  return diagonal;
}

void store_diagonal(Mat A, const std::string& file) {
  PetscBool here = PETSC_FALSE, anywhere = PETSC_FALSE;
  PetscInt rows = 0;
  check(MatGetLocalSize(A, &rows, nullptr), file);
  if (rows > 0) check(MatMissingDiagonal(A, &here, nullptr), file);
  MPI_Allreduce(&here, &anywhere, 1, MPIU_BOOL, MPI_LOR, world);
  if (anywhere) check(MatAXPY(A, 1, diagonal_like(A, 0), DIFFERENT_NONZERO_PATTERN), file);
}

bool look_exchanged(Mat K, Mat M) {
  const std::string what = "rows are not looked at";
  Vector least, sums, sizes;
  check(MatCreateVecs(K, nullptr, least.out()), what);
  check(MatGetRowMin(K, least, nullptr), what);
  PetscReal of_all = 0;
  check(VecMin(least, nullptr, &of_all), what);
  if (of_all < 0) return false;
  check(VecDuplicate(least, sums.out()), what);
  check(VecDuplicate(least, sizes.out()), what);
  check(MatGetRowSum(M, sums), what);
  check(MatGetRowMaxAbs(M, sizes, nullptr), what);
  PetscInt own = 0, all = 0;
  const PetscScalar *sum = nullptr, *size = nullptr;
  check(VecGetLocalSize(sums, &own), what);
  check(VecGetSize(sums, &all), what);
  check(VecGetArrayRead(sums, &sum), what);
  check(VecGetArrayRead(sizes, &size), what);
  PetscInt zero = 0;
  for (PetscInt i = 0; i < own; ++i) zero += size[i] > 0 && std::abs(sum[i]) <= 1e-9 * size[i] ? 1 : 0;
  check(VecRestoreArrayRead(sums, &sum), what);
  check(VecRestoreArrayRead(sizes, &size), what);
  MPI_Allreduce(MPI_IN_PLACE, &zero, 1, MPIU_INT, MPI_SUM, world);
  return 2 * zero > all;
}

void require_same_shape(Mat A, const std::string& file, Mat B, const std::string& other) {
  PetscInt rows = 0, of_other = 0;
  check(MatGetSize(A, &rows, nullptr), file);
  check(MatGetSize(B, &of_other, nullptr), other);
  if (rows != of_other)
    throw std::runtime_error(other + " has " + std::to_string(of_other) + " rows and " + file + " has " +
                             std::to_string(rows) + "; give matrices of one model");
}

Vector lumped_mass(Mat M, bool lumped, const std::string& file) {
  Vector mass, diagonal;
  check(MatCreateVecs(M, mass.out(), diagonal.out()), file);
  check(MatGetDiagonal(M, diagonal), file);
  const auto require_positive = [&](Vec v, const char* what) {
    PetscReal smallest = 0;
    PetscInt at = 0;
    check(VecMin(v, &at, &smallest), file);
    if (!(smallest > 0))
      throw std::runtime_error(
          file + ": the " + what + " of row " + std::to_string(at + 1) +
          " is not positive; --engine petsc takes no unknowns without mass and no constraint rows, "
          "leave out --engine");
  };
  if (lumped) {
    check(MatGetRowSum(M, mass), file);
    require_positive(mass, "sum");
    return mass;
  }
  require_positive(diagonal, "mass");
  // Diagonal where the squares of the diagonal are all squares there are.
  PetscReal all = 0, of_diagonal = 0;
  check(MatNorm(M, NORM_FROBENIUS, &all), file);
  check(VecNorm(diagonal, NORM_2, &of_diagonal), file);
  PetscInt own = 0;
  check(MatGetLocalSize(M, &own, nullptr), file);
  MatInfo info;
  check(MatGetInfo(M, MAT_GLOBAL_SUM, &info), file);
  PetscInt rows = 0;
  check(MatGetSize(M, &rows, nullptr), file);
  if (info.nz_used <= static_cast<double>(rows) && all <= of_diagonal * (1 + 1e-14)) return diagonal;
  return {};
}

void require_symmetric(Mat A, const std::string& file) {
  Vector largest;
  check(MatCreateVecs(A, nullptr, largest.out()), file);
  check(MatGetRowMaxAbs(A, largest, nullptr), file);
  // a_ij / sqrt(r_i r_j), as of core/symmetry.hpp
  check(VecSqrtAbs(largest), file);
  check(VecReciprocal(largest), file);
  Matrix scaled;
  check(MatDuplicate(A, MAT_COPY_VALUES, scaled.out()), file);
  check(MatDiagonalScale(scaled, largest, largest), file);
  PetscBool symmetric = PETSC_FALSE;
  check(MatIsSymmetric(scaled, 1e-9, &symmetric), file);
  if (!symmetric)
    throw std::runtime_error(
        file + " is not symmetric, and --engine petsc takes symmetric matrices; leave out --engine");
  check(MatSetOption(A, MAT_SYMMETRIC, PETSC_TRUE), file);
}

}  // namespace hmax::petsc
