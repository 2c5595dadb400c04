#include "problems/matrices/matrix_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace hmax {

bool is_one_triangle(const MatrixFile& file) {
  bool above = false, below = false;
  for (const MatrixEntry& entry : file.entries) {
    above = above || (entry.row() < entry.col() && entry.value() != 0);
    below = below || (entry.row() > entry.col() && entry.value() != 0);
  }
  return above != below;
}

Eigen::SparseMatrix<double> assembled(const MatrixFile& file, Eigen::Index rows, Eigen::Index columns,
                                      std::size_t* repeated) {
  if (file.rows > rows || file.columns > columns)
    throw std::invalid_argument(file.name + ": the matrix has " + std::to_string(file.rows) + " rows and " +
                                std::to_string(file.columns) + " columns, more than " + std::to_string(rows) +
                                " and " + std::to_string(columns) + "; give matrices of one model");
  std::vector<MatrixEntry> entries = file.entries;
  if (file.storage != Storage::general) {
    const double sign = file.storage == Storage::skew ? -1 : 1;
    entries.reserve(2 * file.entries.size());
    for (const MatrixEntry& entry : file.entries)
      if (entry.row() != entry.col()) entries.emplace_back(entry.col(), entry.row(), sign * entry.value());
  }
  if (entries.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw std::invalid_argument(file.name + ": the matrix has " + std::to_string(entries.size()) +
                                " entries, more than 2^31; give a smaller model");
  Eigen::SparseMatrix<double> matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (repeated) {
    // Mirrored entries count once.
    std::size_t on_diagonal = 0;
    for (const MatrixEntry& entry : file.entries) on_diagonal += entry.row() == entry.col() ? 1 : 0;
    for (Eigen::Index j = 0; j < std::min(rows, columns); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, j); entry; ++entry)
        on_diagonal -= entry.row() == j ? 1 : 0;
    const std::size_t all = entries.size() - static_cast<std::size_t>(matrix.nonZeros());
    *repeated = file.storage == Storage::general ? all : (all - on_diagonal) / 2 + on_diagonal;
  }
  for (Eigen::Index k = 0; k < matrix.nonZeros(); ++k)
    if (!std::isfinite(matrix.valuePtr()[k]))
      throw std::invalid_argument(
          file.name + ": entries of one place add up beyond the range of double; export the matrix again");
  return matrix;
}

Eigen::VectorXd column_of(const MatrixFile& file, Eigen::Index column) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(file.rows);
  for (const MatrixEntry& entry : file.entries)
    if (entry.col() == column) values[entry.row()] += entry.value();
  return values;
}

}  // namespace hmax
