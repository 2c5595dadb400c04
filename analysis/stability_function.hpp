/// The stability function of Runge-Kutta methods and the step it allows.
#pragma once

#include <complex>
#include <functional>
#include <span>

namespace hmax {

/// What one step of a method makes of y' = lambda y, y_new = R(h lambda) y.
using StabilityFunction = std::function<std::complex<double>(std::complex<double> z)>;

/// R(z) = 1 + z b^T (I - z A)^-1 1 of an explicit tableau, by forward substitution [hairer1996solving, IV.2].
/// @param a  row-major, shape (s, s), strictly lower triangular
/// @param b  shape (s)
std::complex<double> explicit_stability_function(std::span<const long double> a,
                                                 std::span<const long double> b, std::complex<double> z);

/// The largest h such that |R(h' lambda)| <= 1 for every h' in (0, h]: the first exit from the origin along
/// the ray of lambda, since what lies behind a gap is of no use to anybody who lowers a step.
/// @param lambda     [1/s]; growing modes, Re lambda > 0, allow any step: they are not the method's fault
/// @param beyond     no exit is sought beyond |h lambda| = beyond
/// @returns h [s]; infinity when there is no exit, 0 when every step amplifies by more than rounding
double largest_stable_step(const StabilityFunction& R, std::complex<double> lambda, double beyond = 1e3);

/// The smallest of them over a spectrum.
double largest_stable_step(const StabilityFunction& R, std::span<const std::complex<double>> spectrum,
                           double beyond = 1e3);

}  // namespace hmax
