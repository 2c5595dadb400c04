/// Matrices of files with their rows dealt out in blocks of about one size.
#pragma once

#include <functional>
#include <string>

#include "addons/petsc/petsc_calls.hpp"
#include "limits/distributed/distributed_engine.hpp"

namespace hmax::petsc {

/// Reads a file on rank 0.
using ReadRows = std::function<MatrixRows(const std::string& file)>;

/// Reads a matrix; collective. PETSc's own files with indices as wide as its own are read by all ranks, each
/// its rows; all other files by rank 0, which sends the others theirs.
/// @throws std::runtime_error  for files that cannot be read and matrices that are not square
Matrix read_matrix(const std::string& file, const ReadRows& read);

/// The masses where M is diagonal, or `lumped` asks for the sums of its rows; no object where M couples
/// unknowns.
/// @throws std::runtime_error  for a diagonal or a sum that is not positive
Vector lumped_mass(Mat M, bool lumped, const std::string& file);

/// @throws std::runtime_error  unless A and its transpose agree to 1e-9 of the largest entries of their rows
void require_symmetric(Mat A, const std::string& file);

/// A diagonal matrix of one number, which is stored even where it is 0, with the rows of A.
Matrix diagonal_like(Mat A, double value);

/// Stores a diagonal entry in every row of A, which preconditioners ask for.
void store_diagonal(Mat A, const std::string& file);

/// Whether no entry of K is negative, and most rows of M sum to zero, as those of a stiffness do where a
/// translation makes no force.
bool look_exchanged(Mat K, Mat M);

/// @throws std::runtime_error  unless both have one shape
void require_same_shape(Mat A, const std::string& file, Mat B, const std::string& other);

}  // namespace hmax::petsc
