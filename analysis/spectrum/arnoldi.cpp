#include "analysis/spectrum/arnoldi.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/spectrum/tall_products.hpp"
#include "core/dense_solvers.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A V = V H + w b^T with V^T G V = I, V^T G w = 0.
class KrylovSpace {
 public:
  KrylovSpace(const LinearOperator& A, const VectorXd& start, const ArnoldiSettings& settings)
      : A_(A), G_(settings.inner), most_(std::min(settings.basis, start.size())) {
    V_.resize(start.size(), most_ + 1);
    H_ = MatrixXd::Zero(most_ + 1, most_ + 1);
    V_.col(0) = start / norm(start, weighted(start));
  }

  /// Up to the full basis, or until the space is invariant.
  /// @returns false where a product is not finite
  bool extend() { return extend_to(most_); }
  bool extend_to(Index size) {
    while (size_ < std::min(size, most_) && !invariant_) {
      VectorXd w = A_(V_.col(size_));
      ++products_;
      if (!w.allFinite()) return false;
      VectorXd weighted_w = weighted(w);
      const double before = norm(w, weighted_w);
      double left = before;
      // Once more where it took away so much that rounding of it is left; twice is enough
      // [daniel1976reorthogonalization].
      for (int time = 0; time < 2; ++time) {
        const VectorXd h = transposed_times(V_, size_ + 1, weighted_w);
        w -= times(V_, size_ + 1, h);
        H_.col(size_).head(size_ + 1) += h;
        weighted_w = weighted(w);
        const double now = norm(w, weighted_w);
        const bool clean = now > 0.7 * std::exchange(left, now);
        if (clean) break;
      }
      invariant_ = !(left > 1e-13 * before);
      H_(size_ + 1, size_) = invariant_ ? 0 : left;
      if (!invariant_) V_.col(size_ + 1) = w / left;
      ++size_;
    }
    return true;
  }

  [[nodiscard]] DominantEigenvalue dominant(const SortedEigenpairs& ritz, double tolerance) const {
    DominantEigenvalue found{.value = ritz.values.front(),
                             .vector = V_.leftCols(size_) * ritz.vectors.col(0)};
    found.residual = std::abs((H_.row(size_).head(size_) * ritz.vectors.col(0)).value());
    found.converged = found.residual <= tolerance * std::abs(found.value);
    found.products = products_;
    return found;
  }

  /// Residuals of Ritz pairs, their conditions where these are wanted, and their vectors.
  [[nodiscard]] RitzSpectrum spectrum(const SortedEigenpairs& ritz, bool conditions) const {
    RitzSpectrum found{.products = products_, .invariant = invariant_};
    Eigen::MatrixXcd left;
    if (conditions) left = ritz.vectors.partialPivLu().inverse();
    for (std::size_t i = 0; i < ritz.values.size(); ++i) {
      const auto at = static_cast<Index>(i);
      const double condition = conditions ? left.row(at).norm() : 1;
      found.values.push_back(
          {.value = ritz.values[i],
           .residual = std::abs((H_.row(size_).head(size_) * ritz.vectors.col(at)).value()),
           .condition = std::isfinite(condition) ? condition : std::numeric_limits<double>::infinity()});
    }
    found.vector = [this, &ritz](std::size_t i) {
      return Eigen::VectorXcd(V_.leftCols(size_) * ritz.vectors.col(static_cast<Index>(i)));
    };
    return found;
  }

  [[nodiscard]] SortedEigenpairs ritz() const { return SortedEigenpairs(H_.topLeftCorner(size_, size_)); }

  /// Keeps the space of the first Ritz vectors.
  void restart(const SortedEigenpairs& ritz, Index kept) {
    if (std::abs(ritz.values[static_cast<std::size_t>(kept - 1)] -
                 std::conj(ritz.values[static_cast<std::size_t>(kept)])) == 0 &&
        ritz.values[static_cast<std::size_t>(kept)].imag() != 0)
      ++kept;
    MatrixXd parts(size_, kept);
    for (Index i = 0; i < kept; ++i)
      parts.col(i) = ritz.values[static_cast<std::size_t>(i)].imag() < 0
                         ? VectorXd(ritz.vectors.col(i).imag())
                         : VectorXd(ritz.vectors.col(i).real());
    const MatrixXd Q = orthonormal_basis(parts);
    const MatrixXd T = Q.transpose() * H_.topLeftCorner(size_, size_) * Q;
    const Eigen::RowVectorXd below = H_.row(size_).head(size_) * Q;
    const MatrixXd front = V_.leftCols(size_) * Q;
    V_.col(kept) = V_.col(size_).eval();
    V_.leftCols(kept) = front;
    H_.setZero();
    H_.topLeftCorner(kept, kept) = T;
    H_.row(kept).head(kept) = below;
    size_ = kept;
  }

  [[nodiscard]] bool is_invariant() const { return invariant_; }
  [[nodiscard]] bool is_full() const { return size_ == most_ || invariant_; }
  [[nodiscard]] Index size() const { return size_; }
  [[nodiscard]] Index products() const { return products_; }

 private:
  [[nodiscard]] VectorXd weighted(const VectorXd& x) const { return G_ ? G_(x) : x; }
  static double norm(const VectorXd& x, const VectorXd& weighted_x) {
    return std::sqrt(std::max(0.0, x.dot(weighted_x)));
  }

  const LinearOperator& A_;
  const LinearOperator& G_;
  Index most_, size_ = 0, products_ = 0;
  bool invariant_ = false;
  MatrixXd V_, H_;
};

}  // namespace

DominantEigenvalue dominant_eigenvalue(const LinearOperator& A, const VectorXd& start,
                                       const ArnoldiSettings& settings) {
  KrylovSpace space(A, start, settings);
  while (true) {
    if (!space.extend())
      return {.value = std::numeric_limits<double>::infinity(),
              .vector = start.cast<Complex>(),
              .products = space.products()};
    const SortedEigenpairs ritz = space.ritz();
    DominantEigenvalue found = space.dominant(ritz, settings.tolerance);
    const bool decided = settings.threshold > 0 &&
                         (found.exceeds(settings.threshold) || found.stays_below(settings.threshold));
    const auto count = static_cast<Index>(ritz.values.size());
    if (found.converged || decided || space.is_invariant() || settings.kept + 1 >= count ||
        found.products + count - settings.kept > settings.most_products)
      return found;
    space.restart(ritz, settings.kept);
  }
}

RitzSearch visit_ritz_spectra(const LinearOperator& A, const VectorXd& start, const ArnoldiSettings& settings,
                              Index stride, const std::function<bool(const RitzSpectrum&)>& is_decided) {
  KrylovSpace space(A, start, settings);
  while (true) {
    if (!space.extend_to(space.size() + stride)) return RitzSearch::not_finite;
    const SortedEigenpairs ritz = space.ritz();
    const auto count = static_cast<Index>(ritz.values.size());
    if (count == 0) return RitzSearch::undecided;
    if (is_decided(space.spectrum(ritz, settings.conditions))) return RitzSearch::decided;
    if (space.is_invariant() || space.products() + stride > settings.most_products)
      return RitzSearch::undecided;
    if (!space.is_full()) continue;
    if (settings.kept + 1 >= count) return RitzSearch::undecided;
    space.restart(ritz, settings.kept);
  }
}

}  // namespace hmax
