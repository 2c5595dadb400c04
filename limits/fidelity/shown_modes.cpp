#include "limits/fidelity/shown_modes.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "analysis/spectrum/arnoldi.hpp"

namespace hmax {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// States in units in which |x|^2 is the energy of a mode of frequency `omega`: (omega sqrt(M) q, sqrt(M) v).
struct EnergyUnits {
  VectorXd scale;  ///< shape (2 dofs)
  EnergyUnits(const VectorXd& mass, double omega) : scale(2 * mass.size()) {
    scale << omega * mass.cwiseSqrt(), mass.cwiseSqrt();
  }
};

/// What a Ritz vector in energy units has of a shape, relative to all of its displacement.
double likeness(const VectorXcd& x, const VectorXd& shape, const VectorXd& mass) {
  const VectorXcd q = x.head(mass.size());
  return std::abs(q.cwiseProduct(mass.cwiseSqrt().cast<std::complex<double>>())
                      .dot(shape.cast<std::complex<double>>())) /
         q.norm();
}

}  // namespace

StepModes shown_modes(const VectorFunction& step, const VectorXd& q, double h, const VectorXd& mass,
                      const MatrixXd& shapes, std::vector<ShownMode> of_model,
                      const std::function<void()>& watch) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  StepModes shown{.modes = std::move(of_model)};
  std::vector<ShownMode>& modes = shown.modes;
  for (ShownMode& mode : modes) mode.omega_shown = mode.zeta_shown = nan;
  if (modes.empty()) return shown;
  const Eigen::Index n = q.size();
  const EnergyUnits units(mass, modes.front().omega);
  VectorXd y = VectorXd::Zero(2 * n);
  y.head(n) = q;
  // Displacements of a ten-thousandth of the settled ones: large beside rounding, small beside curvature.
  const double size = 1e-4 * units.scale.head(n).cwiseProduct(q).norm();
  const LinearOperator A = [&](const VectorXd& x) -> VectorXd {
    if (watch) watch();
    const double length = x.norm();
    if (!(length > 0)) return VectorXd::Zero(2 * n);
    const VectorXd d = size / length * x.cwiseQuotient(units.scale);
    return length / (2 * size) * (step(y + d) - step(y - d)).cwiseProduct(units.scale);
  };
  VectorXd start = VectorXd::Zero(2 * n);
  for (Eigen::Index k = 0; k < shapes.cols(); ++k)
    start.head(n) += units.scale.head(n).cwiseProduct(shapes.col(k));

  const VectorXd other = start.reverse(), together = A(start + other), sum = A(start) + A(other);
  if (!((together - sum).norm() <= 0.01 * together.norm())) {
    shown.linear = false;
    return shown;
  }

  ArnoldiSettings settings;
  settings.basis = std::min<Eigen::Index>(80, 2 * n);
  settings.kept = std::min<Eigen::Index>(40, std::max<Eigen::Index>(1, settings.basis / 2));
  settings.most_products = 1200;
  visit_ritz_spectra(A, start, settings, 20, [&](const RitzSpectrum& found) {
    if (found.values.front().residual < 1e-3) shown.largest = std::abs(found.values.front().value);
    std::vector<double> left(modes.size(), 1);
    for (ShownMode& mode : modes) mode.likeness = 0;
    for (std::size_t i = 0; i < found.values.size(); ++i) {
      const std::complex<double> value = found.values[i].value;
      if (value.imag() < 0 || value == 0.0) continue;
      const VectorXcd x = found.vector(i);
      for (std::size_t k = 0; k < modes.size(); ++k) {
        const double like = likeness(x, shapes.col(static_cast<Eigen::Index>(k)), mass);
        if (like <= modes[k].likeness) continue;
        const std::complex<double> rate = std::log(value) / h;
        modes[k].likeness = like;
        modes[k].omega_shown = std::abs(rate);
        modes[k].zeta_shown = -rate.real() / std::abs(rate);
        left[k] = found.values[i].residual / std::abs(1.0 - value);
      }
    }
    return found.invariant || *std::ranges::max_element(left) < 1e-5;
  });
  return shown;
}

}  // namespace hmax
