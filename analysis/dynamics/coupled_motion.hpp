/// The methods that step positions and velocities where damping couples the modes: all modes together.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "analysis/amplification/amplification.hpp"
#include "analysis/spectrum/largest_of_sum.hpp"
#include "analysis/spectrum/linear_model.hpp"
#include "core/size_limits.hpp"

namespace hmax {

/// The limit of a step of such a method.
/// A limit that is proved holds for every smaller step; one found in strides may hide a narrow unstable
/// stretch below it.
struct CoupledLimit {
  double h_max = 0;  ///< the first exit [s]; infinity without one, 0 when every step is unstable
  /// What the motion that begins to grow there is stiffened and damped by: for its shape x, with M = I,
  /// kappa = x* K x / x* x and gamma = x* C x / x* x.
  MechanicalMode shape{};
  Eigen::VectorXd displacement = {};  ///< that shape, the real part of it, |displacement| = 1, shape (n)
  /// x* P(zeta, h) x / x* x: beside h_max its roots are those of the whole but for terms of second order.
  std::optional<StepPolynomial> of_shape = {};
  bool proved = false;  ///< for every step below; otherwise looked for in strides
};

/// M q'' + C q' + K q = 0 as a method steps it: motions q_n = zeta^n x with P(zeta, h) x = 0,
///   P = inertia(zeta) M + h (damper(zeta) C + lumped(zeta) diag C) + h^2 spring(zeta) K,
/// a matrix polynomial in zeta of the degree of the method. Where no basis makes C and K diagonal at once it
/// has to be solved as a whole.
/// In coordinates M^1/2 q the matrices are I, c = M^-1/2 C M^-1/2 and k = M^-1/2 K M^-1/2.
class CoupledMotion {
 public:
  /// Makes k, c and diag c dense, shape (n, n) each.
  /// @param part  up to some thousand degrees of freedom
  CoupledMotion(const MotionMap& map, const MechanicalPart& part);

  /// All roots zeta of det P(zeta, h) = 0, by the eigenvalues of its companion matrix, shape (degree n,
  /// degree n); infinite ones where the equation of a step cannot be solved.
  [[nodiscard]] std::vector<Complex> roots(double h) const;
  /// The largest |zeta|; infinity where the equation of a step cannot be solved.
  /// @cost  an eigenproblem of degree n rows without symmetry
  [[nodiscard]] double spectral_radius(double h) const;

  /// The first exit from the origin.
  ///
  /// With x* P x = 0 every root is that of a single oscillation with the kappa and gamma of its shape. So
  /// where M, C and K are symmetric, K and C without negative eigenvalues, it is proved that no step is
  /// unstable if that holds for all single oscillations; and if those always leave at zeta = -1, so does the
  /// whole: at the h where the symmetric P(-1, h) ceases to be definite.
  /// Central differences with lumped damping leave there too where lumping_keeps_stable().
  /// In all other cases the radius is looked at in strides, which are the wider the larger the system is, and
  /// the exit is the solution of P(exp(i theta), h) x = 0 for theta, h and x by Newton's method.
  /// @param single  the map of single oscillations
  /// @cost  n^3 times some ten, if the exit is at -1, and some thousand otherwise; nothing for systems of
  ///        more than most_coupled_rows rows in the companion matrix that would need strides
  [[nodiscard]] std::optional<CoupledLimit> first_exit(const Amplification& single) const;

 private:
  using Matrix = Eigen::MatrixXd;
  // P(zeta, h), shape (n, n).
  [[nodiscard]] Eigen::MatrixXcd at(Complex zeta, double h) const;
  // The first h > 0 at which the symmetric P(-1, h) is singular; nothing where it has no bound.
  [[nodiscard]] std::optional<double> leaves_at_minus_one() const;
  /// Whether it is proved of
  ///   inertia = zeta (zeta-1)^2, damper = (zeta-1) (3 zeta-1) / 2, lumped = (zeta-1)^3 / 2, spring = zeta^2
  /// that no step up to h, where P(-1, .) ceases to be definite, is unstable. With g = h x* C x / 2,
  /// d = h x* diag(C) x / 2 and k = h^2 x* K x, x* x = 1, every root is one of the cubic of three numbers
  ///   (1+d) zeta^3 + (k-2+3g-3d) zeta^2 + (1-4g+3d) zeta + g-d,
  /// of which k >= 0 and k + 8 g <= 4 + 8 d, what P(-1) says, leave one of Jury's conditions open,
  ///   2 g (1 + g) + (g - d) k >= 0.
  /// Where K <= rho C, k <= 2 h rho g, it holds if 1 + g + h rho (g - d) >= 0 for all x: if
  ///   I + h/2 C + h^2 rho/2 (C - diag C)
  /// is positive definite; and, if it is at h, at all steps below [jury1964theory].
  [[nodiscard]] bool lumping_keeps_stable(double h) const;
  // The radius at h, 1.05 h, ... (1.2, 1.5 for large systems) from 0.1 / rate_ on; the exit between two of
  // them by refined().
  [[nodiscard]] std::optional<CoupledLimit> by_strides(std::optional<double> at_minus_one) const;
  // The exit between a stable and an unstable step.
  [[nodiscard]] CoupledLimit refined(double stable, double unstable) const;
  // The limit h with the kappa and gamma of the shape x, or of the kernel of P(zeta, h).
  [[nodiscard]] CoupledLimit leaves_with(double h, const Eigen::VectorXcd& x, bool proved) const;
  [[nodiscard]] CoupledLimit with_shape(double h, Complex zeta, bool proved) const;

  MotionMap map_;       ///< without common roots at zero
  Eigen::Index n_ = 0;  ///< degrees of freedom
  MassMatrix<double> mass_;
  Matrix k_, c_, d_;  ///< M^-1/2 K M^-1/2 [1/s^2], the same of C and of its diagonal [1/s]
  bool symmetric_ = true;
  double rate_ = 0;      ///< what h is measured by [1/s]
  double rounding_ = 0;  ///< how far beyond one a root may be by rounding
};

/// The first exit of a large system without dense matrices, where it is proved as in
/// CoupledMotion::first_exit: for symmetric M, C and K, K and C without negative eigenvalues, and single
/// oscillations that never leave, or always at zeta = -1. There the least h with x^T P(-1, h) x = 0 over all
/// x is approached by the least eigenvectors of P(-1, h), from above.
/// For each x, |x| = 1 in coordinates where M = I,
///   x^T P(-1, h) x = inertia(-1) + h damper(-1) gamma(x) + h^2 spring(-1) kappa(x)
/// is a quadratic in h. The iteration h -> least eigenvector x of P(-1, h) -> smallest root h of that
/// quadratic falls from its second round on, until it stands still to 1e-10.
/// @cost  a Lanczos iteration in each of some ten rounds, at most 50
/// @param single  the map of single oscillations
/// @return  nothing where it would not be proved
std::optional<CoupledLimit> proved_first_exit(const MotionMap& map, const MechanicalPart& part,
                                              const Amplification& single);
/// The same of matrices that are elsewhere, symmetric and without negative eigenvalues.
/// @param most_c, most_k  no less than the largest eigenvalues
/// @return  the displacement in coordinates where M = I; empty where `find` has no vector
std::optional<CoupledLimit> proved_first_exit(const MotionMap& map, const FindLargestOfSum& find,
                                              double most_c, double most_k, const Amplification& single);

/// Whether the steps of the method on this model couple modes that its motion does not, or that it couples
/// itself, so that they cannot be taken one by one.
/// True where damping is general or matrices are not symmetric, and where the method treats the diagonal
/// of a C with other entries apart.
bool couples_modes(const MotionMap& map, const MechanicalPart& part);

}  // namespace hmax
