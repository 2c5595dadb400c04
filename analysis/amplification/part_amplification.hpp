/// What a step makes of a mode of which it is told more than z = h lambda: what part of it is stiff, or what
/// an old Jacobian says in its place.
#pragma once

#include <memory>
#include <vector>

#include "analysis/amplification/amplification.hpp"

namespace hmax {

/// R as a polynomial in z_slow, in ascending powers.
using SlowPolynomial = std::vector<Complex>;

/// R of an implicit-explicit pair beside a fixed z_fast is a polynomial in z_slow of at most as many degrees
/// as the pair has stages: from its values on a circle.
/// c_j = (1 / (N r^j)) sum_i R(r w^i) w^(-i j), w = exp(2 pi i / N), with N = 24 points on |z_slow| = r =
/// 4: exact for degrees below 24 (trapezoidal rule on a circle). Coefficients below 1e-13 of the largest
/// are rounding and taken as zero.
SlowPolynomial in_slow(const Amplification& pair, Complex fast);

/// Whether |R(z)| is at most 1, but for the rounding of its coefficients.
/// |R|^2 <= 1 + 2e-9.
bool is_at_most_one(const SlowPolynomial& R, Complex z);

/// The amplification of a pair in z_slow beside a fixed z_fast.
/// @param fast  z_stiff = h lambda_stiff, kept for every z_slow
Amplification beside_stiff(const std::shared_ptr<const Amplification>& pair, Complex fast);

/// The amplification of a linearly implicit method whose Jacobian says lambda / ratio.
/// A ratio above one is a model that has become stiffer than its Jacobian says.
/// @param ratio  lambda / lambda0, not zero
Amplification with_old_jacobian(const std::shared_ptr<const Amplification>& method, double ratio);

}  // namespace hmax
