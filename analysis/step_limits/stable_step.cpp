#include "analysis/step_limits/stable_step.hpp"

#include <algorithm>
#include <cmath>

#include "core/numbers.hpp"

namespace hmax {

namespace {

/// The limit of `count` modes, of which first_exit_of(i, least) tells the first exit, where the least so far
/// is known, and grows(i) whether it grows.
template <class Grows, class FirstExit>
StepLimit over_modes(std::size_t count, const Grows& grows, const FirstExit& first_exit_of,
                     Exits wanted = Exits::all) {
  StepLimit limit{.h_max = infinity, .of_modes = std::vector<double>(count, infinity)};
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = wanted == Exits::all ? k : count - 1 - k;
    if (grows(i)) {
      limit.growing.push_back(i);
      continue;
    }
    limit.of_modes[i] = first_exit_of(i, wanted == Exits::all ? infinity : limit.h_max);
    if (limit.of_modes[i] < limit.h_max) {
      limit.h_max = limit.of_modes[i];
      limit.limiting = i;
    }
  }
  return limit;
}

bool grows(Complex lambda, double noise) {
  return lambda.real() > std::max(noise, eigenvalue_rounding * std::abs(lambda));
}

template <class Lambdas, class Value>
double radius_of(const Lambdas& modes, const Value& value) {
  double radius = 0;
  for (const auto& mode : modes) radius = std::max(radius, value(mode));
  return radius;
}

/// On the imaginary axis when it is there but for rounding, and where it does not grow; in the upper
/// half-plane: methods are real.
Complex cleaned(Complex lambda) {
  const bool undamped = lambda.real() >= -eigenvalue_rounding * std::abs(lambda);
  return {undamped ? 0 : lambda.real(), std::abs(lambda.imag())};
}

/// @param most  [s], beyond which an exit is not sought where it is sampled
double exit_of(const Amplification& amplification, Eigenmode mode, double noise, double most) {
  if (std::abs(mode.lambda) <= noise) return infinity;
  const Complex lambda = cleaned(mode.lambda);
  // What the method is told is turned with it.
  if (lambda != mode.lambda) {
    const bool all_stiff = mode.stiff == mode.lambda, exact = mode.frozen == mode.lambda;
    if (mode.lambda.imag() < 0) {
      mode.stiff = std::conj(mode.stiff);
      mode.frozen = std::conj(mode.frozen);
    }
    mode.lambda = lambda;
    if (all_stiff) mode.stiff = lambda;
    if (exact) mode.frozen = lambda;
  }
  Growth growth = amplification.of_eigenmode(mode);
  // One stride of the samples, of 15 % at most, beyond it.
  growth.farthest = std::min(growth.farthest, 1.2 * most / growth.scale);
  return first_exit(growth);
}

}  // namespace

double noise_of(std::size_t count, double radius) {
  return 4 * static_cast<double>(count + 1) * std::numeric_limits<double>::epsilon() * radius;
}

std::vector<std::size_t> growing_modes(std::span<const Complex> spectrum) {
  const double noise =
      noise_of(spectrum.size(), radius_of(spectrum, [](Complex lambda) { return std::abs(lambda); }));
  std::vector<std::size_t> growing;
  for (std::size_t i = 0; i < spectrum.size(); ++i)
    if (grows(spectrum[i], noise)) growing.push_back(i);
  return growing;
}

StepLimit largest_stable_step(const Amplification& amplification, std::span<const Eigenmode> modes,
                              Exits wanted) {
  const double noise =
      noise_of(modes.size(), radius_of(modes, [](const Eigenmode& mode) { return std::abs(mode.lambda); }));
  return over_modes(
      modes.size(), [&](std::size_t i) { return grows(modes[i].lambda, noise); },
      [&](std::size_t i, double least) { return exit_of(amplification, modes[i], noise, least); }, wanted);
}

StepLimit largest_stable_step(const Amplification& amplification, std::span<const Complex> spectrum) {
  std::vector<Eigenmode> modes(spectrum.begin(), spectrum.end());
  const double radius = radius_of(spectrum, [](Complex lambda) { return std::abs(lambda); });
  for (Eigenmode& mode : modes) mode.radius = radius;
  return largest_stable_step(amplification, modes);
}

StepLimit largest_stable_step(const Amplification& amplification, std::span<const MechanicalMode> modes) {
  const double radius = radius_of(modes, [](const MechanicalMode& mode) {
    const auto [first, second] = eigenvalues_of(mode);
    return std::max(std::abs(first), std::abs(second));
  });
  const double noise = noise_of(modes.size(), radius);
  return over_modes(
      modes.size(), [&](std::size_t i) { return grows(eigenvalues_of(modes[i])[0], noise); },
      [&](std::size_t i, double) {
        MechanicalMode mode = modes[i];
        mode.gamma = std::max(mode.gamma, 0.0);
        if (amplification.of_oscillation) return first_exit(amplification.of_oscillation(mode));
        const auto [first, second] = eigenvalues_of(mode);
        double exit = infinity;
        for (const Complex lambda : {first, second}) {
          Eigenmode eigenmode(lambda);
          eigenmode.radius = radius;
          exit = std::min(exit, exit_of(amplification, eigenmode, noise, infinity));
          if (lambda.imag() != 0) break;  // the other is its conjugate
        }
        return exit;
      });
}

}  // namespace hmax
