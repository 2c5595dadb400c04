/// References of runs.
#pragma once

#include <functional>
#include <string>

#include <Eigen/Core>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// The solution that errors are measured against; it shares no code with the methods of the
/// catalogue, but for formulas where Boost is missing: dop_853 then stands in, and `name` says so.
struct Reference {
  std::function<Eigen::VectorXd(double t)> at;  ///< shape (dim), t in [0, valid_until]
  double valid_until = 0;                       ///< [s]
  double error_bound = 0;                       ///< of `at` in the maximum norm over [0, valid_until]
  std::string name;                             ///< how it was obtained
  /// The same in long double; null where there is only double.
  std::function<Eigen::Vector<long double, Eigen::Dynamic>(long double t)> extended_at;
  double extended_error = 0;  ///< bound of the error of `extended_at`, where it is more than rounding
};

/// A reference on [0, t_end]: the Taylor series of the oscillator; the exact solution of the test set and of
/// linear tissue, or extrapolation in long double where there is none; for formulas and other tissue
/// Boost.Odeint's extrapolation method at tight tolerance, or dop_853 where Boost is missing (`name` says
/// which).
/// @param watch  called often; may throw to end it
Reference make_reference(const Problem& problem, double t_end, const std::function<void()>& watch = {});

}  // namespace hmax
