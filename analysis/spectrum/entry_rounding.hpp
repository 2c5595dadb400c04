/// To how many digits the entries of a matrix were written.
#pragma once

#include "analysis/spectrum/linear_model.hpp"

namespace hmax {

/// The relative rounding of entries that come from decimals of d digits, 10^(1-d) / 2, where the longest
/// shortest round-trip decimal among them has d = 6 ... 14 digits; 0 otherwise: shorter ones may be exact,
/// longer ones are full doubles.
/// @cost  one pass, which ends at the first entry of full length
double entry_rounding(const AnyMatrix& matrix);

/// What that rounding may change x^T A x by: sum_ij |x_i| e_ij |x_j|, where e_ij is half a unit of the last
/// digit of A_ij. With u^T M u = 1 an eigenvalue of K u = kappa M u is known to that, to first order.
/// @param rounding  of entry_rounding()
/// @param x         shape (n)
double rounding_of_form(const AnyMatrix& A, double rounding, const Eigen::VectorXd& x);

}  // namespace hmax
