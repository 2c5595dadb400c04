/// Matrices from files: Matrix Market, PETSc binary, CalculiX.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "problems/matrices/matrix_file.hpp"

namespace hmax {

/// Reads a matrix. The format follows from the first bytes, and from the extension where these do not tell.
/// Numbers may have the exponents of Fortran, 1.0D+00.
/// @throws std::invalid_argument  one sentence with file, line or byte, and what to do
MatrixFile read_matrix(const std::filesystem::path& file);

/// The same of the bytes of a file.
/// @param name  of the file, with the extension
MatrixFile matrix_from(const std::string& name, std::string_view bytes);

/// A matrix of a series.
struct SeriesEntry {
  double t = 0;  ///< [s]
  std::filesystem::path file;
};

/// A series: a line "time file" for each matrix, times rising, files relative to this one; # begins a
/// comment.
/// @throws std::invalid_argument  also where there are fewer than two
std::vector<SeriesEntry> read_series(const std::filesystem::path& file);

/// Names of the unknowns, as CalculiX has them: "12.3" for direction 3 of node 12, one a line of a .dof file;
/// # begins a comment.
std::vector<std::string> read_unknown_names(const std::filesystem::path& file);

}  // namespace hmax
