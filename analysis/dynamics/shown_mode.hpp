/// What steps make of a slow mode, from the eigenvalues of their derivative.
#pragma once

#include <array>
#include <complex>
#include <limits>

namespace hmax {

/// A slow mode of the model, or of small steps, and what steps make of it.
struct ShownMode {
  double omega = 0, zeta = 0;  ///< of the model [rad/s], [1]
  /// Of the steps: |log(lambda)| / h and -Re(log(lambda)) / |log(lambda)| of the eigenvalue lambda of the
  /// derivative of a step whose motion is most like that of the mode, or of two real ones as of an overdamped
  /// oscillation. NaN where none is like it, to a half.
  double omega_shown = 0, zeta_shown = 0;
  double likeness = 0;  ///< |u^T M x| of the shapes u of the model and x of the step, |u|_M = |x|_M = 1
};

/// What has been found of one mode: an oscillation, or two decays of one motion.
class FoundMode {
 public:
  /// @param rate  log(lambda) / h [1/s], @param error  of lambda beside its distance from 1
  void look(std::complex<double> rate, double like, double error);

  /// Whether the eigenvalue that is most like the mode has converged.
  [[nodiscard]] bool converged(double tolerance) const { return best().error <= tolerance; }

  /// Whether that eigenvalue is one of a complex pair.
  [[nodiscard]] bool oscillates() const { return oscillation_.like > 0 && &best() == &oscillation_; }

  /// @returns `mode` with what is shown; NaN where nothing is like it, or has not converged
  [[nodiscard]] ShownMode shown(ShownMode mode) const;

 private:
  struct Eigenvalue {
    std::complex<double> rate;
    double like = 0, error = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] const Eigenvalue& best() const {
    return oscillation_.like >= decays_[0].like ? oscillation_ : decays_[0];
  }
  Eigenvalue oscillation_;
  std::array<Eigenvalue, 2> decays_;
};

}  // namespace hmax
