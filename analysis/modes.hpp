/// The modes that a linear model is a sum of.
#pragma once

#include <array>
#include <complex>

namespace hmax {

/// An eigenvalue as engineers read it; a real one is a mode without oscillation, zeta = +-1.
struct Mode {
  std::complex<double> lambda;  ///< [1/s]
  double omega = 0;             ///< |lambda| [rad/s]
  double zeta = 0;              ///< damping ratio -Re(lambda) / |lambda|, in [-1, 1]; 0 for lambda = 0
};
Mode mode_of(std::complex<double> lambda);

/// q'' + gamma q' + kappa q = 0. Every symmetric system whose damping is none or proportional is a sum of
/// these.
struct MechanicalMode {
  double kappa = 0;  ///< k / m [1/s^2]
  double gamma = 0;  ///< c / m [1/s]

  /// The one with the eigenvalues lambda and conj(lambda).
  static MechanicalMode of(std::complex<double> lambda) { return {std::norm(lambda), -2 * lambda.real()}; }
};

/// lambda = -gamma/2 +- sqrt(gamma^2/4 - kappa), the smaller real one as kappa over the larger so that
/// nothing cancels. Larger real part first, then larger imaginary part.
std::array<std::complex<double>, 2> eigenvalues_of(const MechanicalMode& mode);

}  // namespace hmax
