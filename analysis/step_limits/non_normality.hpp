/// How far the modes of a matrix are from being orthogonal: why a stable system may grow at first.
#pragma once

#include <complex>

#include <Eigen/Core>

#include "analysis/spectrum/linear_model.hpp"

namespace hmax {

/// All of it depends on the norm, so on the units of the components: mechanical systems belong into
/// energy_coordinates() first.
struct NonNormality {
  /// Henrici's departure from normality (|J|_F^2 - sum |lambda|^2)^(1/2), as the norm of the strict upper
  /// triangle of the Schur form, which loses no digits to the difference [henrici1962bounds] [1/s].
  double departure = 0;
  double relative_departure = 0;  ///< departure / |J|_F, in [0, 1]
  double spectral_abscissa = 0;   ///< largest Re(lambda) [1/s]: the growth of |exp(t J)| in the end
  double numerical_abscissa = 0;  ///< largest eigenvalue of (J + J^T) / 2 [1/s]: its growth at the start
};
/// From the Schur form J = Q (D + N) Q*, D diagonal and N strictly upper triangular: |N|_F is zero for
/// normal J, J J^T = J^T J, whose modes are orthogonal. Costs some 10 n^3 operations.
/// @param J  shape (n, n)
NonNormality non_normality(const Eigen::MatrixXd& J);

/// The largest value that a search has found, and what no value can exceed to rounding.
struct KreissConstant {
  double value = 1;           ///< >= 1; infinity where exponentials are unbounded
  double bound = 1;           ///< >= value, by 1e-4 unless the search grew too long
  std::complex<double> at{};  ///< z of the largest value; infinity where the supremum lies there
};

/// The Kreiss constant of y' = J y,
///   K = sup over Re z > 0 of Re z |(z I - J)^-1|,   K <= sup over t > 0 of |exp(t J)| <= e n K
/// [trefethen2005spectra, section 18]: a lower bound of transient growth from the worst start. On a line Re z
/// = a the largest norm N(a) is found for certain, from the eigenvalues of a Hamiltonian matrix
/// [boyd1989bisection]; log N is convex, so that chords bound it between two lines, and lines are added where
/// a N(a) may still be 1e-4 larger than the largest value, which is then made exact to 1e-9. Closer to the
/// axis than 1e-9 |J| nothing is looked at.
/// @param J  shape (n, n), n up to about 100
/// @cost     some 100 spectra of size 2 n
KreissConstant kreiss_constant(const Eigen::MatrixXd& J);

/// x = to y and y = from x, shapes (2 n, 2 n), with y = (q, v) and |x|^2 = v^T M v + q^T |K| q, twice the
/// energy. |K| has the eigenvectors of the symmetric part of K in the metric of the masses and the absolute
/// values of its eigenvalues, none below 1e-12 of the largest (of 1 [1/s^2] where all are zero), so that a
/// drift without energy has a length too. In these coordinates an undamped system is normal and no passive
/// one has a Kreiss constant above 1.
struct EnergyCoordinates {
  Eigen::MatrixXd to, from;
};
EnergyCoordinates energy_coordinates(const MechanicalPart& part);

/// J as it is, or in energy coordinates where the model is mechanical.
/// @return  shape of J; to J from for mechanical models
Eigen::MatrixXd jacobian_in_energy_coordinates(const LinearModel& model);

}  // namespace hmax
