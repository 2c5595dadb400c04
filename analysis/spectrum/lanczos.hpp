/// Extreme eigenvalues of symmetric operators of which only products with vectors are known.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace hmax {

/// y = A x of a symmetric A, both of shape (n).
using SymmetricOperator = std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& y)>;

/// When the iteration ends.
struct LanczosSettings {
  double tolerance = 1e-6;            ///< of the residual, relative to the eigenvalue
  Eigen::Index most_products = 2000;  ///< after which the best pair so far is returned, converged or not
  /// Whether the eigenvector is wanted; it takes the memory of the basis or a second run.
  bool with_vector = true;
};

/// An eigenvalue and what is known of it.
struct LanczosPair {
  double value = 0;
  /// |A u - value u| with |u| = 1: an eigenvalue of A is as near as that. Measured by one more product where
  /// the vector is wanted; else what the recurrence says of it.
  double residual = 0;
  Eigen::VectorXd vector;  ///< u, shape (n); empty unless wanted
  Eigen::Index products = 0;
  bool converged = false;
};

/// The largest eigenvalue of A, by Lanczos iteration without restarts and without orthogonalising anew
/// [paige1980accuracy]: rounding makes copies of eigenvalues that have converged, and the largest is the
/// first to do so. It begins with the same vector in every run, which has a part in every eigenvector of any
/// matrix that one meets; there is no proof that a larger eigenvalue was not missed.
/// b_j q_j+1 = A q_j - a_j q_j - b_j-1 q_j-1, a_j = q_j^T A q_j, b_j = |...|; the largest eigenvalue theta
/// of the tridiagonal T of a and b, with eigenvector s, has the residual |A u - theta u| = b_k |s_k| for u
/// = Q s (Golub and Van Loan, Matrix Computations).
/// Convergence depends on the gap to the next eigenvalue relative to the spread of the spectrum: clustered
/// ends are slow.
/// @param n  at least 1
/// @cost  a product and three vector operations a step; basis vectors are kept up to 400 MB, beyond that all
///        steps are made a second time for the vector
LanczosPair largest_eigenpair(const SymmetricOperator& A, Eigen::Index n,
                              const LanczosSettings& settings = {});

/// What comes first.
enum class Rank { largest, largest_modulus };

/// The answer of first_eigenpairs().
struct LanczosPairs {
  std::vector<double> values;  ///< shape (count), in order of rank
  Eigen::MatrixXd vectors;     ///< orthonormal columns, shape (n, count)
  Eigen::Index products = 0;
  bool converged = false;  ///< false: fewer than were asked for
};

/// The first `count` eigenvalues, with their multiplicities: orthogonalised in full, and what was found is
/// taken out until nothing is left that comes before the last.
/// Full orthogonalisation keeps the basis orthonormal to rounding; what was found before is projected out,
/// so that the next run sees the rest of the spectrum, further copies of multiple eigenvalues included.
/// @param most_products  in one run; then those that have converged are taken
/// @return  converged = false where fewer than `count` were found
/// @cost  products and k^2 n operations for k of them, which should stay below some hundreds
LanczosPairs first_eigenpairs(const SymmetricOperator& A, Eigen::Index n, Eigen::Index count, Rank rank,
                              double tolerance = 1e-10, Eigen::Index most_products = 400);

/// A vector that is orthogonal to no mode of a regular structure, and the same in every run: the numbers of a
/// linear congruential generator in (-1/2, 1/2).
/// @return  shape (n), not normalised; the first numbers are the same for every n
Eigen::VectorXd start_vector(Eigen::Index n);

}  // namespace hmax
