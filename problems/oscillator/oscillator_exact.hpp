/// Closed-form solutions of the oscillator m x'' + c x' + k1 x + k3 x^3 = P cos(w t), for the parameters that
/// have one.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// t -> (x(t), v(t)) with (x, v) = y0 at t = 0. Computed in long double; the error of its phase is a few
/// 1e-19 times the number of radians passed.
class ExactSolution {
 public:
  using ExtendedState = BasicOscillator<long double>::State;

  explicit ExactSolution(std::function<ExtendedState(long double)> solution)
      : solution_(std::move(solution)) {}

  /// @param t  time [s], any sign
  Eigen::Vector2d operator()(double t) const { return solution_(t).cast<double>(); }

  /// The same before it is rounded to double.
  ExtendedState extended(long double t) const { return solution_(t); }

 private:
  std::function<ExtendedState(long double)> solution_;
};

/// The exact solution where there is one:
/// - k3 = 0: any damping (also negative), any stiffness (also zero or negative), forced or not; critical
/// damping and
///   resonance are ordinary points of the formula used;
/// - c = 0, P = 0, k3 > 0: bounded motion in the single or double well by Jacobi elliptic functions;
/// - c = 0, P = 0, k1 > 0 > k3: motion inside the well by Jacobi elliptic functions.
/// @returns  nothing for other parameters, for motion that leaves a softening well, and for starts exactly on
/// a
///           separatrix
/// @throws std::invalid_argument  for parameters that are no oscillator (see BasicOscillator)
/// @source   [olver2010nist] 22.8, 22.13; checked by tests/problems/oscillator/oscillator_exact_test.cpp
std::optional<ExactSolution> exact_solution(const OscillatorParameters& parameters,
                                            const Eigen::Vector2d& y0);

}  // namespace hmax
