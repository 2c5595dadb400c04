#include "analysis/spectrum/damped_eigenvalues.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/spectrum/eigen_solvers.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "analysis/spectrum/scaled_matrices.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Residual over modulus at which a Ritz value counts.
constexpr double tolerance = 1e-9;
constexpr double deep_enough = 0.9;  // of the largest modulus
// Enough eigenvalues for a limit, even if they are less than a tenth below the largest.
constexpr std::size_t many_enough = 40;

/// y = (0, s I; -k / s, -c) x.
/// The companion form in x = (s u, lambda u), u = M^1/2 q: its eigenvalues are those of lambda^2 + lambda
/// c + k, and both off-diagonal blocks have about the norm s.
class Companion {
 public:
  Companion(const ScaledMatrices& scaled, double s) : scaled_(scaled), s_(s), product_(scaled.size()) {}

  /// Costs one product with k and one with c.
  void operator()(const VectorXd& x, VectorXd& y) {
    const Index n = product_.size();
    // lambda (s u) = s (lambda u)
    y.head(n) = s_ * x.tail(n);
    scaled_.k.apply(x.data(), product_.data());
    y.tail(n) = -product_ / s_;
    scaled_.c.apply(x.data() + n, product_.data());
    y.tail(n) -= product_;
  }

 private:
  const ScaledMatrices& scaled_;
  double s_;
  VectorXd product_;
};

/// The Ritz values of H, shape (k, k), the largest first, up to the first that has not converged.
/// Sorted by modulus; a pair of conjugates has equal residuals, so both or none count.
/// @param below  the entry of H below its last column
DampedEigenvalues converged(const MatrixXd& H, double below) {
  const SortedEigenpairs pairs(H);
  DampedEigenvalues result{.lambda = {}, .rest = std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < pairs.values.size(); ++i) {
    // |A V s - theta V s| = h_(k+1,k) |s_k| for |s| = 1.
    const double residual = below * std::abs(pairs.vectors(H.rows() - 1, static_cast<Index>(i)));
    if (!(residual <= tolerance * std::abs(pairs.values[i]))) break;
    result.lambda.push_back(pairs.values[i]);
    result.rest = std::abs(pairs.values[i]);
  }
  return result;
}

}  // namespace

// Arnoldi iteration: w = A q_k is orthogonalised against q_1 ... q_k, which gives column k of H; Ritz
// values are looked at every thirty steps.
DampedEigenvalues largest_damped_eigenvalues(const MechanicalPart& part) {
  const ScaledMatrices scaled(part);
  const Index n = scaled.size();
  // s^2 to one percent serves: it only balances the blocks.
  const LanczosPair size = largest_eigenpair([&](const VectorXd& x, VectorXd& y) { scaled.k(x, y); }, n,
                                             {.tolerance = 1e-2, .with_vector = false});
  Companion A(scaled, std::sqrt(std::max(size.value, std::numeric_limits<double>::min())));
  // V takes at most 1 GB: between 60 and 300 vectors of 2 n numbers, no more than 2 n of them.
  constexpr double most_numbers = 1e9 / sizeof(double);
  const Index most = std::min<Index>(
      2 * n, std::clamp<Index>(static_cast<Index>(most_numbers / static_cast<double>(2 * n)), 60, 300));
  MatrixXd V(2 * n, most + 1), H = MatrixXd::Zero(most + 1, most);
  V.col(0) = start_vector(2 * n).normalized();
  VectorXd q(2 * n), w(2 * n);
  DampedEigenvalues result{.lambda = {}, .rest = std::numeric_limits<double>::infinity()};
  for (Index k = 0; k < most; ++k) {
    q = V.col(k);
    A(q, w);
    // Once more where it took away so much that rounding of it is left; twice is enough
    // [daniel1976reorthogonalization].
    double norm = w.norm();
    for (int time = 0; time < 2; ++time) {
      // Classical Gram and Schmidt: h = V^T w, w <- w - V h.
      const VectorXd h = V.leftCols(k + 1).transpose() * w;
      w -= V.leftCols(k + 1) * h;
      H.col(k).head(k + 1) += h;
      const double left = w.norm();
      const bool clean = left > 0.7 * norm;
      norm = left;
      if (clean) break;
    }
    // h_k+1,k = |w| after orthogonalisation.
    H(k + 1, k) = norm;
    const Index count = k + 1;
    // The Krylov space is closed: its Ritz values are eigenvalues.
    const bool invariant = H(count, k) <= 1e-14 * H.col(k).norm();
    if (!invariant) V.col(count) = w / H(count, k);
    if (count % 30 != 0 && count != most && !invariant) continue;
    result = converged(H.topLeftCorner(count, count), H(count, k));
    if (invariant || result.lambda.size() >= many_enough ||
        (!result.lambda.empty() && result.rest <= deep_enough * std::abs(result.lambda.front())))
      break;
  }
  return result;
}

// Without damping the first round gives the answer, sqrt(-kappa_min).
std::optional<double> growing_eigenvalue(const MechanicalPart& part) {
  const ScaledMatrices scaled(part);
  const Index n = scaled.size();
  VectorXd product(n);
  // |lambda^2 + lambda c + k| is at most this.
  const double most_k = scaled.largest_k(), most_c = scaled.largest_c();
  std::optional<double> lambda;
  for (int iteration = 0; iteration < 30; ++iteration) {
    // The first round has lambda = 0: the least eigenvector of k.
    const double l = lambda.value_or(0), bound = most_k + l * most_c;
    const LanczosPair least = largest_eigenpair(
        [&](const VectorXd& x, VectorXd& y) {
          scaled.k(x, y);
          scaled.c(x, product);
          // (bound - k - l c) x with bound >= |k + l c|.
          y = bound * x - y - l * product;
        },
        n, {.tolerance = 1e-10});
    scaled.k(least.vector, product);
    const double kappa = least.vector.dot(product);
    scaled.c(least.vector, product);
    const double gamma = least.vector.dot(product);
    // No negative stiffness along it beyond rounding: nothing grows.
    if (!(kappa < -1e-9 * most_k)) return lambda;
    // -gamma/2 + sqrt(gamma^2/4 - kappa) without cancellation, kappa < 0.
    const double next = -2 * kappa / (gamma + std::sqrt(gamma * gamma - 4 * kappa));
    if (lambda && next <= *lambda * (1 + 1e-10)) return lambda;
    lambda = next;
  }
  return lambda;
}

}  // namespace hmax
