/// To how many digits the entries of a matrix were written.
#pragma once

#include "analysis/spectrum/linear_model.hpp"

namespace hmax {

/// The relative rounding of entries that come from decimals of d digits, 10^(1-d) / 2, where the longest
/// shortest round-trip decimal among them has d = 6 ... 14 digits; 0 otherwise: shorter ones may be exact,
/// longer ones are full doubles. An eigenvalue of K u = kappa M u is known to about that share of the largest
/// one.
/// @cost  one pass, which ends at the first entry of full length
double entry_rounding(const AnyMatrix& matrix);

}  // namespace hmax
