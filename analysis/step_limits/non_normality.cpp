#include "analysis/step_limits/non_normality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "core/dense_solvers.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// sigma_min(z I - T) of an upper triangular T.
class SmallestSingularValue {
 public:
  explicit SmallestSingularValue(MatrixXcd triangular) : T_(std::move(triangular)), start_(T_.rows()) {
    for (Index i = 0; i < start_.size(); ++i)
      start_[i] =
          Complex(1 + std::sin(1.0 + 2.4 * static_cast<double>(i)), std::cos(3.1 * static_cast<double>(i)));
    start_.normalize();
  }

  double operator()(Complex z) {
    if (T_.rows() == 1) return std::abs(z - T_(0, 0));
    if (T_.rows() == 2) {
      // s1 s2 = |det|, s1^2 + s2^2 = |A|_F^2: s1 + s2 and s1 - s2 are roots, s2 follows from the product.
      const double det = std::abs((z - T_(0, 0)) * (z - T_(1, 1)));
      const double square = std::norm(z - T_(0, 0)) + std::norm(z - T_(1, 1)) + std::norm(T_(0, 1));
      const double larger = (std::sqrt(square + 2 * det) + std::sqrt(std::max(0.0, square - 2 * det))) / 2;
      return larger > 0 ? det / larger : 0;
    }
    A_ = -T_;
    A_.diagonal().array() += z;
    if (A_.diagonal().cwiseAbs().minCoeff() < std::numeric_limits<double>::min()) return 0;
    return lanczos();
  }

 private:
  /// The largest eigenvalue 1 / sigma^2 of (A^H A)^-1, by Lanczos iteration with full orthogonalisation.
  double lanczos() {
    const Index n = T_.rows(), most = std::min<Index>(n, 60);
    const auto upper = A_.triangularView<Eigen::Upper>();
    std::vector<VectorXcd> basis{start_};
    std::vector<double> alpha, beta;
    double ritz = 0;
    for (Index k = 0; k < most; ++k) {
      VectorXcd w = upper.adjoint().solve(basis.back());
      w = upper.solve(w).eval();
      if (!w.allFinite()) return 0;
      alpha.push_back(basis.back().dot(w).real());
      for (int twice = 0; twice < 2; ++twice)
        for (const VectorXcd& v : basis) w -= v.dot(w) * v;
      const auto size = static_cast<Index>(alpha.size());
      Eigen::SelfAdjointEigenSolver<MatrixXd> small;
      small.computeFromTridiagonal(Eigen::Map<VectorXd>(alpha.data(), size),
                                   Eigen::Map<VectorXd>(beta.data(), size - 1), Eigen::EigenvaluesOnly);
      const double now = small.eigenvalues().maxCoeff();
      const double rest = w.norm();
      if ((k > 1 && now - ritz <= 1e-10 * now) || rest <= 1e-14 * now) return 1 / std::sqrt(now);
      ritz = now;
      beta.push_back(rest);
      basis.push_back(w / rest);
    }
    return 1 / std::sqrt(ritz);
  }

  MatrixXcd T_, A_;
  VectorXcd start_;
};

/// Every b >= 0, and more, where (a + i b) I - J has the singular value e. With (z I - J) u = e v and its
/// adjoint for v, (J - a I, e I; -e I, a I - J^T) (u, v) = i b (u, v) [boyd1989bisection].
std::vector<double> crossings(const MatrixXd& J, double a, double e) {
  const Index n = J.rows();
  const auto one = MatrixXd::Identity(n, n);
  MatrixXd hamiltonian(2 * n, 2 * n);
  hamiltonian << J - a * one, e * one, -e * one, a * one - J.transpose();
  const Eigen::EigenSolver<MatrixXd> solver(hamiltonian, false);
  const double near = 1e-5 * hamiltonian.norm();
  std::vector<double> found;
  for (const Complex& w : solver.eigenvalues())
    if (std::abs(w.real()) <= near) found.push_back(std::abs(w.imag()));
  return found;
}

/// An interval of a and the most that a |(z I - J)^-1| can be in it.
struct BoundedInterval {
  double a0, a1, log_norm0, log_norm1, bound;
  bool operator<(const BoundedInterval& other) const { return bound < other.bound; }
};

/// sup of a N(a), N(a) the largest norm of the resolvent on the line Re z = a.
class KreissSearch {
 public:
  static constexpr double within = 1e-4;

  /// @param growth  |(z I - J)^-1| <= 1 / (a - growth) where a > growth > 0
  KreissSearch(const MatrixXd& J, const MatrixXcd& schur, double growth)
      : J_(J), sigma_(schur), growth_(growth) {
    starts_.push_back(0);
    for (const Complex& lambda : schur.diagonal()) starts_.push_back(std::abs(lambda.imag()));
  }

  /// @param least  the smallest a that is looked at
  KreissConstant run(double least) {
    // Beyond, a / (a - growth) is at most 1 + within, and 1 is reached at infinity.
    const double most = growth_ * (1 + within) / within;
    double a0 = least, norm0 = log_norm(least);
    while (a0 < most) {
      const double a1 = std::min(most, a0 * 10), norm1 = log_norm(a1);
      push({a0, a1, norm0, norm1, 0});
      a0 = a1;
      norm0 = norm1;
    }
    climb();
    double bound = 0;
    while (queue_.top().bound > best_.value * (1 + within)) {
      const BoundedInterval top = queue_.top();
      bound = top.bound;
      if (++splits_ > most_splits) break;
      queue_.pop();
      const double middle = std::sqrt(top.a0 * top.a1), norm = log_norm(middle);
      push({top.a0, middle, top.log_norm0, norm, 0});
      push({middle, top.a1, norm, top.log_norm1, 0});
    }
    climb();
    best_.bound = splits_ > most_splits ? std::max(bound, best_.value) : best_.value * (1 + within);
    return best_;
  }

 private:
  static constexpr int most_splits = 300;

  double norm(double a, double b) {
    const double sigma = sigma_({a, b}), found = sigma > 0 ? 1 / sigma : infinity;
    if (a * found > best_.value) {
      best_.value = a * found;
      best_.at = {a, b};
    }
    return found;
  }

  /// log N(a): from the largest norm so far to the places where a larger one is met, and between them, until
  /// there are none.
  double log_norm(double a) {
    double most = 0;
    for (const double b : starts_) most = std::max(most, norm(a, b));
    for (int round = 0; round < 40 && std::isfinite(most); ++round) {
      std::vector<double> places = crossings(J_, a, 1 / (most * (1 + 1e-7)));
      places.push_back(0);
      std::ranges::sort(places);
      double larger = most;
      for (std::size_t i = 0; i < places.size(); ++i) {
        larger = std::max(larger, norm(a, places[i]));
        if (i > 0) larger = std::max(larger, norm(a, (places[i - 1] + places[i]) / 2));
      }
      if (!(larger > most * (1 + 1e-7))) break;
      most = larger;
    }
    return std::log(most * (1 + 1e-7));
  }

  /// On a chord of the convex log N the largest a N is at an end, or where both slopes cancel.
  void push(BoundedInterval interval) {
    const double slope = (interval.log_norm1 - interval.log_norm0) / (interval.a1 - interval.a0);
    const double peak = -1 / slope;
    const auto on_chord = [&](double a) {
      return a * std::exp(interval.log_norm0 + slope * (a - interval.a0));
    };
    interval.bound = std::max(on_chord(interval.a0), on_chord(interval.a1));
    if (peak > interval.a0 && peak < interval.a1) interval.bound = std::max(interval.bound, on_chord(peak));
    if (interval.a0 > growth_)
      interval.bound = std::min(interval.bound, interval.a0 / (interval.a0 - growth_));
    queue_.push(interval);
  }

  /// Up from the best point, step by step along both coordinates and their diagonals.
  void climb() {
    if (!std::isfinite(best_.at.real()) || !std::isfinite(best_.value)) return;
    double step = 0.3;
    while (step > 1e-9) {
      const double before = best_.value, a = best_.at.real(), b = best_.at.imag();
      for (const double da : {-1.0, 0.0, 1.0})
        for (const double db : {-1.0, 0.0, 1.0})
          if (da != 0 || db != 0) (void)norm(a * (1 + da * step / (1 + step)), b + db * step * a);
      if (!(best_.value > before * (1 + 1e-15))) step /= 2;
    }
  }

  const MatrixXd& J_;
  SmallestSingularValue sigma_;
  double growth_;
  std::vector<double> starts_;
  int splits_ = 0;
  KreissConstant best_{.value = 1, .bound = 1, .at = infinity};
  std::priority_queue<BoundedInterval> queue_;
};

constexpr KreissConstant infinite_constant{.value = infinity, .bound = infinity};

}  // namespace

NonNormality non_normality(const MatrixXd& J) {
  if (J.rows() == 0) return {};
  const MatrixXcd T = Eigen::ComplexSchur<MatrixXd>(J, false).matrixT();
  NonNormality result;
  result.departure = MatrixXcd(T.triangularView<Eigen::StrictlyUpper>()).norm();
  const double size = J.norm();
  result.relative_departure = size > 0 ? result.departure / size : 0;
  result.spectral_abscissa = T.diagonal().real().maxCoeff();
  result.numerical_abscissa = largest_eigenvalue_of((J + J.transpose()) / 2);
  return result;
}

KreissConstant kreiss_constant(const MatrixXd& J) {
  const double scale = J.norm();
  if (scale == 0) return {.value = 1, .bound = 1, .at = infinity};
  const MatrixXcd T = Eigen::ComplexSchur<MatrixXd>(J, false).matrixT();
  if (T.diagonal().real().maxCoeff() > 1e-10 * scale) return infinite_constant;
  const double growth = largest_eigenvalue_of((J + J.transpose()) / 2);
  if (growth <= 1e-13 * scale) return {.value = 1, .bound = 1, .at = infinity};
  const KreissConstant found = KreissSearch(J, T, growth).run(std::min(1e-9 * scale, growth));
  // Growth that only an eigenvalue of several on the axis itself can make.
  return found.at.real() < 1e-6 * scale && found.value > 1e6 ? infinite_constant : found;
}

EnergyCoordinates energy_coordinates(const MechanicalPart& part) {
  const Index n = part.mass.size();
  const MatrixXd k = mass_scaled(part.mass, part.K);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(MatrixXd((k + k.transpose()) / 2));
  const VectorXd sizes = solver.eigenvalues().cwiseAbs();
  const double least = sizes.maxCoeff() > 0 ? 1e-12 * sizes.maxCoeff() : 1;
  const VectorXd w = sizes.cwiseMax(least).cwiseSqrt();
  const MatrixXd& u = solver.eigenvectors();
  EnergyCoordinates result{MatrixXd::Zero(2 * n, 2 * n), MatrixXd::Zero(2 * n, 2 * n)};
  // u^T R and R^-1 u with M = R^T R; u is orthogonal.
  const MatrixXd velocities = u.transpose() * part.mass.root_times(MatrixXd(MatrixXd::Identity(n, n)));
  const MatrixXd back = part.mass.root_solve(u);
  result.to.topLeftCorner(n, n) = w.asDiagonal() * velocities;
  result.to.bottomRightCorner(n, n) = velocities;
  result.from.topLeftCorner(n, n) = back * w.cwiseInverse().asDiagonal();
  result.from.bottomRightCorner(n, n) = back;
  return result;
}

MatrixXd jacobian_in_energy_coordinates(const LinearModel& model) {
  if (!model.mechanical) return dense(model.J());
  const EnergyCoordinates energy = energy_coordinates(*model.mechanical);
  return energy.to * dense(model.J()) * energy.from;
}

}  // namespace hmax
