#include "analysis/spectrum/damped_eigenvalues.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/spectrum/arnoldi.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "analysis/spectrum/tall_products.hpp"
#include "core/dense_solvers.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// Residual over modulus squared at which a Ritz value counts.
constexpr double tolerance = 1e-7;
constexpr double deep_enough = 0.9;  // of the largest modulus
// Enough eigenvalues for a limit, even if they are less than a tenth below the largest.
constexpr std::size_t many_enough = 40;

/// A space of vectors that are orthonormal in M, with their images, in coordinates where a diagonal M is one.
class QuadraticSpace {
 public:
  QuadraticSpace(const ScaledMatrices& matrices, Index most)
      : k_(matrices.k.unscaled()),
        c_(matrices.c.unscaled()),
        M_(matrices.mass.coupled()),
        most_(std::min(most, matrices.size())),
        V_(matrices.size(), most_),
        MV_(M_ ? matrices.size() : 0, most_),
        KV_(matrices.size(), most_),
        CV_(matrices.size(), most_),
        k_of_V_(most_, most_),
        c_of_V_(most_, most_),
        inverse_(M_ ? VectorXd(M_->diagonal().cwiseInverse()) : VectorXd::Ones(matrices.size())),
        image_(matrices.size()) {}

  [[nodiscard]] Index size() const { return size_; }
  /// D^-1, shape (n): close to M^-1.
  [[nodiscard]] const VectorXd& inverse() const { return inverse_; }
  /// The Ritz values with Im >= 0, the largest first.
  [[nodiscard]] const std::vector<Complex>& values() const { return values_; }

  /// Adds the part of t that is new. @returns false where there is none but rounding
  bool add(VectorXd t) {
    if (size_ == most_) return false;
    const auto times_M = [&](const VectorXd& x, VectorXd& y) {
      y = x;
      if (M_) M_->multiply(y);
    };
    const auto remove = [&](VectorXd& x) {
      x -= times(V_, size_, transposed_times(images_in_M(), size_, x));
    };
    if (!make_orthonormal(t, image_, times_M, remove)) return false;
    V_.col(size_) = t;
    if (M_) MV_.col(size_) = image_;
    project(k_, t, KV_, k_of_V_);
    project(c_, t, CV_, c_of_V_);
    ++size_;
    return true;
  }

  /// The eigenvalues of lambda^2 + lambda V^T C V + V^T K V, by its companion form (0, s I; -k / s, -c): both
  /// of its off-diagonal blocks have about the norm s.
  void solve() {
    const auto k = k_of_V_.topLeftCorner(size_, size_).selfadjointView<Eigen::Upper>(),
               c = c_of_V_.topLeftCorner(size_, size_).selfadjointView<Eigen::Upper>();
    const double s = std::sqrt(std::max(MatrixXd(k).norm(), std::numeric_limits<double>::min()));
    MatrixXd A = MatrixXd::Zero(2 * size_, 2 * size_);
    A.topRightCorner(size_, size_).diagonal().setConstant(s);
    A.bottomLeftCorner(size_, size_) = MatrixXd(k) / -s;
    A.bottomRightCorner(size_, size_) = -MatrixXd(c);
    const SortedEigenpairs pairs(A);
    before_ = std::exchange(values_, {});
    shapes_.resize(size_, 2 * size_);
    for (std::size_t i = 0; i < pairs.values.size(); ++i) {
      if (pairs.values[i].imag() < 0) continue;
      shapes_.col(static_cast<Index>(values_.size())) =
          pairs.vectors.col(static_cast<Index>(i)).head(size_).normalized();
      values_.push_back(pairs.values[i]);
    }
  }

  /// How many of the first `count` values are what they were before the last solve().
  [[nodiscard]] std::size_t same_as_before(std::size_t count) const {
    const auto same = [](Complex a, Complex b) { return std::abs(a - b) <= 1e-12 * std::abs(a); };
    count = std::min({count, values_.size(), before_.size()});
    return static_cast<std::size_t>(std::mismatch(values_.begin(),
                                                  values_.begin() + static_cast<std::ptrdiff_t>(count),
                                                  before_.begin(), same)
                                        .first -
                                    values_.begin());
  }

  /// (lambda^2 M + lambda C + K) u of a Ritz value and its vector u of length 1 in the norm of M.
  [[nodiscard]] VectorXcd residual(std::size_t i) const {
    const Complex lambda = values_[i];
    const VectorXcd s = shapes_.col(static_cast<Index>(i));
    VectorXcd r(V_.rows());
    const Complex square = lambda * lambda;
    const VectorXcd in_M = square * s, in_C = lambda * s;
    r.real() = times(images_in_M(), size_, in_M.real()) + times(CV_, size_, in_C.real()) +
               times(KV_, size_, s.real());
    r.imag().setZero();
    if (lambda.imag() != 0)
      r.imag() = times(images_in_M(), size_, in_M.imag()) + times(CV_, size_, in_C.imag()) +
                 times(KV_, size_, s.imag());
    return r;
  }
  /// u.
  [[nodiscard]] VectorXcd vector(std::size_t i) const {
    VectorXcd u(V_.rows());
    u.real() = times(V_, size_, shapes_.col(static_cast<Index>(i)).real());
    u.imag() = times(V_, size_, shapes_.col(static_cast<Index>(i)).imag());
    return u;
  }
  /// The norm of a residual, that of M^-1, at most: that of D^-1 over the least eigenvalue of D^-1 M.
  [[nodiscard]] double norm_of(const VectorXcd& residual) const {
    return std::sqrt(residual.cwiseAbs2().dot(inverse_) / (M_ ? M_->least_share() : 1));
  }

  /// Keeps the first Ritz vectors alone, up to so many real ones.
  void restart(Index kept) {
    MatrixXd S(size_, kept + 1);
    Index count = 0;
    for (std::size_t i = 0; i < values_.size() && count < kept; ++i) {
      S.col(count++) = shapes_.col(static_cast<Index>(i)).real();
      if (values_[i].imag() != 0) S.col(count++) = shapes_.col(static_cast<Index>(i)).imag();
    }
    const MatrixXd Q = orthonormal_basis(S.leftCols(count));
    for (MatrixXd* vectors : {&V_, &MV_, &KV_, &CV_})
      vectors->leftCols(count) = (vectors->leftCols(size_) * Q).eval();
    for (MatrixXd* projected : {&k_of_V_, &c_of_V_})
      projected->topLeftCorner(count, count) =
          (Q.transpose() * (projected->topLeftCorner(size_, size_).selfadjointView<Eigen::Upper>() * Q))
              .eval();
    size_ = count;
  }

 private:
  [[nodiscard]] const MatrixXd& images_in_M() const { return M_ ? MV_ : V_; }

  /// The next column of A V and of V^T A V, its upper triangle.
  void project(const SymmetricProduct& A, const VectorXd& t, MatrixXd& images, MatrixXd& projected) {
    A(t, image_);
    images.col(size_) = image_;
    projected.col(size_).head(size_ + 1) = transposed_times(V_, size_ + 1, image_);
  }

  const SymmetricProduct &k_, &c_;
  const CoupledMass* M_;
  Index most_, size_ = 0;
  MatrixXd V_, MV_, KV_, CV_;
  MatrixXd k_of_V_, c_of_V_;  ///< their upper triangles
  VectorXd inverse_, image_;
  std::vector<Complex> values_, before_;
  MatrixXcd shapes_;  ///< in the space, one column for each value
};

/// The eigenvalues that have converged, the largest first, up to the first that has not; a pair of conjugates
/// has equal residuals, so both or none count.
DampedEigenvalues converged_of(const RitzSpectrum& ritz, const ScaledMatrices& matrices) {
  constexpr double krylov_tolerance = 1e-9;  // residual over modulus
  DampedEigenvalues result{.rest = std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < ritz.values.size(); ++i) {
    const Complex lambda = ritz.values[i].value;
    if (!(ritz.values[i].residual <= krylov_tolerance * std::abs(lambda))) break;
    result.lambda.push_back(lambda);
    result.rest = std::abs(lambda);
    const VectorXcd u = ritz.vector(i).head(matrices.size());
    result.shapes.push_back(matrices.mass.root_solve(VectorXcd(u.normalized())));
  }
  return result;
}

/// One eigenvalue or two need little room; more of them converge together only in a larger space, several at
/// a time.
struct Room {
  Index vectors, kept;
  std::size_t at_a_time;
};
constexpr Room for_few{24, 12, 1}, for_more{60, 30, 3};

}  // namespace

struct DampedSearch::State {
  explicit State(const ScaledMatrices& matrices) : space(matrices, for_more.vectors) {}

  QuadraticSpace space;
  Index starts = 0;
};

DampedSearch::DampedSearch(std::shared_ptr<const ScaledMatrices> matrices, const LargestEigenpair& k,
                           const LargestEigenpair& c)
    : matrices_(std::move(matrices)), state_(std::make_unique<State>(*matrices_)) {
  start();
  state_->space.add(k.vector);
  state_->space.add(c.vector);
}
DampedSearch::~DampedSearch() = default;

// Another vector in general position each time.
bool DampedSearch::start() {
  const Index n = matrices_->size();
  const VectorXd general = start_vector((state_->starts++ % 8 + 1) * n).tail(n);
  return state_->space.add(general.cwiseProduct(state_->space.inverse().cwiseSqrt()));
}

DampedEigenvalues DampedSearch::first(std::size_t most, Index most_products) {
  QuadraticSpace& space = state_->space;
  const Room room = most <= 2 ? for_few : for_more;
  std::size_t converged = 0;
  const auto has_enough = [&] {
    const std::vector<Complex>& values = space.values();
    return converged >= std::min(most, values.size()) ||
           (converged > 0 && std::abs(values[converged - 1]) <= deep_enough * std::abs(values.front()));
  };
  for (Index products = 0;;) {
    space.solve();
    // Vectors only come nearer: those that have converged are looked at again where one before them is new.
    std::vector<VectorXcd> directions;
    converged = space.same_as_before(converged);
    for (std::size_t i = converged;
         i < std::min(most, space.values().size()) && directions.size() < room.at_a_time; ++i) {
      VectorXcd r = space.residual(i);
      if (!(space.norm_of(r) <= tolerance * std::norm(space.values()[i])))
        directions.push_back(std::move(r));
      else if (directions.empty())
        ++converged;
    }
    if (has_enough() || products >= most_products) break;
    if (room.vectors < matrices_->size() &&
        space.size() + static_cast<Index>(2 * directions.size()) > room.vectors)
      space.restart(room.kept);
    const Index before = space.size();
    for (const VectorXcd& r : directions) {
      // In the phase in which most of r is real: r^T D^-1 r > 0. Little is imaginary where damping is small.
      const Complex square = r.cwiseProduct(r).dot(space.inverse());
      const VectorXcd turned =
          r * std::sqrt(square == 0.0 ? Complex(1) : std::abs(square) / std::conj(square));
      space.add(space.inverse().cwiseProduct(turned.real()));
      if (turned.imag().norm() > 0.1 * turned.real().norm())
        space.add(space.inverse().cwiseProduct(turned.imag()));
    }
    // Nothing new: the space is closed, and another start leads out of it, unless it is all there is.
    if (space.size() == before && !start()) break;
    products += space.size() - before;
  }
  return found(converged);
}

DampedEigenvalues DampedSearch::found(std::size_t count) const {
  const QuadraticSpace& space = state_->space;
  DampedEigenvalues result{.rest = std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < count; ++i) {
    Complex lambda = space.values()[i];
    // An undamped motion must not grow by rounding.
    if (lambda.real() > 0 && lambda.real() <= tolerance * std::abs(lambda)) lambda.real(0);
    result.lambda.push_back(lambda);
    result.shapes.push_back(matrices_->shape_of(space.vector(i)));
    if (lambda.imag() != 0) {
      result.lambda.push_back(std::conj(lambda));
      result.shapes.push_back(result.shapes.back().conjugate());
    }
    result.rest = std::abs(lambda);
  }
  return result;
}

// The companion form acts on x = (s u, lambda u), u = M^1/2 q: both of its off-diagonal blocks have about the
// norm s. Ritz values are looked at every thirty steps.
DampedEigenvalues many_damped_eigenvalues(const ScaledMatrices& matrices, const LargestEigenpair& k,
                                          const LargestEigenpair& c) {
  const Index n = matrices.size(), most = std::min<Index>(2 * n, 300), stride = 30;
  const double s = std::sqrt(std::max(k.bound, std::numeric_limits<double>::min()));
  VectorXd product(n);
  const LinearOperator companion = [&](const VectorXd& x) {
    VectorXd y(2 * n);
    y.head(n) = s * x.tail(n);
    matrices.k.apply(x.data(), product.data());
    y.tail(n) = -product / s;
    matrices.c.apply(x.data() + n, product.data());
    y.tail(n) -= product;
    return y;
  };
  // A vector in general position has next to nothing of the shape of a single damper.
  const VectorXd fast = matrices.mass.is_diagonal()
                            ? VectorXd(k.vector + c.vector)
                            : VectorXd(matrices.mass.root_times(VectorXd(k.vector + c.vector)));
  VectorXd start = start_vector(2 * n).normalized();
  start.head(n) += fast;
  start.tail(n) += fast;
  DampedEigenvalues result{.rest = std::numeric_limits<double>::infinity()};
  // A restart would keep all: there is none.
  visit_ritz_spectra(
      companion, start, {.basis = most, .kept = most, .most_products = most + stride, .conditions = false},
      stride, [&](const RitzSpectrum& ritz) {
        result = converged_of(ritz, matrices);
        return result.lambda.size() >= many_enough ||
               (!result.lambda.empty() && result.rest <= deep_enough * std::abs(result.lambda.front()));
      });
  return result;
}

// Without damping the first round gives the answer, sqrt(-kappa_min).
std::optional<double> growing_eigenvalue(const FindLargestOfSum& find, double most_k) {
  std::optional<double> lambda;
  for (int iteration = 0; iteration < 30; ++iteration) {
    // The least eigenvector of k + lambda c. The first round has lambda = 0: that of k.
    const LargestOfSum least = find(-lambda.value_or(0), -1, 1e-10);
    // No negative stiffness along it beyond rounding: nothing grows.
    if (!(least.kappa < -1e-9 * most_k)) return lambda;
    // -gamma/2 + sqrt(gamma^2/4 - kappa) without cancellation, kappa < 0.
    const double next =
        -2 * least.kappa / (least.gamma + std::sqrt(least.gamma * least.gamma - 4 * least.kappa));
    if (lambda && next <= *lambda * (1 + 1e-10)) return lambda;
    lambda = next;
  }
  return lambda;
}

}  // namespace hmax
