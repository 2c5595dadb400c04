#include "analysis/foreign_steps/step_pattern.hpp"

namespace hmax {

using Eigen::Index;

void StepPattern::take(const Eigen::SparseMatrix<double>& entries) {
  Eigen::SparseMatrix<double> diagonal(entries.rows(), entries.cols());
  diagonal.setIdentity();
  entries_ = entries + diagonal;
  // There are at least as many groups as entries in a row; to look at fuller ones costs more than it saves.
  const auto n = static_cast<double>(entries_.cols());
  pays_ = static_cast<double>(entries_.nonZeros()) < n * n / 2;
  if (!pays_) return;
  groups_ = ColumnGroups(entries_);
  pays_ = 2 * static_cast<Index>(groups().size()) <= entries_.cols();
}

void StepPattern::refuse(Index row) {
  pays_ = false;
  if (declared_) undeclared_ = {row, -1};
}

void StepPattern::learn(const Eigen::MatrixXd& J) {
  if (undeclared_ && undeclared_->second < 0) {
    Eigen::MatrixXd beyond = J.cwiseAbs();
    for (Index j = 0; j < entries_.cols(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(entries_, j); entry; ++entry)
        beyond(entry.row(), j) = 0;
    beyond.maxCoeff(&undeclared_->first, &undeclared_->second);
  }
  take(J.sparseView(1.0, 0.0));
}

}  // namespace hmax
