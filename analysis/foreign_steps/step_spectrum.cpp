#include "analysis/foreign_steps/step_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include <Eigen/LU>
#include <Eigen/SparseCore>

#include "analysis/foreign_steps/step_derivative.hpp"
#include "analysis/foreign_steps/step_growth.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "core/dense_solvers.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// How far a multiplier is off, |y^H (D x - J x)| / |y^H x| with differences D in the direction of its own
/// right eigenvector x: the error of the matrix as this eigenvalue has it, where the norm of that error says
/// too much.
double own_error(const StepDerivative& derivative, const Eigen::VectorXcd& Jx, const Eigen::VectorXcd& x,
                 const Eigen::RowVectorXcd& y, double factor = 1) {
  Eigen::VectorXcd off = derivative.product(x.real(), factor).cast<Complex>() - Jx;
  if (x.imag().norm() > 0) off += Complex(0, 1) * derivative.product(x.imag(), factor).cast<Complex>();
  return std::abs(Complex(y * off)) / std::abs(Complex(y * x));
}

/// All eigenvalues with their tolerances.
class StepMultipliers {
 public:
  StepMultipliers(const MatrixXd& J, const StepDerivative& derivative, double creep)
      : derivative_(derivative), pairs_(J), creep_(creep) {
    if (!pairs_.values.empty()) left_ = pairs_.vectors.partialPivLu().inverse();
  }

  void judge(StepSpectrum& found, VectorXd& motion) const;

 private:
  [[nodiscard]] auto right(std::size_t i) const { return pairs_.vectors.col(static_cast<Index>(i)); }
  [[nodiscard]] auto left(std::size_t i) const { return left_.row(static_cast<Index>(i)); }
  [[nodiscard]] double excess(std::size_t i) const { return std::abs(pairs_.values[i]) - 1 - creep_; }
  [[nodiscard]] double error(std::size_t i, double factor) const {
    return own_error(derivative_, pairs_.values[i] * right(i), right(i), left(i), factor);
  }
  /// What larger and smaller increments make of it: growth that comes with the increment is that of
  /// differences.
  [[nodiscard]] double tolerance_by_increments(std::size_t i) const {
    return 4 * std::min(error(i, 0.3), error(i, 3));
  }
  void find_growing(const std::vector<double>& tolerances, StepSpectrum& found) const;

  const StepDerivative& derivative_;
  SortedEigenpairs pairs_;
  Eigen::MatrixXcd left_;
  double creep_;  ///< of a step
};

void StepMultipliers::find_growing(const std::vector<double>& tolerances, StepSpectrum& found) const {
  std::vector<std::size_t> order(tolerances.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto beyond = [&](std::size_t i) { return excess(i) - tolerances[i]; };
  std::ranges::stable_sort(order, std::greater{}, beyond);
  found.tolerance = tolerances[order.front()];
  constexpr std::size_t most = 8;
  const auto take = [&](std::size_t i, double tolerance) {
    found.grows = true;
    found.tolerance = tolerance;
    found.multiplier = pairs_.values[i];
  };
  for (std::size_t k = 0; k < std::min(most, order.size()) && beyond(order[k]) > 0; ++k) {
    const std::size_t i = order[k];
    const double tolerance = std::max(tolerances[i], tolerance_by_increments(i));
    if (excess(i) > tolerance) return take(i, tolerance);
    found.resolved = false;
    found.tolerance = std::max(found.tolerance, tolerance);
  }
  // Those that seem to grow but for the tolerance, by differences of their own.
  for (std::size_t i = 0; i < std::min<std::size_t>(3, order.size()) && excess(i) > 0.01; ++i) {
    const double tolerance = std::max(10 * error(i, 1), tolerance_by_increments(i));
    if (excess(i) > tolerance) return take(i, tolerance);
  }
}

void StepMultipliers::judge(StepSpectrum& found, VectorXd& motion) const {
  if (pairs_.values.empty()) {
    found.resolved = false;
    return;
  }
  std::vector<double> tolerances;
  for (std::size_t i = 0; i < pairs_.values.size(); ++i) {
    tolerances.push_back(multiplier_tolerance(derivative_.error(), left(i).norm() * right(i).norm()));
    const Complex value = pairs_.values[i];
    // Of a pair the upper one; a negative number turns about in every step.
    if (value.imag() > 0 || (value.imag() == 0 && value.real() > 0))
      found.motions.push_back({.rate = std::log(value) / found.h,
                               .error = tolerances[i] / std::abs(value - 1.0),
                               .shape = right(i)});
  }
  found.multiplier = pairs_.values.front();
  find_growing(tolerances, found);
  found.spectral_radius = std::abs(pairs_.values.front());
  const auto at = std::ranges::find(pairs_.values, found.multiplier) - pairs_.values.begin();
  motion = right(static_cast<std::size_t>(at)).cwiseAbs();
}

/// The largest multiplier by products.
void by_products(const LinearOperator& J, Index n, const StepDerivative& derivative, StepSpectrum& found,
                 VectorXd& motion) {
  const ProductGrowth growth =
      growth_of_products(J, n, {.error = derivative.error(), .error_along = [&](const VectorXd& v) {
                                  return derivative.error_along(v);
                                }});
  found.grows = growth.grows;
  found.resolved = growth.resolved;
  found.tolerance = growth.tolerance;
  found.multiplier = growth.multiplier;
  found.spectral_radius = std::abs(growth.multiplier);
  motion = growth.motion;
}

}  // namespace

VectorXd motion_on_state(const VectorXd& motion, const StateCoordinates& coordinates, const VectorXd& scale,
                         Index dim) {
  VectorXd numbers = VectorXd::Zero(dim);
  for (Index k = 0; k < motion.size(); ++k) {
    const Index i = coordinates.component(k);
    numbers[i] = std::max(numbers[i], std::abs(motion[k] * scale[k]));
  }
  const double largest = numbers.maxCoeff();
  return largest > 0 ? VectorXd(numbers / largest) : numbers;
}

StepSpectrum spectrum_of_step(ForeignStepper& engine, const StateCoordinates& coordinates,
                              const VectorXd& scale, int slot, const VectorXd& y, double h,
                              StepPattern& pattern, const StepSpectrumSettings& settings) {
  StepSpectrum broken{.h = h,
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
  std::int64_t products = 0;
  std::optional<Eigen::SparseMatrix<double>> J;
  if (pattern.pays()) J = derivative.grouped_matrix(pattern, told);
  // Entries below the error of the matrix are none.
  if (!J && n <= settings.matrix_to)
    J = derivative.matrix(pattern, told)
            .sparseView(1, n <= settings.eigenvalues_to ? 0 : derivative.error() / static_cast<double>(n));
  if (J && !VectorXd::Map(J->valuePtr(), J->nonZeros()).allFinite()) return broken;
  if (J && n <= settings.eigenvalues_to)
    StepMultipliers(*J, derivative, settings.creep * h).judge(found, motion);
  else
    by_products(
        [&](const VectorXd& v) {
          if (settings.watch && ++products % 16 == 0) settings.watch();
          return J ? VectorXd(*J * v) : derivative.product(v);
        },
        n, derivative, found, motion);
  if (found.grows && !(found.spectral_radius > 1 + settings.creep * h)) found.grows = false;
  found.motion = motion_on_state(motion, coordinates, scale, engine.dim());
  return found;
}

bool is_growth_of_model(const StepSpectrum& a, const StepSpectrum& b) {
  constexpr double slow = 0.5, alike = 0.2;
  const auto rate = [](const StepSpectrum& row) { return std::log(std::abs(row.multiplier)) / row.h; };
  return a.grows && b.grows && std::abs(std::arg(a.multiplier)) < slow &&
         std::abs(std::arg(b.multiplier)) < slow && std::abs(rate(a) - rate(b)) < alike * rate(a);
}

double growth_along_motion(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale,
                           int slot, int work, double h, std::int64_t steps, double increment,
                           const std::function<void()>& watch) {
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
