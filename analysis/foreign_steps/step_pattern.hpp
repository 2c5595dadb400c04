/// Which coordinates a step of an engine couples.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include "integrators/implicit/jacobian.hpp"

namespace hmax {

/// Where the derivative of a step can be nonzero, and its columns in groups without a common row: one
/// difference gives all columns of a group [curtis1974estimation]. Declared by the engine, or learned from a
/// matrix. Nobody takes it on trust: what a matrix of it makes of a random direction is compared with a
/// difference.
class StepPattern {
 public:
  /// Not known yet.
  StepPattern() = default;
  /// As declared. @param entries  shape (n, n); the diagonal belongs to it; values do not matter
  explicit StepPattern(const Eigen::SparseMatrix<double>& entries) : declared_(true) { take(entries); }

  /// Whether groups save steps: there are at most half as many as columns.
  [[nodiscard]] bool pays() const { return pays_; }
  [[nodiscard]] const Eigen::SparseMatrix<double>& entries() const { return entries_; }
  [[nodiscard]] const std::vector<std::vector<Eigen::Index>>& groups() const { return groups_.members(); }

  /// The derivative has more entries, such as in this row: differences are taken column by column from now
  /// on.
  void refuse(Eigen::Index row);
  /// Takes the nonzero entries of a matrix: engines leave what a number does not act on as it is, to the last
  /// bit.
  void learn(const Eigen::MatrixXd& J);
  /// An entry that was not declared, row and column; the column is -1 where it is not known.
  [[nodiscard]] const std::optional<std::pair<Eigen::Index, Eigen::Index>>& undeclared() const {
    return undeclared_;
  }

 private:
  void take(const Eigen::SparseMatrix<double>& entries);

  Eigen::SparseMatrix<double> entries_;
  ColumnGroups groups_;
  std::optional<std::pair<Eigen::Index, Eigen::Index>> undeclared_;
  bool pays_ = false, declared_ = false;
};

}  // namespace hmax
