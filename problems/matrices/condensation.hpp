/// Unknowns without mass, taken out of a structure.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// M q'' + C q' + K q = 0 without its unknowns without mass.
struct CondensedStructure {
  std::vector<Eigen::Index> kept;    ///< rows with mass, counted from 0, rising
  Eigen::SparseMatrix<double> K, C;  ///< shape (kept, kept)
};

/// Static condensation [guyan1965reduction], which is exact here: with the massless rows m and the others u
///   K_mu q_u + K_mm q_m = 0,   q_m = -T q_u,   T = K_mm^-1 K_mu,
///   K' = K_uu - K_um T,   C' = C_uu - C_um T.
/// Damping of massless rows is taken where it is proportional, C_m = b K_m: then that motion decays at the
/// rate 1 / b to the one above, by itself.
/// @param massless  of each row of K, whether it has no mass
/// @param name_of   an unknown in words, for errors
/// @throws std::invalid_argument  where K_mm is singular, damping acts on a massless unknown otherwise, or K'
/// would be too full to be stored
CondensedStructure condensed(const Eigen::SparseMatrix<double>& K, const Eigen::SparseMatrix<double>& C,
                             const std::vector<char>& massless,
                             const std::function<std::string(Eigen::Index)>& name_of);

/// @throws std::invalid_argument  unless the rows of C are a number times those of K
void require_proportional_damping(const Eigen::SparseMatrix<double>& C, const Eigen::SparseMatrix<double>& K,
                                  const std::vector<Eigen::Index>& rows,
                                  const std::function<std::string(Eigen::Index)>& name_of);

/// The rows and columns `rows` and `columns` of A, in their order.
Eigen::SparseMatrix<double> block_of(const Eigen::SparseMatrix<double>& A,
                                     const std::vector<Eigen::Index>& rows,
                                     const std::vector<Eigen::Index>& columns);

}  // namespace hmax
