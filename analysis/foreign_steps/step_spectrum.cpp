#include "analysis/foreign_steps/step_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/LU>
#include <Eigen/SparseCore>

#include "analysis/foreign_steps/step_derivative.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "analysis/step_limits/step_map_limit.hpp"
#include "core/dense_solvers.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Growth of less is no growth, however exact the differences are.
constexpr double least_tolerance = 1e-9;

/// A motion in scaled coordinates as numbers of the state.
VectorXd on_state(const VectorXd& motion, const StateCoordinates& coordinates, const VectorXd& scale, Index dim) {
  VectorXd numbers = VectorXd::Zero(dim);
  for (Index k = 0; k < motion.size(); ++k) {
    const Index i = coordinates.component(k);
    numbers[i] = std::max(numbers[i], std::abs(motion[k] * scale[k]));
  }
  const double largest = numbers.maxCoeff();
  return largest > 0 ? VectorXd(numbers / largest) : numbers;
}

/// How far a multiplier is off, |y^H (D x - J x)| / |y^H x| with differences D in the direction of its own right eigenvector x:
/// the error of the matrix as this eigenvalue has it, where the norm of that error says too much.
double own_error(const StepDerivative& derivative, const MatrixXd& J, const Eigen::VectorXcd& x, const Eigen::RowVectorXcd& y) {
  const VectorXd re = x.real(), im = x.imag();
  Eigen::VectorXcd off = (derivative.product(re) - J * re).cast<Complex>();
  off += Complex(0, 1) * (derivative.product(im) - J * im).cast<Complex>();
  return std::abs(Complex(y * off)) / std::abs(Complex(y * x));
}

/// All eigenvalues with their tolerances.
void by_eigenvalues(const MatrixXd& J, const StepDerivative& derivative, StepSpectrum& found, VectorXd& motion) {
  const double error = derivative.error();
  const SortedEigenpairs pairs(J);
  if (pairs.values.empty()) {
    found.resolved = false;
    return;
  }
  const Eigen::MatrixXcd left = pairs.vectors.partialPivLu().inverse();
  double most = -infinity;
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < pairs.values.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const double condition = left.row(at).norm() * pairs.vectors.col(at).norm();
    const double defective = 4 * std::sqrt(error);
    const double tolerance =
        least_tolerance + (std::isfinite(condition) ? std::min(4 * error * condition, defective) : defective);
    const double excess = std::abs(pairs.values[i]) - 1 - tolerance;
    if (excess > most) {
      most = excess;
      chosen = i;
      found.tolerance = tolerance;
    }
  }
  found.grows = most > 0;
  // Those that seem to grow but for the tolerance, by differences of their own.
  for (std::size_t i = 0; !found.grows && i < std::min<std::size_t>(3, pairs.values.size()); ++i) {
    const auto at = static_cast<Index>(i);
    const double excess = std::abs(pairs.values[i]) - 1;
    if (!(excess > 0.01)) break;
    const double tolerance = 10 * own_error(derivative, J, pairs.vectors.col(at), left.row(at));
    if (!(excess > tolerance)) continue;
    found.grows = true;
    found.tolerance = tolerance;
    chosen = i;
  }
  if (!found.grows) chosen = 0;
  found.multiplier = pairs.values[chosen];
  found.spectral_radius = std::abs(pairs.values.front());
  const Eigen::VectorXcd vector = pairs.vectors.col(static_cast<Index>(chosen));
  motion = vector.cwiseAbs();
}

/// The multiplier of a motion w in a plane that J maps to itself: J^2 w = a J w + b w, mu^2 = a mu + b.
Complex multiplier_of(const std::function<VectorXd(const VectorXd&)>& J, const VectorXd& w) {
  const VectorXd w1 = J(w), w2 = J(w1);
  const double c = w.dot(w1) / w.squaredNorm();
  if ((w1 - c * w).norm() < 1e-4 * w1.norm()) return c;
  Eigen::Matrix2d normal;
  normal << w1.dot(w1), w1.dot(w), w1.dot(w), w.dot(w);
  const Eigen::Vector2d ab = normal.inverse() * Eigen::Vector2d(w1.dot(w2), w.dot(w2));
  const Complex root = std::sqrt(Complex(ab[0] * ab[0] / 4 + ab[1]));
  const Complex one = ab[0] / 2 + root, other = ab[0] / 2 - root;
  return std::abs(one) >= std::abs(other) ? one : other;
}

/// Steps as products, one after the other.
StepMap repeated(std::function<VectorXd(const VectorXd&)> J, std::function<void()> watch) {
  return [J = std::move(J), watch = std::move(watch)](const VectorXd& v, int steps) {
    VectorXd w = v;
    for (int i = 0; i < steps && w.allFinite(); ++i) w = J(w);
    if (watch) watch();
    return w;
  };
}

/// Steps as products with J^(2^k), which are made when they are first asked for.
class MatrixPowers {
 public:
  explicit MatrixPowers(MatrixXd J) : powers_{std::move(J)} {}
  VectorXd operator()(const VectorXd& v, int steps) {
    VectorXd w = v;
    for (std::size_t k = 0; steps > 0; ++k, steps /= 2) {
      if (k == powers_.size()) powers_.push_back(powers_.back() * powers_.back());
      if (steps % 2 == 1) w = powers_[k] * w;
    }
    return w;
  }

 private:
  std::vector<MatrixXd> powers_;
};

/// Steps as products with a matrix: most engines couple neighbours alone.
StepMap products_with(const Eigen::SparseMatrix<double>& J) {
  const auto n = static_cast<double>(J.rows());
  if (static_cast<double>(J.nonZeros()) > 0.1 * n * n) return MatrixPowers(J);
  return repeated([J](const VectorXd& v) { return VectorXd(J * v); }, {});
}

/// The largest multiplier by products.
void by_products(const StepMap& map, Index n, double error, StepSpectrum& found, VectorXd& motion) {
  found.tolerance = std::max(1e-6, 40 * error);
  const StepGrowth growth =
      growth_of_steps(map, start_vector(n), {.weak_growth = std::log1p(found.tolerance), .dense_to = 0});
  found.grows = growth.grows;
  found.resolved = growth.resolved;
  motion = growth.motion.cwiseAbs();
  const auto J = [&](const VectorXd& v) { return map(v, 1); };
  found.multiplier = multiplier_of(J, growth.motion);
  found.spectral_radius = std::exp(growth.rate);
  // Of a motion that is not that of one pair the sign is all that is known.
  const double size = std::abs(found.multiplier);
  if (!(std::abs(size - found.spectral_radius) < 1e-3 * found.spectral_radius))
    found.multiplier = std::copysign(found.spectral_radius, growth.motion.dot(J(growth.motion)));
}

}  // namespace

StepSpectrum spectrum_of_step(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale, int slot,
                              const VectorXd& y, double h, StepPattern& pattern, const StepSpectrumSettings& settings) {
  const StepSpectrum broken{.h = h,
                            .spectral_radius = infinity,
                            .multiplier = infinity,
                            .grows = true,
                            .motion = VectorXd::Zero(engine.dim())};
  StepDerivative derivative(engine, coordinates, scale, slot, y, h);
  if (!derivative.is_finite() || !std::isfinite(derivative.error())) return broken;
  const Index n = coordinates.size();
  StepSpectrum found;
  found.h = h;
  found.increment = derivative.increment();
  VectorXd motion = VectorXd::Zero(n);
  const auto told = [&](double) {
    if (settings.watch) settings.watch();
  };
  std::optional<Eigen::SparseMatrix<double>> J;
  if (pattern.pays()) J = derivative.grouped_matrix(pattern, told);
  // Entries below the error of the matrix are none.
  if (!J && n <= settings.matrix_to)
    J = derivative.matrix(pattern, told).sparseView(1, n <= settings.eigenvalues_to ? 0 : derivative.error() / static_cast<double>(n));
  if (J && !VectorXd::Map(J->valuePtr(), J->nonZeros()).allFinite()) return broken;
  if (J && n <= settings.eigenvalues_to)
    by_eigenvalues(*J, derivative, found, motion);
  else
    by_products(J ? products_with(*J) : repeated([&](const VectorXd& v) { return derivative.product(v); }, settings.watch), n,
                derivative.error(), found, motion);
  found.motion = on_state(motion, coordinates, scale, engine.dim());
  return found;
}

double growth_along_motion(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale, int slot,
                           int work, double h, std::int64_t steps, double increment, const std::function<void()>& watch) {
  VectorXd v = start_vector(coordinates.size());
  double growth = 0;
  // Far away neighbours are one state to rounding, and their difference is zero.
  engine.restore(slot);
  const double far = 1e6 * std::max(engine.state().cwiseAbs().maxCoeff(), scale.maxCoeff());
  for (int pass = 0; pass < 2; ++pass) {
    growth = 0;
    engine.restore(slot);
    engine.save(work);
    VectorXd y = engine.state();
    for (std::int64_t i = 0; i < steps; ++i) {
      v /= v.cwiseAbs().maxCoeff();
      const VectorXd x = increment * v.cwiseProduct(scale);
      const VectorXd ahead = engine.after(work, coordinates.at(y, x), h, 1);
      const VectorXd behind = engine.after(work, coordinates.at(y, -x), h, 1);
      y = engine.advance(work, h);
      const VectorXd next =
          (coordinates.of(y, ahead) - coordinates.of(y, behind)).cwiseQuotient(2 * increment * scale);
      if (!next.allFinite() || !(y.cwiseAbs().maxCoeff() < far)) return infinity;
      const double size = next.norm();
      if (!(size > 0)) return -infinity;
      growth += std::log(size / v.norm());
      v = next;
      if (watch && i % 64 == 0) watch();
    }
  }
  return growth;
}

}  // namespace hmax
