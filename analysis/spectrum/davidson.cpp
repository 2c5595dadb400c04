#include "analysis/spectrum/davidson.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/spectrum/tall_products.hpp"
#include "core/dense_solvers.hpp"

namespace hmax {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Vectors before a restart, and those that it keeps.
constexpr Index most_vectors = 20, kept_vectors = 8;

/// A space of vectors that are orthonormal in M, with their images.
class Space {
 public:
  Space(const SymmetricOperator& A, const CoupledMass& M, Index count)
      : A_(A),
        M_(M),
        most_(std::min(most_vectors, M.size())),
        V_(M.size(), most_),
        MV_(M.size(), most_),
        AV_(M.size(), most_),
        H_(most_, most_),
        found_(M.size(), count),
        M_found_(M.size(), count),
        image_(M.size()) {}

  [[nodiscard]] bool is_full() const { return size_ == most_; }
  [[nodiscard]] Index found() const { return found_count_; }
  [[nodiscard]] MatrixXd vectors() const { return found_.leftCols(found_count_); }

  /// Adds the part of t that is new.
  /// @returns false where there is none but rounding
  bool add(VectorXd t) {
    const auto times_M = [&](const VectorXd& x, VectorXd& y) {
      y = x;
      M_.multiply(y);
    };
    const auto remove = [&](VectorXd& x) {
      const VectorXd h = transposed_times(MV_, size_, x), g = transposed_times(M_found_, found_count_, x);
      x -= times(V_, size_, h) + times(found_, found_count_, g);
    };
    if (!make_orthonormal(t, image_, times_M, remove)) return false;
    V_.col(size_) = t;
    MV_.col(size_) = image_;
    A_(t, image_);
    AV_.col(size_) = image_;
    H_.col(size_).head(size_ + 1) = transposed_times(V_, size_ + 1, image_);
    ++size_;
    return true;
  }

  /// u, kappa and r = A u - kappa M u of the largest Ritz value; the Ritz vectors are kept for restart() and
  /// lock().
  double ritz(VectorXd& u, VectorXd& r) {
    const MatrixXd H = H_.topLeftCorner(size_, size_).selfadjointView<Eigen::Upper>();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(H);
    values_ = solver.eigenvalues().reverse();
    ritz_ = solver.eigenvectors().rowwise().reverse();
    const double kappa = values_[0];
    const VectorXd s = ritz_.col(0);
    u = times(V_, size_, s);
    r = times(AV_, size_, s) - kappa * times(MV_, size_, s);
    return kappa;
  }

  /// Keeps the first Ritz vectors alone.
  void restart() { take(0, std::min(kept_vectors, size_)); }
  /// Takes the first Ritz vector out of the space for good.
  void lock() {
    found_.col(found_count_).noalias() = V_.leftCols(size_) * ritz_.col(0);
    image_ = found_.col(found_count_);
    M_.multiply(image_);
    M_found_.col(found_count_) = image_;
    ++found_count_;
    take(1, std::min(kept_vectors, size_ - 1));
  }

 private:
  void take(Index first, Index count) {
    const MatrixXd S = ritz_.middleCols(first, count);
    for (MatrixXd* vectors : {&V_, &MV_, &AV_})
      vectors->leftCols(count) = (vectors->leftCols(size_) * S).eval();
    H_.topLeftCorner(count, count) = values_.segment(first, count).asDiagonal();
    size_ = count;
  }

  const SymmetricOperator& A_;
  const CoupledMass& M_;
  Index most_, size_ = 0, found_count_ = 0;
  MatrixXd V_, MV_, AV_;
  MatrixXd H_;  ///< V^T A V, its upper triangle
  MatrixXd found_, M_found_, ritz_;
  VectorXd values_, image_;
};

}  // namespace

PencilPairs largest_pencil_eigenpairs(const SymmetricOperator& A, const CoupledMass& M, Index count,
                                      double tolerance, Index most_products) {
  const Index n = M.size();
  Space space(A, M, count);
  PencilPairs result;
  const VectorXd inverse = M.diagonal().cwiseInverse();
  VectorXd u(n), r(n), numbers = start_vector(n * 2);
  Index starts = 0;
  // A start that is new: further copies of a multiple eigenvalue are in no space of the first.
  const auto start = [&] {
    const VectorXd from = numbers.segment(starts % n, n).cwiseProduct(inverse.cwiseSqrt());
    ++starts;
    return space.add(from);
  };
  start();
  double kappa = 0;
  for (; result.products < most_products; ++result.products) {
    kappa = space.ritz(u, r);
    // |r| in the norm of M^-1 is at most that of D^-1 over the least eigenvalue of D^-1 M.
    result.residual = std::sqrt(r.dot(inverse.cwiseProduct(r)) / M.least_share());
    if (result.residual <= tolerance * std::abs(kappa)) {
      space.lock();
      result.values.push_back(kappa);
      if (space.found() == count) break;
      if (!start()) break;
      continue;
    }
    if (space.is_full()) space.restart();
    if (!space.add(inverse.cwiseProduct(r)) && !start()) break;
  }
  result.converged = space.found() == count;
  result.vectors = space.vectors();
  if (result.values.empty()) {
    result.values.push_back(kappa);
    result.vectors = u;
  }
  return result;
}

LanczosPair largest_eigenpair(const SymmetricOperator& A, const MassMatrix<double>& M,
                              const LanczosSettings& settings) {
  if (M.is_diagonal()) return largest_eigenpair(A, M.size(), settings);
  const PencilPairs pairs =
      largest_pencil_eigenpairs(A, *M.coupled(), 1, settings.tolerance, settings.most_products);
  return {pairs.values.front(), pairs.residual, pairs.vectors.col(0), pairs.products, pairs.converged};
}

}  // namespace hmax
