/// How large a local error is, in units of what the user tolerates. The only place that weighs errors.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/instructions/device_code.hpp"
#include "core/instructions/piece_sums.hpp"
#include "integrators/state.hpp"
#include "integrators/tolerances.hpp"

namespace hmax {

/// What a norm makes of the weighted squares of all components: it takes up those of each piece one after the
/// other, and then what the pieces come to, so that devices, which have all pieces at once, have the same
/// bits.
/// @tparam Norm   WeightedRms or MatlabNorm
/// @param error   callable, error(i) = component i of the local error
template <class Norm, class State, class Error>
HMAX_DEVICE auto squared_by_pieces(const Norm& norm, const State& y, const State& y_new, const Error& error) {
  using Real = decltype(norm.rtol);
  const Eigen::Index n = y.size();
  const auto of_piece = [&](Eigen::Index first, Eigen::Index end) {
    Real part{0};
    for (Eigen::Index i = first; i < end; ++i) norm.take(norm.square(i, y[i], y_new[i], error(i)), part);
    return part;
  };
  if (n <= piece_size) return norm.of_all(of_piece(0, n), n);
  Real all{0};
  for (Eigen::Index first = 0; first < n; first += piece_size)
    norm.take(of_piece(first, std::min<Eigen::Index>(first + piece_size, n)), all);
  return norm.of_all(all, n);
}

/// Root mean square of e_i / (atol_i + rtol max(|y_i|, |y_new,i|)) [hairer1993solving, II.4]. Norms are kept
/// squared: the loop then needs no square root.
/// @tparam Atol  Real, the same for all components, or a vector with one for each
template <class Real, class Atol>
struct WeightedRms {
  Real rtol;  ///< relative tolerance
  Atol atol;  ///< one number, or a vector of shape (n), in the units of the state

  /// (1/n) sum_i (e_i / (atol_i + rtol max(|y_i|, |y_new,i|)))^2; NaN where an e_i is NaN.
  template <class State, class Error>
  HMAX_DEVICE Real squared(const State& y, const State& y_new, const Error& error) const {
    return squared_by_pieces(*this, y, y_new, error);
  }

  /// The square of component i; sums of squares; the norm of such a sum.
  template <class Scalar, class Error>
  HMAX_DEVICE Real square(Eigen::Index i, const Scalar& y, const Scalar& y_new, const Error& error) const {
    const Real weight = detail::atol_of(atol, i) + rtol * std::max(std::abs(y), std::abs(y_new));
    return Eigen::numext::abs2(error / weight);
  }
  HMAX_DEVICE static void take(Real square, Real& sum) { sum += square; }
  HMAX_DEVICE static Real of_all(Real sum, Eigen::Index n) { return sum / static_cast<Real>(n); }
};

/// The norm of MATLAB's ODE suite: max_i |e_i| / max(|y_i|, |y_new,i|, atol / rtol), accepted when at most
/// rtol [shampine1997matlab]; here divided by rtol, squared.
template <class Real>
struct MatlabNorm {
  Real rtol;  ///< relative tolerance
  Real atol;  ///< in the units of the state

  /// max_i (e_i / max(rtol |y_i|, rtol |y_new,i|, atol))^2; NaN where an e_i is NaN.
  template <class State, class Error>
  Real squared(const State& y, const State& y_new, const Error& error) const {
    return squared_by_pieces(*this, y, y_new, error);
  }

  /// The square of component i; the larger of them; the norm of the largest.
  template <class Scalar, class Error>
  HMAX_DEVICE Real square(Eigen::Index, const Scalar& y, const Scalar& y_new, const Error& error) const {
    const Real weight = std::max(std::max(rtol * std::abs(y), rtol * std::abs(y_new)), atol);
    return Eigen::numext::abs2(error / weight);
  }
  HMAX_DEVICE static void take(Real square, Real& largest) {
    // A comparison alone would overlook NaN.
    if (square > largest || std::isnan(square)) largest = square;
  }
  HMAX_DEVICE static Real of_all(Real largest, Eigen::Index) { return largest; }
};

/// With one absolute tolerance, and with one for each component.
template <class Real>
using RmsNorm = WeightedRms<Real, Real>;
template <class Real>
using ComponentRmsNorm = WeightedRms<Real, Eigen::Vector<Real, Eigen::Dynamic>>;

/// RmsNorm or MatlabNorm, chosen at run time.
template <class Real>
struct AnyNorm {
  Real rtol, atol;
  bool matlab = false;  ///< MatlabNorm, else RmsNorm

  template <class State, class Error>
  Real squared(const State& y, const State& y_new, const Error& error) const {
    return visit([&](const auto& norm) { return norm.squared(y, y_new, error); });
  }
  /// f(norm) of the one that is chosen.
  template <class F>
  decltype(auto) visit(const F& f) const {
    return matlab ? f(MatlabNorm<Real>{rtol, atol}) : f(RmsNorm<Real>{rtol, atol});
  }
};

}  // namespace hmax
