/// Whether a matrix is symmetric, decided in one way.
#pragma once

#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// The first place where a_ij and a_ji differ by more than 1e-9 sqrt(r_i r_j), r_i the largest entry of row
/// and column i; nothing where none does. Assembly adds the two halves of a symmetric matrix in different
/// orders, and text of ten digits leaves 1e-9. A penalty on one unknown says nothing of the others, hence
/// r_i. Where all of a row is rounding, 1e-14 of the larger r is let pass.
/// @param noise  what else is let pass, as a share of the largest entry: of damping, of which many rows may
///               be rounding
std::optional<std::pair<Eigen::Index, Eigen::Index>> first_asymmetry(const Eigen::SparseMatrix<double>& A,
                                                                     double noise = 0);
inline bool is_symmetric(const Eigen::SparseMatrix<double>& A, double noise = 0) {
  return !first_asymmetry(A, noise);
}
/// The noise of a damping matrix.
inline constexpr double damping_noise = 1e-14;

/// (A + A^T) / 2, symmetric to the last bit: later stages see no rounding.
Eigen::SparseMatrix<double> symmetrised(const Eigen::SparseMatrix<double>& A);

}  // namespace hmax
