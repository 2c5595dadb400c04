/// The entries of a matrix, dense or sparse, one by one.
#pragma once

#include <variant>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// Calls visit(i, j, value) for every entry that is stored: of a dense matrix all of them, zeros as well.
template <class Visit>
void each_entry(const Eigen::MatrixXd& matrix, const Visit& visit) {
  for (Eigen::Index j = 0; j < matrix.cols(); ++j)
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) visit(i, j, matrix(i, j));
}
template <class Visit>
void each_entry(const Eigen::SparseMatrix<double>& matrix, const Visit& visit) {
  for (Eigen::Index j = 0; j < matrix.outerSize(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, j); entry; ++entry)
      visit(Eigen::Index{entry.row()}, j, entry.value());
}
template <class Visit>
void each_entry(const std::variant<Eigen::MatrixXd, Eigen::SparseMatrix<double>>& matrix,
                const Visit& visit) {
  std::visit([&](const auto& held) { each_entry(held, visit); }, matrix);
}

/// Whether any entry is not zero.
template <class Matrix>
bool has_entries(const Matrix& matrix) {
  bool found = false;
  each_entry(matrix, [&](Eigen::Index, Eigen::Index, double value) { found = found || value != 0; });
  return found;
}

}  // namespace hmax
