#include "analysis/amplification/numerical_damping.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace hmax {

// The step of a method on a linear mode is zeta^n, which is exp(t log(zeta) / h) at t = n h: the numerical
// solution is a damped oscillation with that eigenvalue [hughes2000finite, 9.3].
ShownOscillation shown_oscillation(const Amplification& amplification, double omega, double zeta, double h) {
  // lambda = omega (-zeta + i sqrt(1 - zeta^2)), the upper one of the pair.
  const Complex lambda = omega * Complex(-zeta, std::sqrt(std::max(0.0, 1 - zeta * zeta)));
  Complex root;
  const Growth growth =
      amplification.of_oscillation
          ? amplification.of_oscillation({.kappa = omega * omega, .gamma = 2 * zeta * omega})
          : amplification.of_eigenmode(Eigenmode(lambda));
  if (growth.polynomial) {
    // Of several roots the others are parasitic, or the conjugate.
    const Complex exact = std::exp(h * lambda);
    double closest = std::numeric_limits<double>::infinity();
    for (const Complex candidate : growth.polynomial->roots(h))
      if (std::abs(candidate - exact) < closest) {
        closest = std::abs(candidate - exact);
        root = candidate;
      }
  } else {
    root = amplification.R ? amplification.R(h * lambda) : Complex(std::numeric_limits<double>::quiet_NaN());
  }
  // The eigenvalue of a flow that makes the same of a step: exp(h shown) = root.
  const Complex shown = std::log(root) / h;
  ShownOscillation oscillation;
  oscillation.omega = std::abs(shown);
  oscillation.zeta = -shown.real() / oscillation.omega;
  oscillation.frequency_damped = std::abs(shown.imag()) / (2 * std::numbers::pi);
  oscillation.period_error = lambda.imag() > 0 && shown.imag() != 0
                                 ? lambda.imag() / std::abs(shown.imag()) - 1
                                 : std::numeric_limits<double>::quiet_NaN();
  oscillation.spectral_radius = growth.spectral_radius(h);
  return oscillation;
}

}  // namespace hmax
