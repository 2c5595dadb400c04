/// The damping and the change of period that a method adds to an oscillation.
#pragma once

#include "analysis/amplification/amplification.hpp"

namespace hmax {

/// How a run shows the mode q'' + 2 zeta omega q' + omega^2 q = 0.
struct ShownOscillation {
  double omega = 0;             ///< [rad/s], |log(zeta) / h| of the root that stands for the mode
  double zeta = 0;              ///< damping ratio; negative when the run grows
  double frequency_damped = 0;  ///< of the oscillation that is seen, Im / (2 pi) [Hz]
  double period_error =
      0;  ///< relative, of the damped oscillation; NaN when it does not oscillate or is aliased
  double spectral_radius = 0;
  /// The Nyquist frequency 1 / (2 h) lies below the damped frequency of the mode, or below that of the
  /// numerical solution: what is seen in the steps is an alias.
  bool aliased = false;
};

/// From log(zeta) / h of the principal root (principal_root.hpp), which for R(z) is R(h lambda)
/// [hughes2000finite, 9.3]. All but the spectral radius are NaN where the map is known by its radius alone.
/// Shown are omega = |log(zeta)| / h, the damping ratio -Re log(zeta) / |log(zeta)| and the relative
/// change of the damped period, T_shown / T - 1 = Im(lambda) h / |Im log(zeta)| - 1.
/// The logarithm is the principal one, as the steps show the oscillation.
/// @param omega  [rad/s], > 0;  @param zeta  in [0, 1);  @param h  [s], > 0
ShownOscillation shown_oscillation(const Amplification& amplification, double omega, double zeta, double h);

}  // namespace hmax
