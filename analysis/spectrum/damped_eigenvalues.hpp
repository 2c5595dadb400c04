/// The eigenvalues of damped structures of which no damping acts on each mode alone, without dense matrices.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "analysis/spectrum/linear_model.hpp"

namespace hmax {

/// Eigenvalues of (lambda^2 M + lambda C + K) u = 0 of largest modulus.
/// Each lambda and its conjugate are a pair with omega = |lambda| and zeta = -Re(lambda) / |lambda|;
/// eigenvalues of large modulus are what limits explicit steps.
struct DampedEigenvalues {
  std::vector<std::complex<double>> lambda;  ///< the largest first, conjugates side by side [1/s]
  /// No other eigenvalue is larger in modulus, as far as an iteration from one vector can say [1/s];
  /// infinity where it found none.
  double rest = 0;
};

/// By Arnoldi iteration without restarts on the companion form of
///   (0, s I; -k / s, -c),  k = M^-1/2 K M^-1/2, c = M^-1/2 C M^-1/2, s^2 the size of k
/// [tisseur2001quadratic, section 5], until all eigenvalues down to nine tenths of the largest are found, or
/// forty. Residuals are at most 1e-9 of the eigenvalue.
/// A = V H V^T is built column by column, V orthonormal and H upper Hessenberg; a Ritz pair (theta, s) of
/// H, shape (k, k), has the residual h_(k+1,k) |s_k| (Saad, Numerical Methods for Large Eigenvalue
/// Problems).
/// @param part  K and C symmetric
/// @cost  up to 300 products and vectors of twice the degrees of freedom, and less than 1 GB
DampedEigenvalues largest_damped_eigenvalues(const MechanicalPart& part);

/// The largest positive eigenvalue, where K has a negative one: the body buckles. Nothing where K has none.
///   lambda(u) = -gamma/2 + sqrt(gamma^2/4 - kappa),  gamma = u^T C u, kappa = u^T K u, u^T M u = 1,
/// is largest at its eigenvector, which the least eigenvectors of lambda^2 M + lambda C + K approach.
/// The fixed point iteration u -> least eigenvector of k + lambda c -> lambda(u) raises lambda in every
/// step, at most 30 of them. Lanczos iteration on (bound I - k - lambda c), whose largest eigenvalue
/// belongs to that vector.
/// @return  lambda > 0 [1/s], from below
/// @param part  K and C symmetric, C without negative eigenvalues
std::optional<double> growing_eigenvalue(const MechanicalPart& part);

}  // namespace hmax
