/// How fast the fastest part of a system is: the spectral radius of df/dy without df/dy.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "integrators/state.hpp"

namespace hmax {

/// The spectral radius of J = df/dy at (t, y) by the nonlinear power method of [sommeijer1998rkc]: with
/// directions e_k of length one and small d,
///   J e_k ~ (f(t, y + d e_k) - f(t, y)) / d = sigma e_{k+1},
/// until the estimate settles to one per cent; the result is a fifth larger, so that it is likely a bound.
/// Two things are added. The first direction holds a little of every component, so that a solution that moves
/// in one slow mode does not hide the fast ones. And the estimate is not sigma, which never settles where the
/// largest eigenvalues are a complex pair, as in every oscillator, but the larger root of the recurrence
/// J^2 e_{k-1} ~ p J e_{k-1} + q e_{k-1}.
/// @cost  one evaluation of f an iteration, 3 to 50 of them, some more for the first estimate than for later
///        ones, which start from the direction of the last
template <class State>
class SpectralRadius {
 public:
  using Real = real_of<State>;
  static constexpr int max_iterations = 50;
  static constexpr double margin = 1.2;  ///< of the result over the estimate

  /// Forgets the direction of the run before.
  template <System Sys>
  void init(const Sys& system) {
    const Eigen::Index n = system.dim();
    for (State* vector : {&direction_, &before_, &argument_, &slope_}) vector->resize(n);
    direction_.setZero();
    radius_ = 0;
  }

  /// @param f0  f(t, y), shape (n)
  /// @returns   an estimate of the radius, a fifth too large [1/s]; the one before when f is not finite
  /// nearby
  template <System Sys>
  Real estimate(const Sys& system, Real t, const State& y, const State& f0) {
    using std::abs, std::sqrt;
    first_direction(f0);
    // Length of the difference: sqrt(eps) max(|y|, 1e-6 |f|).
    const Real y_norm = y.norm(), f_norm = f0.norm();
    Real d = sqrt(std::numeric_limits<Real>::epsilon());
    if (const Real size = std::max(y_norm, Real(1e-6) * f_norm); size > 0) d *= size;
    before_ = direction_;
    Real sigma_before{0}, pair_before{0};
    for (int iteration = 1; iteration <= max_iterations; ++iteration) {
      argument_ = y + d * direction_;
      system.rhs(t, argument_, slope_);
      slope_ -= f0;
      // |f(t, y + d e_k) - f(t, y)| / d = sigma
      const Real length = slope_.norm(), sigma = length / d;
      if (!std::isfinite(sigma)) return radius_;
      if (length == 0) {
        // f does not see this direction; turn to another one.
        if (iteration > y.size()) return radius_ = 0;
        direction_.setZero();
        direction_[iteration % y.size()] = 1;
        continue;
      }
      slope_ /= length;
      // The larger root of the recurrence: it settles for a complex pair too, where sigma does not.
      const Real pair = pair_modulus(sigma_before, sigma);
      const auto settled = [](Real a, Real b) { return abs(a - b) <= Real(0.01) * a; };
      before_.swap(direction_);
      direction_.swap(slope_);
      if (iteration > 2 && settled(pair, pair_before)) {
        const bool is_real = settled(sigma, sigma_before);
        return radius_ = static_cast<Real>(margin) * (is_real ? std::max(sigma, pair) : pair);
      }
      sigma_before = sigma;
      pair_before = pair;
    }
    return radius_ = static_cast<Real>(margin) * std::max(sigma_before, pair_before);
  }

  /// What it carries between accepted steps, see saved_state.hpp.
  void visit_state(auto& visit) { visit(direction_, radius_); }

 private:
  /// The direction of the last estimate, or that of f, with a tenth of a vector that has a part in every
  /// component; of length one.
  void first_direction(const State& f0) {
    if (direction_.squaredNorm() == 0) {
      const Real length = f0.norm();
      if (length > 0 && std::isfinite(length)) direction_ = f0 / length;
    }
    // A component of random sign and at most 0.2 / sqrt(n), by a linear congruential generator.
    const Real part = Real(0.2) / std::sqrt(static_cast<Real>(direction_.size()));
    std::uint32_t random = 1;
    for (Eigen::Index i = 0; i < direction_.size(); ++i) {
      random = 1664525U * random + 1013904223U;
      direction_[i] += part * (static_cast<Real>(random) / Real(2147483648.0) - 1);
    }
    direction_.normalize();
  }

  /// The larger modulus of the roots of x^2 = p x + q, where J^2 e_{k-1} = p J e_{k-1} + q e_{k-1} in least
  /// squares; J e_{k-1} = sigma_before e_k and J e_k = sigma e_{k+1}, which slope_ holds.
  Real pair_modulus(Real sigma_before, Real sigma) const {
    using std::abs, std::sqrt;
    if constexpr (Eigen::NumTraits<typename State::Scalar>::IsComplex)
      return sigma;
    else {
      // Normal equations with g = e_k . e_{k-1}, r1 = e_{k+1} . e_k, r0 = e_{k+1} . e_{k-1}.
      const Real g = before_.dot(direction_), r1 = slope_.dot(direction_), r0 = slope_.dot(before_);
      const Real determinant = 1 - g * g;
      if (!(determinant > Real(1e-6)) || sigma_before == 0) return sigma;
      // J^2 e_{k-1} = p J e_{k-1} + q e_{k-1}, in the plane of e_k and e_{k-1}
      const Real p = sigma * (r1 - g * r0) / determinant;
      const Real q = sigma_before * sigma * (r0 - g * r1) / determinant;
      // Roots (p +- sqrt(p^2 + 4 q)) / 2; a complex pair has the modulus sqrt(-q).
      const Real discriminant = p * p + 4 * q;
      return discriminant < 0 ? sqrt(-q) : (abs(p) + sqrt(discriminant)) / 2;
    }
  }

  /// e_k, e_{k-1}, y + d e_k, and its slope, shape (n).
  State direction_ = blank_state<State>(), before_ = direction_, argument_ = direction_, slope_ = direction_;
  Real radius_ = 0;  ///< result of the last estimate [1/s]
};

}  // namespace hmax
