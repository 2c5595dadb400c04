/// Rows of K and M that hold an unknown in place, as finite element programs write them.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// How much larger than all other entries of its row the diagonal of a penalty row is.
inline constexpr double penalty_ratio = 1e4;

/// The constraint rows of a structure; rows count from 0.
///
/// Two kinds are known. A *decoupled* row has nothing but its diagonal in K, C and M, as programs write that
/// replace the row of a fixed unknown by that of the unit matrix. A *penalty* row has
///   K_ii >= 1e4 sum_{j != i} |K_ij|   and   k_ii >= 1e4 sum_{j != i} |k_ij|,   k = M^-1/2 K M^-1/2,
/// as programs write that add a large number to the diagonal. For symmetric K the residual of the unit vector
/// e_i, |k e_i - k_ii e_i| <= 1e-4 k_ii, bounds the distance from k_ii to an eigenvalue: a mode sits on that
/// unknown alone, with the frequency sqrt(k_ii) to 1e-4. The first condition leaves out unknowns that are
/// fast because their mass is small.
struct ConstraintRows {
  std::vector<Eigen::Index> decoupled, penalties;
  /// The largest sqrt(K_ii / M_ii) of these rows [rad/s]; rows without mass have none.
  double fastest = 0;
  /// A bound of the frequencies of all other rows, by Gershgorin's theorem [rad/s].
  double others = 0;

  [[nodiscard]] bool none() const { return decoupled.empty() && penalties.empty(); }
  /// Whether these rows own the fastest mode for certain.
  [[nodiscard]] bool own_the_fastest() const { return fastest > others; }
};

/// @param K     stiffness, shape (n, n)
/// @param C     damping, shape (n, n)
/// @param M     mass, shape (n, n), a diagonal where masses are lumped
/// A model in which no row couples to another has no constraint rows.
ConstraintRows constraint_rows(const Eigen::SparseMatrix<double>& K, const Eigen::SparseMatrix<double>& C,
                               const Eigen::SparseMatrix<double>& M);

}  // namespace hmax
