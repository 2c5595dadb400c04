/// The stability of a method in a few numbers.
#pragma once

#include <optional>
#include <vector>

#include "analysis/amplification/amplification.hpp"

namespace hmax {

/// A stretch of an axis that is stable behind an unstable one: of no use to anybody who lowers a step, and a
/// trap for those who look for the limit from afar.
struct Lobe {
  bool imaginary = false;
  double from = 0, to = 0;  ///< |z|
};

/// Of y' = lambda y, z = h lambda; for methods that step positions and velocities, of an oscillation with the
/// eigenvalues lambda and conj(lambda).
/// Lengths on the axes are |z| = h |lambda|: the limit of a step is real / |lambda| or imaginary / omega
/// [s].
struct StabilityLimits {
  double real = 0;            ///< [-real, 0] is stable: the first exit from the origin; infinity: all of it
  double imaginary = 0;       ///< i [0, imaginary] is
  double imaginary_weak = 0;  ///< where the spectral radius first exceeds 1 + 1e-6 on the imaginary axis
  /// The wedge |arg(-z)| <= alpha is stable however large z; nothing when no wedge is.
  std::optional<double> alpha_degrees;
  bool a_stable = false;  ///< the whole left half-plane is stable
  bool l_stable = false;  ///< and nothing is left of infinitely fast modes
  /// Spectral radius in the limit of large z; infinity for explicit methods, nothing where it is not known.
  std::optional<double> at_infinity;
  std::vector<Lobe> lobes;
};

/// Exits on the two axes by first_exit(), so proved where there are conditions. A-stability by the maximum
/// principle: |R| <= 1 on the imaginary axis and no pole in Re z <= 0 give |R| <= 1 on the left
/// [hairer1996solving, IV.3]. L-stable: A-stable with a spectral radius at infinity below `annihilated`.
/// A(alpha) of multistep methods from the root locus curve z(theta) [hairer1996solving, V.1], of others by
/// bisection over rays to 1e-9 degrees.
StabilityLimits stability_limits(const Amplification& amplification);

}  // namespace hmax
