/// Whether a matrix is symmetric, decided in one way.
#pragma once

#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// The first place where A and its transpose differ by more than 1e-10 of the largest entry; nothing where
/// none does. Assembly adds the two halves of a symmetric matrix in different orders, which rounds to 1e-16
/// of the largest terms, and text of ten digits leaves 1e-10.
std::optional<std::pair<Eigen::Index, Eigen::Index>> first_asymmetry(const Eigen::SparseMatrix<double>& A);
inline bool is_symmetric(const Eigen::SparseMatrix<double>& A) { return !first_asymmetry(A); }

/// (A + A^T) / 2, symmetric to the last bit: later stages see no rounding.
Eigen::SparseMatrix<double> symmetrised(const Eigen::SparseMatrix<double>& A);

}  // namespace hmax
