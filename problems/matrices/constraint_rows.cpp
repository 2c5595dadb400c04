#include "problems/matrices/constraint_rows.hpp"

#include <algorithm>
#include <cmath>

#include "problems/matrix_entries.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

/// sum_{j != i} |A_ij| s_j for each row i, without the columns that are marked.
VectorXd sums_beside_diagonal(const Sparse& A, const VectorXd& scale, const std::vector<char>& left_out) {
  VectorXd sums = VectorXd::Zero(A.rows());
  each_entry(A, [&](Eigen::Index i, Eigen::Index j, double value) {
    if (i != j && !left_out[static_cast<std::size_t>(j)]) sums[i] += std::abs(value) * scale[j];
  });
  return sums;
}

}  // namespace

ConstraintRows constraint_rows(const Sparse& K, const Sparse& C, const Sparse& M) {
  const Eigen::Index n = K.rows();
  const VectorXd ones = VectorXd::Ones(n), mass = M.diagonal(), stiffness = K.diagonal();
  std::vector<char> held(static_cast<std::size_t>(n), 0);
  const VectorXd beside = sums_beside_diagonal(K, ones, held);
  const VectorXd coupling =
      beside + sums_beside_diagonal(C, ones, held) + sums_beside_diagonal(M, ones, held);
  // 1 / sqrt(m_j); where there is no mass the unknown follows the others.
  const VectorXd scale = mass.unaryExpr([](double m) { return m > 0 ? 1 / std::sqrt(m) : 0.0; });
  const VectorXd scaled_beside = sums_beside_diagonal(K, scale, held);

  ConstraintRows found;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (coupling[i] == 0 && stiffness[i] != 0) found.decoupled.push_back(i);
    // k_ii = K_ii / m_i against sum |K_ij| / sqrt(m_i m_j).
    else if (beside[i] > 0 && stiffness[i] >= penalty_ratio * beside[i] &&
             stiffness[i] * scale[i] >= penalty_ratio * scaled_beside[i])
      found.penalties.push_back(i);
    else
      continue;
    held[static_cast<std::size_t>(i)] = 1;
  }
  // Springs of their own are no constraints of anything.
  if (static_cast<Eigen::Index>(found.decoupled.size()) == n) {
    found.decoupled.clear();
    std::ranges::fill(held, 0);
  }

  for (const auto* rows : {&found.decoupled, &found.penalties})
    for (const Eigen::Index i : *rows)
      if (mass[i] > 0) found.fastest = std::max(found.fastest, std::sqrt(std::abs(stiffness[i]) / mass[i]));
  const VectorXd others = sums_beside_diagonal(K, ones, held);
  double most = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    if (!held[static_cast<std::size_t>(i)] && mass[i] > 0)
      most = std::max(most, (std::abs(stiffness[i]) + others[i]) / mass[i]);
  // With a consistent mass eigenvalues may be larger than with its diagonal; of linear tetrahedra at most
  // five times as large as with the sums of rows.
  bool coupled = false;
  each_entry(
      M, [&](Eigen::Index i, Eigen::Index j, double value) { coupled = coupled || (i != j && value != 0); });
  found.others = std::sqrt((coupled ? 10 : 1) * most);
  return found;
}

}  // namespace hmax
