/// Products of a symmetric sparse matrix with many vectors.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// S A S of a symmetric sparse A and a diagonal S, stored for products: as blocks of 3 x 3 where A consists
/// of such, one index for nine numbers, else as it is.
class SymmetricProduct {
 public:
  /// Entries are s_i A_ij s_j, scaled once. The copy costs 12 bytes an entry as it is, about 8.5 in
  /// blocks.
  /// @param A      both triangles, shape (n, n)
  /// @param scale  the diagonal of S, shape (n)
  SymmetricProduct(const Eigen::SparseMatrix<double>& A, const Eigen::VectorXd& scale);

  [[nodiscard]] Eigen::Index rows() const { return n_; }
  /// Whether A is stored as blocks of 3 x 3, one index each: less memory traffic for a mesh of points with
  /// three coordinates.
  [[nodiscard]] bool has_blocks() const { return blocks_; }
  /// y = S A S x.
  /// x and y have shape (n) and must be different vectors.
  void operator()(const Eigen::VectorXd& x, Eigen::VectorXd& y) const { apply(x.data(), y.data()); }
  /// The same of numbers that stand anywhere.
  void apply(const double* x, double* y) const;

 private:
  /// Rows, or rows of blocks, from `begin` on.
  void apply_entries(const double* x, double* y, std::size_t begin, std::size_t end) const;
  void apply_blocks(const double* x, double* y, std::size_t begin, std::size_t end) const;

  Eigen::Index n_ = 0;
  bool blocks_ = false;
  // Compressed rows: row r has the entries first_[r] .. first_[r + 1] - 1. column_ is the first column of
  // a block; values_ holds its nine numbers row by row.
  std::vector<int> first_, column_;  ///< of each row, or row of blocks
  std::vector<double> values_;
};

}  // namespace hmax
