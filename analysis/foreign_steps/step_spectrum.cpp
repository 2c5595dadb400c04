#include "analysis/foreign_steps/step_spectrum.hpp"

#include <algorithm>
#include <cmath>
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

/// A motion in scaled coordinates as numbers of the state.
VectorXd on_state(const VectorXd& motion, const StateCoordinates& coordinates, const VectorXd& scale,
                  Index dim) {
  VectorXd numbers = VectorXd::Zero(dim);
  for (Index k = 0; k < motion.size(); ++k) {
    const Index i = coordinates.component(k);
    numbers[i] = std::max(numbers[i], std::abs(motion[k] * scale[k]));
  }
  const double largest = numbers.maxCoeff();
  return largest > 0 ? VectorXd(numbers / largest) : numbers;
}

/// How far a multiplier is off, |y^H (D x - J x)| / |y^H x| with differences D in the direction of its own
/// right eigenvector x: the error of the matrix as this eigenvalue has it, where the norm of that error says
/// too much.
double own_error(const StepDerivative& derivative, const MatrixXd& J, const Eigen::VectorXcd& x,
                 const Eigen::RowVectorXcd& y) {
  const VectorXd re = x.real(), im = x.imag();
  Eigen::VectorXcd off = (derivative.product(re) - J * re).cast<Complex>();
  off += Complex(0, 1) * (derivative.product(im) - J * im).cast<Complex>();
  return std::abs(Complex(y * off)) / std::abs(Complex(y * x));
}

/// All eigenvalues with their tolerances.
void by_eigenvalues(const MatrixXd& J, const StepDerivative& derivative, StepSpectrum& found,
                    VectorXd& motion) {
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
    const double tolerance = multiplier_tolerance(error, condition);
    const Complex value = pairs.values[i];
    // Of a pair the upper one; a negative number turns about in every step.
    if (value.imag() > 0 || (value.imag() == 0 && value.real() > 0))
      found.motions.push_back({.rate = std::log(value) / found.h,
                               .error = tolerance / std::abs(value - 1.0),
                               .shape = pairs.vectors.col(at)});
    const double excess = std::abs(value) - 1 - tolerance;
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

StepSpectrum spectrum_of_step(ForeignStepper& engine, const StateCoordinates& coordinates,
                              const VectorXd& scale, int slot, const VectorXd& y, double h,
                              StepPattern& pattern, const StepSpectrumSettings& settings) {
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
  std::int64_t products = 0;
  std::optional<Eigen::SparseMatrix<double>> J;
  if (pattern.pays()) J = derivative.grouped_matrix(pattern, told);
  // Entries below the error of the matrix are none.
  if (!J && n <= settings.matrix_to)
    J = derivative.matrix(pattern, told)
            .sparseView(1, n <= settings.eigenvalues_to ? 0 : derivative.error() / static_cast<double>(n));
  if (J && !VectorXd::Map(J->valuePtr(), J->nonZeros()).allFinite()) return broken;
  if (J && n <= settings.eigenvalues_to)
    by_eigenvalues(*J, derivative, found, motion);
  else
    by_products(
        [&](const VectorXd& v) {
          if (settings.watch && ++products % 16 == 0) settings.watch();
          return J ? VectorXd(*J * v) : derivative.product(v);
        },
        n, derivative, found, motion);
  found.motion = on_state(motion, coordinates, scale, engine.dim());
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
