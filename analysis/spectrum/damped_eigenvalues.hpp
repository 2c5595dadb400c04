/// The eigenvalues of damped structures of which no damping acts on each mode alone, without dense matrices.
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "analysis/spectrum/linear_model.hpp"
#include "analysis/spectrum/scaled_matrices.hpp"

namespace hmax {

/// Eigenvalues of (lambda^2 M + lambda C + K) u = 0 of largest modulus.
/// Each lambda and its conjugate are a pair with omega = |lambda| and zeta = -Re(lambda) / |lambda|;
/// eigenvalues of large modulus are what limits explicit steps.
struct DampedEigenvalues {
  std::vector<std::complex<double>> lambda{};  ///< the largest first, conjugates side by side [1/s]
  std::vector<Eigen::VectorXcd> shapes{};      ///< u of each lambda, of length 1 in the norm of M, shape (n)
  /// No other eigenvalue is larger in modulus, as far as an iteration can say [1/s];
  /// infinity where it found none.
  double rest = 0;
};

/// Finds them one after another, by Davidson's method with restarts on the quadratic problem itself, in real
/// arithmetic [davidson1975iterative; tisseur2001quadratic, section 6]: of a space of shapes V, orthonormal
/// in M, the Ritz values of largest modulus are the eigenvalues of lambda^2 + lambda V^T C V + V^T K V; the
/// real and the imaginary part of D^-1 r, r = (lambda^2 M + lambda C + K) u, are the next shapes, where D =
/// diag(M) is close to M. A step takes one product with each matrix, where an Arnoldi iteration on the
/// companion form would divide by M. Since the matrices are symmetric an eigenvalue is off by about the
/// square of its residual, which is at most 1e-7 of lambda^2.
class DampedSearch {
 public:
  /// An eigenvalue of large modulus needs a large gamma or kappa, so that the search begins with the shapes
  /// that have the largest of them, beside the same vector in every run: it may have next to nothing of the
  /// shape of a single damper.
  /// @param matrices  K and C symmetric
  /// @param k, c      matrices->largest_k() and largest_c(), three digits are enough
  DampedSearch(std::shared_ptr<const ScaledMatrices> matrices, const LargestEigenpair& k,
               const LargestEigenpair& c);
  ~DampedSearch();

  /// The first `most` eigenvalues, conjugates counted as one; fewer where one is below nine tenths of the
  /// largest, or where products end. Goes on from the space of the last call, so that the answer depends on
  /// the calls before.
  /// @param most_products  with each matrix, about
  /// @cost  room for 72 vectors, or 180 from the third eigenvalue on, a third more where M couples; the first
  /// takes some 30
  ///        to 300 products
  DampedEigenvalues first(std::size_t most, Eigen::Index most_products);

 private:
  struct State;
  bool start();
  [[nodiscard]] DampedEigenvalues found(std::size_t count) const;

  std::shared_ptr<const ScaledMatrices> matrices_;
  std::unique_ptr<State> state_;
};

/// Many of them at once, where vectors are short: Arnoldi iteration without restarts on the companion form
///   (0, s I; -k / s, -c),  k = M^-1/2 K M^-1/2, c = M^-1/2 C M^-1/2, s^2 the size of k
/// [tisseur2001quadratic, section 5], until all eigenvalues down to nine tenths of the largest are found, or
/// forty. A = V H V^T is built column by column, V orthonormal and H upper Hessenberg; a Ritz pair (theta, s)
/// of H, shape (k, k), has the residual h_(k+1,k) |s_k| (Saad, Numerical Methods for Large Eigenvalue
/// Problems), at most 1e-9 of theta. Beyond some 20,000 unknowns DampedSearch finds the few that a limit
/// needs in less time.
/// @param matrices, k, c  as of DampedSearch
/// @cost  up to 300 products, a division by M in each where it couples, and as many vectors of twice the
/// unknowns
DampedEigenvalues many_damped_eigenvalues(const ScaledMatrices& matrices, const LargestEigenpair& k,
                                          const LargestEigenpair& c);

/// The largest positive eigenvalue, where K has a negative one: the body buckles. Nothing where K has none.
///   lambda(u) = -gamma/2 + sqrt(gamma^2/4 - kappa),  gamma = u^T C u, kappa = u^T K u, u^T M u = 1,
/// is largest at its eigenvector, which the least eigenvectors of lambda^2 M + lambda C + K approach.
/// The fixed point iteration u -> least eigenvector of k + lambda c -> lambda(u) raises lambda in every
/// step, at most 30 of them.
/// @return  lambda > 0 [1/s], from below
/// @param find    of symmetric K and C, C without negative eigenvalues
/// @param most_k  about the largest eigenvalue of k [1/s^2]
std::optional<double> growing_eigenvalue(const FindLargestOfSum& find, double most_k);

}  // namespace hmax
