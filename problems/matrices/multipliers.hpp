/// Lagrange multipliers, taken out of a structure together with what they hold.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// The rows of Lagrange multipliers, rising: they have no mass, nothing on the diagonal of K, and couple to
/// no other such row.
/// @param massless  of each row of K, whether it has no mass
std::vector<Eigen::Index> multiplier_rows(const Eigen::SparseMatrix<double>& K,
                                          const std::vector<char>& massless);

/// The motions that the constraints B q = 0 of multipliers leave, q = Z p.
struct ConstrainedMotions {
  std::vector<Eigen::Index> kept;       ///< the unknowns p, rows of K, rising
  std::vector<Eigen::Index> redundant;  ///< multipliers whose constraint follows from others
  Eigen::SparseMatrix<double> Z;        ///< shape (rows of K, kept); zero in the rows of multipliers
};

/// Each constraint gives one of its unknowns as a sum of others, by Gauss-Jordan elimination on the sparse
/// rows of B; unknowns without mass go first, since sums of others couple masses. With
///   M q'' + K q + B^T l = 0,  B q = 0
/// the motion is exactly Z^T M Z p'' + Z^T K Z p = 0, as B Z = 0 [benzi2005numerical].
/// @param multipliers  rows of K, from multiplier_rows()
/// @param name_of      an unknown in words, for errors
/// @throws std::invalid_argument  where the columns of multipliers are not the transposes of their rows,
/// nothing is left that moves, or the constraints couple too many unknowns
ConstrainedMotions constrained_motions(const Eigen::SparseMatrix<double>& K,
                                       const std::vector<Eigen::Index>& multipliers,
                                       const std::vector<char>& massless,
                                       const std::function<std::string(Eigen::Index)>& name_of);

/// Z^T A Z, symmetric to the last bit where A is symmetric.
Eigen::SparseMatrix<double> projected(const Eigen::SparseMatrix<double>& A,
                                      const Eigen::SparseMatrix<double>& Z);

}  // namespace hmax
