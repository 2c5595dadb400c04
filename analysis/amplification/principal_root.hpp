/// The root of a step polynomial that stands for the mode, followed from h = 0.
#pragma once

#include "analysis/amplification/amplification.hpp"

namespace hmax {

/// The principal root at a step.
struct PrincipalRoot {
  Complex zeta;     ///< what a step multiplies the mode by; of two real roots of a pair the larger one
  double turn = 0;  ///< its angle [rad], followed from zero at h = 0: beyond pi where Nyquist is passed
};

/// Follows the root that is exp(h lambda) for small h. The others are parasitic: they begin elsewhere and may
/// be closer to exp(h lambda) at large steps, where the principal root has lost its accuracy.
///
/// Real polynomials hold lambda and its conjugate: of them the pair is followed, by its sum and product,
/// which are smooth where the two roots meet on the real axis. Where they part along it the larger one, which
/// rules, is followed on. Each stride extrapolates from the last two and takes the nearest root or pair; it
/// is quartered until that one is four times as near as any other.
/// @param polynomial  of the mode, in h
/// @param lambda      of the mode, with an imaginary part of at least zero [1/s]
/// @param h           [s], > 0
/// @cost  some hundred times all roots; a few more for each decade of h |lambda| above one
PrincipalRoot principal_root(const StepPolynomial& polynomial, Complex lambda, double h);

}  // namespace hmax
