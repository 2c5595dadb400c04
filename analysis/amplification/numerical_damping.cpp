#include "analysis/amplification/numerical_damping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/amplification/principal_root.hpp"

namespace hmax {

namespace {

/// log(zeta), whose real part is zero where |zeta| is one to rounding.
Complex rate_of(Complex zeta) {
  constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
  const Complex rate = std::log(zeta);
  return std::abs(rate.real()) <= rounding ? Complex(0, rate.imag()) : rate;
}

}  // namespace

// The step of a method on a linear mode is zeta^n, which is exp(t log(zeta) / h) at t = n h: the numerical
// solution is a damped oscillation with that eigenvalue [hughes2000finite, 9.3].
ShownOscillation shown_oscillation(const Amplification& amplification, double omega, double zeta, double h) {
  // lambda = omega (-zeta + i sqrt(1 - zeta^2)), the upper one of the pair.
  const Complex lambda = omega * Complex(-zeta, std::sqrt(std::max(0.0, 1 - zeta * zeta)));
  const Growth growth =
      amplification.of_oscillation
          ? amplification.of_oscillation({.kappa = omega * omega, .gamma = 2 * zeta * omega})
          : amplification.of_eigenmode(Eigenmode(lambda));
  PrincipalRoot root{std::numeric_limits<double>::quiet_NaN()};
  if (growth.polynomial)
    root = principal_root(*growth.polynomial, lambda, h);
  else if (amplification.R)
    root.zeta = amplification.R(h * lambda);
  // The eigenvalue of a flow that makes the same of a step: exp(h shown) = root.
  const Complex shown = rate_of(root.zeta) / h;
  ShownOscillation oscillation;
  oscillation.aliased = std::max(root.turn, h * lambda.imag()) > std::numbers::pi;
  oscillation.omega = std::abs(shown);
  oscillation.zeta = 0.0 - shown.real() / oscillation.omega;
  oscillation.frequency_damped = std::abs(shown.imag()) / (2 * std::numbers::pi);
  oscillation.period_error = lambda.imag() > 0 && shown.imag() != 0 && !oscillation.aliased
                                 ? lambda.imag() / std::abs(shown.imag()) - 1
                                 : std::numeric_limits<double>::quiet_NaN();
  oscillation.spectral_radius = growth.spectral_radius(h);
  return oscillation;
}

}  // namespace hmax
