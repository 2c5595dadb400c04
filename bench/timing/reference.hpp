/// References of runs.
#pragma once

#include "catalogue/methods/method.hpp"

namespace hmax {

/// A reference on [0, t_end]: the Taylor series of the oscillator; the exact solution of the test set and of
/// linear tissue, or extrapolation in long double where there is none; for formulas and other tissue
/// Boost.Odeint's extrapolation method at tight tolerance, or dop_853 where Boost is missing (`name` says
/// which).
Reference make_reference(const Problem& problem, double t_end);

}  // namespace hmax
