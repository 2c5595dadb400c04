/// A matrix as a file holds it.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// One entry as a file stores it; row and column count from 0.
using MatrixEntry = Eigen::Triplet<double>;

/// What the entries of a file stand for.
enum class Storage {
  general,    ///< all entries
  symmetric,  ///< one triangle of a symmetric matrix
  skew,       ///< one triangle of a skew-symmetric matrix
};

/// A matrix as a file holds it. Nothing in it is larger than the file.
struct MatrixFile {
  std::string name;    ///< of the file, as messages tell it
  std::string format;  ///< "Matrix Market", "PETSc binary", "CalculiX"
  Eigen::Index rows = 0, columns = 0;
  bool open_shape = false;  ///< the format has no shape: these are the largest indices
  Storage storage = Storage::general;
  std::vector<MatrixEntry> entries{};  ///< all finite, in the order of the file
};

/// Whether entries stand above the diagonal alone, or below it alone.
bool is_one_triangle(const MatrixFile& file);

/// The matrix, shape (rows, columns), both triangles. Entries of one place are added, as assembly of elements
/// does; the Matrix Market format does not forbid them.
/// @param repeated  receives how many entries stand at a place that an earlier one has; may be null
/// @throws std::invalid_argument  when an entry lies outside of the shape, or a sum is not finite
Eigen::SparseMatrix<double> assembled(const MatrixFile& file, Eigen::Index rows, Eigen::Index columns,
                                      std::size_t* repeated = nullptr);

/// One column of a file as a vector; zero where the file has no entry, shape (rows of the file).
Eigen::VectorXd column_of(const MatrixFile& file, Eigen::Index column);

}  // namespace hmax
