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
SlowPolynomial in_slow(const Amplification& pair, Complex fast);

/// Whether |R(z)| is at most 1, but for the rounding of its coefficients.
bool is_at_most_one(const SlowPolynomial& R, Complex z);

/// The amplification of a pair in z_slow beside a fixed z_fast.
Amplification beside_stiff(const std::shared_ptr<const Amplification>& pair, Complex fast);

/// The amplification of a linearly implicit method whose Jacobian says lambda / ratio.
Amplification with_old_jacobian(const std::shared_ptr<const Amplification>& method, double ratio);

}  // namespace hmax
