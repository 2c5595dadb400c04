#include "addons/petsc/assembled_matrices.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace hmax::petsc {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;
const std::string of_pieces = "the matrices of a body are not assembled";

/// Rows begin to end are those of this rank.
struct Range {
  std::int64_t begin = 0, end = 0;
};

Range own_range(const StructurePieces& pieces) {
  PetscInt own = PETSC_DECIDE, all = static_cast<PetscInt>(pieces.unknowns / pieces.together), until = 0;
  check(PetscSplitOwnership(world, &own, &all), of_pieces);
  MPI_Scan(&own, &until, 1, MPIU_INT, MPI_SUM, world);
  return {std::int64_t{pieces.together} * (until - own), std::int64_t{pieces.together} * until};
}

Matrix empty_matrix(const StructurePieces& pieces, Range own, const StructurePieces::Lengths& lengths) {
  Matrix matrix;
  const auto rows = static_cast<PetscInt>(own.end - own.begin), all = static_cast<PetscInt>(pieces.unknowns);
  check(MatCreate(world, matrix.out()), of_pieces);
  check(MatSetSizes(matrix, rows, rows, all, all), of_pieces);
  check(MatSetType(matrix, MATAIJ), of_pieces);
  const std::vector<PetscInt> inside(lengths.inside.begin(), lengths.inside.end()),
      outside(lengths.outside.begin(), lengths.outside.end());
  // One of them applies, on one rank the first.
  check(MatSeqAIJSetPreallocation(matrix, 0, inside.data()), of_pieces);
  check(MatMPIAIJSetPreallocation(matrix, 0, inside.data(), 0, outside.data()), of_pieces);
  check(MatSetOption(matrix, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE), of_pieces);
  check(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE), of_pieces);
  return matrix;
}

/// @param from  the row that the first of `rows` is
void put(Mat matrix, const MatrixRows& rows, std::int64_t from) {
  std::vector<PetscInt> columns;
  for (std::int64_t i = 0; i < rows.rows; ++i) {
    const auto first = rows.first[static_cast<std::size_t>(i)],
               last = rows.first[static_cast<std::size_t>(i) + 1];
    const auto row = static_cast<PetscInt>(from + i);
    columns.assign(rows.column.begin() + first, rows.column.begin() + last);
    check(MatSetValues(matrix, 1, &row, static_cast<PetscInt>(columns.size()), columns.data(),
                       rows.value.data() + first, INSERT_VALUES),
          of_pieces);
  }
}

void finish(Mat matrix) {
  check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY), of_pieces);
  check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY), of_pieces);
}

}  // namespace

Assembled assembled(const StructurePieces& pieces) {
  // So many that what touches a range from outside is little beside it, so few that a range is little beside
  // all.
  const std::int64_t at_a_time = std::int64_t{16'384} * pieces.together;
  const Range own = own_range(pieces);
  const StructurePieces::Lengths lengths =
      own.begin < own.end ? pieces.lengths(own.begin, own.end) : StructurePieces::Lengths{};
  Assembled matrices{.K = empty_matrix(pieces, own, lengths), .C = {}, .mass = {}};
  if (pieces.has_damping) matrices.C = empty_matrix(pieces, own, lengths);
  check(MatCreateVecs(matrices.K, matrices.mass.out(), nullptr), of_pieces);
  PetscScalar* mass = nullptr;
  check(VecGetArray(matrices.mass, &mass), of_pieces);
  for (std::int64_t begin = own.begin; begin < own.end; begin += at_a_time) {
    const StructurePieces::Rows rows = pieces.rows(begin, std::min(begin + at_a_time, own.end));
    put(matrices.K, rows.stiffness, begin);
    if (matrices.C) put(matrices.C, rows.damping, begin);
    std::ranges::copy(rows.mass, mass + (begin - own.begin));
  }
  check(VecRestoreArray(matrices.mass, &mass), of_pieces);
  finish(matrices.K);
  if (matrices.C) finish(matrices.C);
  return matrices;
}

}  // namespace hmax::petsc
