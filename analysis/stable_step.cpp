#include "analysis/stable_step.hpp"

#include <algorithm>
#include <cmath>

namespace hmax {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The limit of `count` modes, of which first_exit_of(i) tells the first exit and grows(i) whether it grows.
template <class Grows, class FirstExit>
StepLimit over_modes(std::size_t count, const Grows& grows, const FirstExit& first_exit_of) {
  StepLimit limit{.h_max = infinity, .of_modes = std::vector<double>(count, infinity), .growing = {}};
  for (std::size_t i = 0; i < count; ++i) {
    if (grows(i)) {
      limit.growing.push_back(i);
      continue;
    }
    limit.of_modes[i] = first_exit_of(i);
    if (limit.of_modes[i] < limit.h_max) {
      limit.h_max = limit.of_modes[i];
      limit.limiting = i;
    }
  }
  return limit;
}

bool grows(Complex lambda) { return lambda.real() > eigenvalue_rounding * std::abs(lambda); }

/// On the imaginary axis when it is there but for rounding; in the upper half-plane: methods are real.
Complex cleaned(Complex lambda) {
  const bool undamped = std::abs(lambda.real()) <= eigenvalue_rounding * std::abs(lambda);
  return {undamped ? 0 : lambda.real(), std::abs(lambda.imag())};
}

double exit_of(const Amplification& amplification, Eigenmode mode) {
  if (mode.lambda == Complex(0)) return infinity;
  const Complex lambda = cleaned(mode.lambda);
  // What the method is told is turned with it.
  if (lambda != mode.lambda) {
    if (mode.stiff == mode.lambda) mode.stiff = lambda;
    if (mode.frozen == mode.lambda) mode.frozen = lambda;
    if (mode.lambda.imag() < 0) {
      mode.stiff = {mode.stiff.real(), std::abs(mode.stiff.imag())};
      mode.frozen = {mode.frozen.real(), std::abs(mode.frozen.imag())};
    }
    mode.lambda = lambda;
  }
  return first_exit(amplification.of_eigenmode(mode));
}

}  // namespace

StepLimit largest_stable_step(const Amplification& amplification, std::span<const Eigenmode> modes) {
  return over_modes(
      modes.size(), [&](std::size_t i) { return grows(modes[i].lambda); },
      [&](std::size_t i) { return exit_of(amplification, modes[i]); });
}

StepLimit largest_stable_step(const Amplification& amplification, std::span<const Complex> spectrum) {
  double radius = 0;
  for (const Complex lambda : spectrum) radius = std::max(radius, std::abs(lambda));
  return over_modes(
      spectrum.size(), [&](std::size_t i) { return grows(spectrum[i]); },
      [&](std::size_t i) {
        Eigenmode mode(spectrum[i]);
        mode.radius = radius;
        return exit_of(amplification, mode);
      });
}

StepLimit largest_stable_step(const Amplification& amplification, std::span<const MechanicalMode> modes) {
  double radius = 0;
  for (const MechanicalMode& mode : modes) {
    const auto [first, second] = eigenvalues_of(mode);
    radius = std::max({radius, std::abs(first), std::abs(second)});
  }
  return over_modes(
      modes.size(), [&](std::size_t i) { return grows(eigenvalues_of(modes[i])[0]); },
      [&](std::size_t i) {
        const MechanicalMode& mode = modes[i];
        if (amplification.of_oscillation) return first_exit(amplification.of_oscillation(mode));
        const auto [first, second] = eigenvalues_of(mode);
        double exit = infinity;
        for (const Complex lambda : {first, second}) {
          Eigenmode eigenmode(lambda);
          eigenmode.radius = radius;
          exit = std::min(exit, exit_of(amplification, eigenmode));
          if (lambda.imag() != 0) break;  // the other is its conjugate
        }
        return exit;
      });
}

}  // namespace hmax
