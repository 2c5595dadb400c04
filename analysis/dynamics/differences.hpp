/// The Jacobian of a vector function of which only values are known, as sharp as its rounding allows.
#pragma once

#include <functional>

#include <Eigen/Core>

namespace hmax {

/// g: R^n -> R^m; its arguments have shape (n), its values shape (m).
using VectorFunction = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// J(i, j) = d g_i / d y_j at y, shape (m, n): central differences
///   (g(y + d e_j) - g(y - d e_j)) / (2 d)
/// at increments that shrink from scale_j / 50, extrapolated to d = 0 as polynomials in d^2; of each entry
/// the value is taken at which two extrapolations agree best [ridders1982accurate]. Increments at which g is
/// not finite are passed over; entries for which too few are left are NaN.
/// The error of a central difference is a series in d^2; level k of the tableau removes its term d^(2 k).
/// Roughly 24 evaluations of g a column.
/// @param scale  shape (n), positive: over which y_j changes g noticeably
Eigen::MatrixXd differenced_jacobian(const VectorFunction& g, const Eigen::VectorXd& y,
                                     const Eigen::VectorXd& scale);

}  // namespace hmax
