/// How large a local error is, in units of what the user tolerates. The only place that weighs errors.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/instructions/device_code.hpp"
#include "integrators/state.hpp"
#include "integrators/tolerances.hpp"

namespace hmax {

/// Root mean square of e_i / (atol_i + rtol max(|y_i|, |y_new,i|)) [hairer1993solving, II.4]. Norms are kept
/// squared: the loop then needs no square root.
/// @tparam Atol  Real, the same for all components, or a vector with one for each
template <class Real, class Atol>
struct WeightedRms {
  Real rtol;  ///< relative tolerance
  Atol atol;  ///< one number, or a vector of shape (n), in the units of the state

  /// (1/n) sum_i (e_i / (atol_i + rtol max(|y_i|, |y_new,i|)))^2; NaN where an e_i is NaN.
  /// @param error  callable, error(i) = component i of the local error
  template <class State, class Error>
  HMAX_DEVICE Real squared(const State& y, const State& y_new, const Error& error) const {
    Real sum{0};
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      const Real weight = detail::atol_of(atol, i) + rtol * std::max(std::abs(y[i]), std::abs(y_new[i]));
      sum += Eigen::numext::abs2(error(i) / weight);
    }
    return sum / static_cast<Real>(y.size());
  }
};

/// The norm of MATLAB's ODE suite: max_i |e_i| / max(|y_i|, |y_new,i|, atol_i / rtol), accepted when at most
/// rtol [shampine1997matlab]; here divided by rtol, squared.
template <class Real, class Atol>
struct WeightedMaximum {
  Real rtol;  ///< relative tolerance
  Atol atol;  ///< one number, or a vector of shape (n), in the units of the state

  /// max_i (e_i / max(rtol |y_i|, rtol |y_new,i|, atol_i))^2; NaN where an e_i is NaN.
  /// @param error  callable, error(i) = component i of the local error
  template <class State, class Error>
  Real squared(const State& y, const State& y_new, const Error& error) const {
    Real largest{0};
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      const Real weight =
          std::max({rtol * std::abs(y[i]), rtol * std::abs(y_new[i]), detail::atol_of(atol, i)});
      const Real e = Eigen::numext::abs2(error(i) / weight);
      // A comparison alone would overlook NaN.
      if (e > largest || std::isnan(e)) largest = e;
    }
    return largest;
  }
};

/// With one absolute tolerance, and with one for each component.
template <class Real>
using RmsNorm = WeightedRms<Real, Real>;
template <class Real>
using MatlabNorm = WeightedMaximum<Real, Real>;
template <class Real>
using ComponentRmsNorm = WeightedRms<Real, Eigen::Vector<Real, Eigen::Dynamic>>;
template <class Real>
using ComponentMatlabNorm = WeightedMaximum<Real, Eigen::Vector<Real, Eigen::Dynamic>>;

/// One of the first two, chosen at run time.
template <class Real>
struct AnyNorm {
  Real rtol, atol;
  bool matlab = false;  ///< MatlabNorm, else RmsNorm

  template <class State, class Error>
  Real squared(const State& y, const State& y_new, const Error& error) const {
    return matlab ? MatlabNorm<Real>{rtol, atol}.squared(y, y_new, error)
                  : RmsNorm<Real>{rtol, atol}.squared(y, y_new, error);
  }
};

}  // namespace hmax
