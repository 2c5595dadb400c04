/// The eigenvalue of largest modulus of an operator of which only products with vectors are known.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace hmax {

/// A x of a real operator, shape (n). Anything not finite stands for a product beyond the range of numbers.
using LinearOperator = std::function<Eigen::VectorXd(const Eigen::VectorXd& x)>;

struct ArnoldiSettings {
  Eigen::Index basis = 30;  ///< vectors before a restart
  Eigen::Index kept = 10;  ///< Ritz vectors that a restart keeps, one more where a conjugate would be cut off
  Eigen::Index most_products = 90;  ///< at least `basis` of them
  double tolerance = 1e-8;          ///< of the residual, relative to the eigenvalue
  /// The iteration ends when it can tell on which side of this modulus the largest eigenvalue lies; 0: never
  /// before it has converged.
  double threshold = 0;
  bool conditions = true;  ///< of Ritz values, for visit_ritz_spectra(), are computed
  /// x -> G x of the inner product x^T G y, G symmetric and positive definite; empty: the identity.
  LinearOperator inner = {};
};

/// A Ritz pair.
struct DominantEigenvalue {
  std::complex<double> value;  ///< infinite where a product was not finite
  Eigen::VectorXcd vector;     ///< of length 1 in the norm of the inner product, shape (n)
  double residual = 0;         ///< |A x - value x| in that norm
  bool converged = false;      ///< to the tolerance
  Eigen::Index products = 0;

  /// Whether the modulus is above the threshold by much more than the residual, which bounds the error of an
  /// eigenvalue only where A is normal in the inner product.
  [[nodiscard]] bool exceeds(double threshold) const {
    return std::abs(value) > threshold && residual < 0.05 * (std::abs(value) - threshold);
  }
  /// Whether it is below the threshold by more than the residual. Ritz values lie within those of the
  /// operator: of an eigenvalue that the space has no part of this tells nothing.
  [[nodiscard]] bool stays_below(double threshold) const { return std::abs(value) + residual <= threshold; }
};

/// By Arnoldi iteration with thick restarts: a restart keeps the space of the largest Ritz vectors, which
/// leaves a Krylov space [stewart2002krylov]. An eigenvalue in a cluster of equal moduli converges slowly; a
/// power of A separates them.
/// @param start  shape (n), not zero, with a part in every eigenvector of interest
DominantEigenvalue dominant_eigenvalue(const LinearOperator& A, const Eigen::VectorXd& start,
                                       const ArnoldiSettings& settings = {});

struct RitzValue {
  std::complex<double> value;
  double residual = 0;  ///< |A x - value x|, |x| = 1
  /// |y| |x| / |y^H x| of the projected operator: a defective eigenvalue has an infinite one. Within the
  /// space it is at most that of A.
  double condition = 1;
};

/// What a Krylov space tells of the spectrum of its operator. Valid while it is visited.
struct RitzSpectrum {
  std::vector<RitzValue> values{};  ///< largest modulus first
  Eigen::Index products = 0;        ///< so far
  bool invariant = false;           ///< the values are eigenvalues of the operator to rounding
  /// The Ritz vector of values[i], shape (n), of length 1.
  std::function<Eigen::VectorXcd(std::size_t i)> vector{};
};

/// How the search of visit_ritz_spectra() ended.
enum class RitzSearch { decided, undecided, not_finite };

/// The iteration of dominant_eigenvalue() for callers that judge all Ritz values: `is_decided` is called each
/// time that `stride` vectors have come to the basis, and ends the search with true. `tolerance` and
/// `threshold` are not used.
RitzSearch visit_ritz_spectra(const LinearOperator& A, const Eigen::VectorXd& start,
                              const ArnoldiSettings& settings, Eigen::Index stride,
                              const std::function<bool(const RitzSpectrum&)>& is_decided);

}  // namespace hmax
