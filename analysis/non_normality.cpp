#include "analysis/non_normality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <vector>

#include <Eigen/Eigenvalues>

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
constexpr double infinity = std::numeric_limits<double>::infinity();

double largest_symmetric_eigenvalue(const MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

/// sigma_min(z I - T) of an upper triangular T.
class SmallestSingularValue {
 public:
  explicit SmallestSingularValue(MatrixXcd triangular) : T_(std::move(triangular)), start_(T_.rows()) {
    for (Index i = 0; i < start_.size(); ++i)
      start_[i] =
          Complex(1 + std::sin(1.0 + 2.4 * static_cast<double>(i)), std::cos(3.1 * static_cast<double>(i)));
    start_.normalize();
  }

  /// How many a search may take: about a second at most.
  [[nodiscard]] int affordable() const { return T_.rows() <= 16 ? 20000 : 3000; }

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

/// Where a Kreiss constant is looked for: z(a, b), where a > 0 is what the norm of the resolvent is
/// multiplied with. a + i b for differential equations, (1 + a) e^(i b) for steps.
struct Plane {
  bool polar = false;

  [[nodiscard]] Complex z(double a, double b) const { return polar ? std::polar(1 + a, b) : Complex(a, b); }
  [[nodiscard]] double circumference(double a) const { return polar ? 1 + a : 1; }  // dz / db
};

struct Box {
  double a0, a1, b0, b1, bound;
  /// The most promising first; of equals, and that is of those nothing is known of yet, the largest.
  bool operator<(const Box& other) const {
    return bound != other.bound ? bound < other.bound : a1 - a0 < other.a1 - other.a0;
  }
};

/// Branch and bound for sup a / sigma(z(a, b)).
class KreissSearch {
 public:
  static constexpr double within = 1e-2;

  /// @param growth  sigma >= a - growth everywhere, growth > 0
  /// @param least   boxes of this size are not split
  KreissSearch(SmallestSingularValue& sigma, Plane plane, double growth, double least)
      : sigma_(sigma), plane_(plane), growth_(growth), least_(least) {}

  void look_at(double a, double b) {
    if (a > 0) (void)value(a, b);
  }

  KreissConstant run(double b_end) {
    // Beyond this a / (a - growth) is at most 1 + within, and 1 is reached at infinity.
    const double a_end = growth_ * (1 + within) / within;
    push({0, a_end, 0, b_end, 0});
    double bound = 0;
    for (int split = 0; !queue_.empty(); ++split) {
      const Box box = queue_.top();
      if (box.bound <= best_.value * (1 + within)) break;
      if (split == sigma_.affordable()) {
        bound = box.bound;
        break;
      }
      queue_.pop();
      const double height = plane_.circumference(box.a1) * (box.b1 - box.b0), width = box.a1 - box.a0;
      if (std::max(height, width) < least_) continue;
      Box low = box, high = box;
      if (width > height)
        low.a1 = high.a0 = (box.a0 + box.a1) / 2;
      else
        low.b1 = high.b0 = (box.b0 + box.b1) / 2;
      push(low);
      push(high);
    }
    climb();
    best_.bound = bound > 0 ? std::max(best_.value, bound) : best_.value * (1 + within);
    return best_;
  }

 private:
  double value(double a, double b) {
    const Complex z = plane_.z(a, b);
    const double sigma = sigma_(z);
    const double found = sigma > 0 ? a / sigma : infinity;
    if (found > best_.value) {
      best_.value = found;
      best_.at = z;
      a_ = a;
      b_ = b;
    }
    return sigma;
  }

  void push(Box box) {
    const double a = (box.a0 + box.a1) / 2, b = (box.b0 + box.b1) / 2;
    const double reach = std::hypot(box.a1 - box.a0, plane_.circumference(box.a1) * (box.b1 - box.b0)) / 2;
    const double sigma = value(a, b);
    box.bound = sigma > reach ? box.a1 / (sigma - reach) : infinity;
    if (box.a0 > growth_) box.bound = std::min(box.bound, box.a0 / (box.a0 - growth_));
    queue_.push(box);
  }

  /// Up from the best point, step by step along both coordinates and their diagonals.
  void climb() {
    if (!(a_ > 0) || !std::isfinite(best_.value)) return;
    double step = 0.3;
    while (step > 1e-9) {
      const double before = best_.value, a = a_, b = b_, side = step * a / plane_.circumference(a);
      for (const double da : {-1.0, 0.0, 1.0})
        for (const double db : {-1.0, 0.0, 1.0})
          if (da != 0 || db != 0) (void)value(a * (1 + da * step / (1 + step)), b + db * side);
      if (!(best_.value > before * (1 + 1e-15))) step /= 2;
    }
  }

  SmallestSingularValue& sigma_;
  Plane plane_;
  double growth_, least_;
  double a_ = 0, b_ = 0;
  KreissConstant best_{.value = 1, .bound = 1, .at = infinity};
  std::priority_queue<Box> queue_;
};

constexpr KreissConstant unbounded{.value = infinity, .bound = infinity, .at = {}};

/// Growth that only an eigenvalue of several on the axis itself can make.
KreissConstant judged(const KreissConstant& found, double distance, double scale) {
  return distance < 1e-6 * scale && found.value > 1e6 ? unbounded : found;
}

}  // namespace

NonNormality non_normality(const MatrixXd& J) {
  if (J.rows() == 0) return {};
  const MatrixXcd T = Eigen::ComplexSchur<MatrixXd>(J, false).matrixT();
  NonNormality result;
  result.departure = MatrixXcd(T.triangularView<Eigen::StrictlyUpper>()).norm();
  const double size = J.norm();
  result.relative_departure = size > 0 ? result.departure / size : 0;
  result.spectral_abscissa = T.diagonal().real().maxCoeff();
  result.numerical_abscissa = largest_symmetric_eigenvalue((J + J.transpose()) / 2);
  return result;
}

KreissConstant kreiss_constant(const MatrixXd& J) {
  const double scale = J.norm();
  if (scale == 0) return {.value = 1, .bound = 1, .at = infinity};
  const MatrixXcd T = Eigen::ComplexSchur<MatrixXd>(J, false).matrixT();
  if (T.diagonal().real().maxCoeff() > 1e-10 * scale) return unbounded;
  const double growth = largest_symmetric_eigenvalue((J + J.transpose()) / 2);
  if (growth <= 1e-13 * scale) return {.value = 1, .bound = 1, .at = infinity};
  SmallestSingularValue sigma(T);
  KreissSearch search(sigma, {}, growth, 1e-9 * scale);
  for (const Complex& lambda : T.diagonal())
    for (const double a :
         {-lambda.real() / 3, -lambda.real(), -3 * lambda.real(), growth / 10, growth, 10 * growth})
      search.look_at(a, std::abs(lambda.imag()));
  // |z - w| for the nearest point w of the field of values bounds sigma from below: beyond the largest height
  // of the field and the largest a nothing above 1 is left.
  const Eigen::MatrixXcd skew = Complex(0, -0.5) * (J - J.transpose()).cast<Complex>();
  const double height =
      Eigen::SelfAdjointEigenSolver<MatrixXcd>(skew, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
  const KreissConstant found =
      search.run(height + growth * (1 + KreissSearch::within) / KreissSearch::within);
  return judged(found, found.at.real(), scale);
}

KreissConstant kreiss_constant_of_step(const MatrixXd& A) {
  const MatrixXcd T = Eigen::ComplexSchur<MatrixXd>(A, false).matrixT();
  if (T.diagonal().cwiseAbs().maxCoeff() > 1 + 1e-10) return unbounded;
  const double size = std::sqrt(std::max(0.0, largest_symmetric_eigenvalue(A.transpose() * A)));
  if (size <= 1 + 1e-13) return {.value = 1, .bound = 1, .at = infinity};
  SmallestSingularValue sigma(T);
  KreissSearch search(sigma, {.polar = true}, size - 1, 1e-9);
  for (const Complex& lambda : T.diagonal())
    for (const double a : {(1 - std::abs(lambda)) / 3, 1 - std::abs(lambda), 0.1, 0.5, 1.0})
      search.look_at(a, std::abs(std::arg(lambda)));
  const KreissConstant found = search.run(std::numbers::pi);
  return judged(found, std::abs(found.at) - 1, 1);
}

EnergyCoordinates energy_coordinates(const MechanicalPart& part) {
  const Index n = part.mass.size();
  const VectorXd root = part.mass.cwiseSqrt();
  const MatrixXd k = root.cwiseInverse().asDiagonal() * dense(part.K) * root.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver((k + k.transpose()) / 2);
  const VectorXd sizes = solver.eigenvalues().cwiseAbs();
  const double least = sizes.maxCoeff() > 0 ? 1e-12 * sizes.maxCoeff() : 1;
  const VectorXd w = sizes.cwiseMax(least).cwiseSqrt();
  const MatrixXd& u = solver.eigenvectors();
  EnergyCoordinates result{MatrixXd::Zero(2 * n, 2 * n), MatrixXd::Zero(2 * n, 2 * n)};
  const MatrixXd velocities = u.transpose() * root.asDiagonal();
  const MatrixXd back = root.cwiseInverse().asDiagonal() * u;
  result.to.topLeftCorner(n, n) = w.asDiagonal() * velocities;
  result.to.bottomRightCorner(n, n) = velocities;
  result.from.topLeftCorner(n, n) = back * w.cwiseInverse().asDiagonal();
  result.from.bottomRightCorner(n, n) = back;
  return result;
}

MatrixXd jacobian_in_energy_coordinates(const LinearModel& model) {
  if (!model.mechanical) return dense(model.J);
  const EnergyCoordinates energy = energy_coordinates(*model.mechanical);
  return energy.to * dense(model.J) * energy.from;
}

}  // namespace hmax
