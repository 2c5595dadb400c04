/// The modes that a linear model is a sum of.
#pragma once

#include <array>
#include <complex>
#include <optional>

namespace hmax {

/// q'' + gamma q' + kappa q = 0. Every symmetric system whose damping is none or proportional is a sum of
/// these.
/// Natural frequency omega = sqrt(kappa) [rad/s], damping ratio zeta = gamma / (2 omega), frequency of the
/// damped oscillation omega sqrt(1 - zeta^2).
struct MechanicalMode {
  double kappa = 0;  ///< k / m [1/s^2]
  double gamma = 0;  ///< c / m [1/s]

  /// The one with the eigenvalues lambda and conj(lambda).
  /// (x - lambda)(x - conj(lambda)) = x^2 - 2 Re(lambda) x + |lambda|^2.
  static MechanicalMode of(std::complex<double> lambda) { return {std::norm(lambda), -2 * lambda.real()}; }
};

/// lambda = -gamma/2 +- sqrt(gamma^2/4 - kappa), the smaller real one as kappa over the larger so that
/// nothing cancels. Larger real part first, then larger imaginary part.
std::array<std::complex<double>, 2> eigenvalues_of(const MechanicalMode& mode);

/// A mode as engineers read it. A natural frequency and a damping ratio belong to a pair of eigenvalues: a
/// real one whose partner is not known has neither.
/// Overdamped: zeta > 1 and two rates whose product is kappa and whose sum is gamma.
struct Mode {
  std::complex<double> lambda;    ///< the eigenvalue that names the mode [1/s]
  std::optional<double> omega{};  ///< sqrt(kappa) [rad/s]; nothing for kappa < 0
  std::optional<double> zeta{};   ///< gamma / (2 omega), overdamped beyond 1; nothing for omega = 0
  std::optional<std::array<double, 2>> rates{};  ///< -lambda of a pair of real ones, the faster first [1/s]
};

/// Of lambda and its conjugate: omega = |lambda|, zeta = -Re(lambda) / |lambda|. A real lambda stands alone.
Mode mode_of(std::complex<double> lambda);

/// Of both eigenvalues of an oscillation; `lambda` is the upper one, or the faster of two real ones.
Mode mode_of(const MechanicalMode& oscillation);

}  // namespace hmax
