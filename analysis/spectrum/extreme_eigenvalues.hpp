/// The few eigenvalues that limit a step, of systems too large for all of them.
#pragma once

#include <complex>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "analysis/spectrum/linear_model.hpp"
#include "core/size_limits.hpp"

namespace hmax {

/// Eigenvalues of largest modulus, the largest first, and their eigenvectors.
/// Conjugate pairs are never cut in two.
struct LargestEigenvalues {
  std::vector<std::complex<double>>
      lambda;                ///< shape (count), one more where a conjugate would be cut off [1/s]
  Eigen::MatrixXcd vectors;  ///< shape (n, lambda.size()), columns of length 1
  bool converged = true;     ///< false: fewer than were asked for, which may not be the largest
};

/// The `count` eigenvalues of J of largest modulus, by Arnoldi iteration with thick restarts from a fixed
/// start (arnoldi.hpp); residuals are at most 1e-10 of the eigenvalue. Of a multiple eigenvalue one is found.
/// J is balanced by a diagonal of powers of two first; the subspace has at least 60 and 2 (count + 1) + 20
/// vectors.
/// @param J         shape (n, n)
/// @param dense_to  up to this n all eigenvalues are computed
/// @param restarts  at most
/// @throws InputError  when count is not in [1, n]
LargestEigenvalues largest_eigenvalues(const Eigen::SparseMatrix<double>& J, Eigen::Index count,
                                       Eigen::Index dense_to = small_enough_for_dense,
                                       Eigen::Index restarts = 2000);

/// Eigenvalues of K u = kappa M u from one end of the spectrum, and their shapes.
/// omega = sqrt(kappa) is the natural frequency [rad/s] of an undamped mode.
struct ExtremeStiffnesses {
  std::vector<double> kappa{};  ///< shape (count) [1/s^2]
  Eigen::MatrixXd shapes{};     ///< shape (n, count), shapes^T M shapes = I [kg^-1/2]
  bool converged = true;        ///< false: fewer than were asked for
  /// Of smallest_stiffnesses: how many kappa are negative by more than 1e-8 of a bound of the largest, which
  /// the signs of the pivots of the factor say (Sylvester's law of inertia).
  Eigen::Index negative = 0;
};

/// The `count` largest kappa of a symmetric K, the largest first, by Lanczos iteration; where they lie too
/// close together for it, by shift and invert at Gershgorin's upper bound. Residuals are at most 1e-10 of the
/// largest; where neither converges, as at the dense end of the band of a long chain, the values of the first
/// are returned, from below.
/// Gershgorin: no eigenvalue of k = M^-1/2 K M^-1/2 is larger than max_i sum_j |k_ij|.
/// @param with_shapes  false: `shapes` may be empty, which of one kappa of a large mesh takes half the time
/// @throws std::invalid_argument  when K is not symmetric
/// @throws InputError  when count is not in [1, n]
ExtremeStiffnesses largest_stiffnesses(const MechanicalPart& part, Eigen::Index count = 1,
                                       Eigen::Index dense_to = small_enough_for_dense,
                                       bool with_shapes = true);

/// The `count` smallest kappa of a symmetric K without negative ones, the smallest first, by shift and invert
/// just below zero, so that a system which is free to move (kappa = 0) is served too. Of an indefinite K
/// those nearest to zero. A factor of K is needed, which meshes have up to some 100,000 degrees of freedom.
/// Shift and invert: (k - sigma I)^-1 has the eigenvalues 1 / (kappa - sigma), of which Lanczos iteration
/// finds those of largest modulus, kappa = sigma + 1 / theta (Saad, Numerical Methods for Large Eigenvalue
/// Problems).
/// @throws InputError  when count is not in [1, n]
ExtremeStiffnesses smallest_stiffnesses(const MechanicalPart& part, Eigen::Index count = 1,
                                        Eigen::Index dense_to = small_enough_for_dense);

/// The `count` kappa nearest to a given one, the nearest first, by shift and invert.
/// The matrix k - kappa I is factored without pivoting, which may fail inside of the spectrum: converged
/// is false then. `negative` counts the kappa below the given one.
/// @param kappa  [1/s^2]
/// @throws InputError  when count is not in [1, n]
ExtremeStiffnesses stiffnesses_near(const MechanicalPart& part, double kappa, Eigen::Index count = 1);

}  // namespace hmax
