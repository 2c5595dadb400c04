/// The size of the very first step, guessed from the right-hand side, and the longest step of a run.
#pragma once

#include <algorithm>
#include <cmath>

#include "integrators/state.hpp"
#include "integrators/tolerances.hpp"

namespace hmax {

/// The longest step of a run: h_max where it is given, else a tenth of the span, as in MATLAB's suite
/// [shampine1997matlab]. Forces that come and go within a few steps are seen then.
/// @param h_max  infinity: not given
/// @param span   t_end - t0, negative backwards
template <class Real>
Real longest_step(Real h_max, Real span) {
  return std::isfinite(h_max) ? h_max : std::abs(span) / 10;
}

namespace detail {
/// A start is at rest where f would change the state by less than this share of its tolerance in the whole
/// span: such an f says nothing about the step.
template <class Real>
inline constexpr Real resting_share = Real(0.01);
}  // namespace detail

/// Whether the state is at rest at the start.
/// @param rate  |f(t_0, y_0)| in units of the tolerances [1 / unit of time]
template <class Real>
bool starts_at_rest(Real rate, Real span) {
  return rate * std::abs(span) < detail::resting_share<Real>;
}

/// The first step from a state at rest: f(t, y) is looked at between 1e-8 of `longest` and `longest`, and the
/// step ends before the first of these times t_0 + x with x |f| > 0.01. What begins to act there is then seen
/// by the error test of a later step, which has grown from this one. 16 evaluations of f; none where f does
/// not depend on time.
/// @param size     size(v) is |v| in units of the tolerances
/// @param span     t_end - t0, negative backwards
/// @param longest  > 0
template <System Sys, class Size>
real_of<typename Sys::State> first_step_from_rest(const Sys& system, real_of<typename Sys::State> t,
                                                  const typename Sys::State& y, const Size& size,
                                                  real_of<typename Sys::State> span,
                                                  real_of<typename Sys::State> longest) {
  using Real = real_of<typename Sys::State>;
  if (is_autonomous(system)) return longest;
  // No two times have a simple ratio, so that a sine is not met at its zeros alone.
  constexpr int looks = 16;
  constexpr Real closer = Real(0.3183), last = Real(0.9369);
  const Real direction = span < 0 ? Real(-1) : Real(1);
  const Real end = std::min(longest, std::abs(span));
  typename Sys::State f = y;
  Real quiet = end * last * std::pow(closer, Real(looks - 1));
  for (int k = looks - 1; k >= 0; --k) {
    const Real x = end * last * std::pow(closer, static_cast<Real>(k));
    system.rhs(t + direction * x, y, f);
    // Also where f is not finite.
    if (!(size(f) * x <= detail::resting_share<Real>)) return quiet;
    quiet = x;
  }
  return longest;
}

/// The starting step of [hairer1993solving, II.4]: an explicit Euler step of h0 estimates the second
/// derivative, and h is chosen so that h^q max(|f|, |y''|) = 0.01. Two evaluations of f.
///   h0 = 0.01 |y| / |f|,   |y''| ~ |f(t + h0, y + h0 f) - f| / h0,
///   h = min(100 h0, (0.01 / max(|f|, |y''|))^(1/q), longest)
/// Where |y| is zero h0 is a millionth of the span; where f is, see first_step_from_rest(). The power depends
/// on the unit of time: that is the unit of the system, or the span where that is shorter.
/// @param error_order  q, order of the local error estimate
/// @param norm         RmsNorm or MatlabNorm, which carry the tolerances
/// @param span         t_end - t0, negative backwards
/// @param longest      of a step, > 0
/// @returns the length of the step, > 0 and at most `longest` and that of `span`
template <System Sys, class Norm>
real_of<typename Sys::State> hairer_initial_step(const Sys& system, real_of<typename Sys::State> t,
                                                 const typename Sys::State& y, int error_order,
                                                 const Norm& norm, real_of<typename Sys::State> span,
                                                 real_of<typename Sys::State> longest) {
  using State = typename Sys::State;
  using Real = real_of<State>;
  State f0 = y, f1 = y, y1 = y;
  system.rhs(t, y, f0);
  auto size_of = [&](const State& v) {
    return std::sqrt(norm.squared(y, y, [&](Eigen::Index i) { return v[i]; }));
  };
  const Real length = std::abs(span), most = std::min(longest, length);
  // |y| and |f| in units of the tolerances.
  const Real d0 = size_of(y), d1 = size_of(f0);
  if (starts_at_rest(d1, span))
    return std::min(first_step_from_rest(system, t, y, size_of, span, longest), most);
  // A millionth of the span where y or f says nothing.
  const Real millionth = length * Real(1e-6);
  Real h0 = d0 < Real(1e-5) ? millionth : Real(0.01) * d0 / d1;
  if (!(std::isfinite(h0) && h0 > 0)) h0 = millionth;
  h0 = std::min(h0, most);
  const Real step = span < 0 ? -h0 : h0;
  // Explicit Euler: y + h0 f(t, y).
  y1 = y + step * f0;
  system.rhs(t + step, y1, f1);
  y1 = f1 - f0;
  const Real d2 = size_of(y1) / h0;
  const Real unit = std::min(length, Real(1));
  const Real steepest = std::max(d1 * unit, d2 * unit * unit);
  const Real h1 = unit * std::pow(Real(0.01) / steepest, Real(1) / static_cast<Real>(error_order));
  // Not far beyond the guess, and not beyond the end.
  const Real h = std::min({100 * h0, h1, most});
  return h > 0 && std::isfinite(h) ? h : h0;
}

/// The starting step of MATLAB's ode23 and ode45: h = 0.8 rtol^(1/q) / |f / max(|y|, atol/rtol)|_inf, at
/// most `longest` [shampine1997matlab]. One evaluation of f; where f says nothing, which MATLAB answers with
/// the longest step, see first_step_from_rest().
/// @param error_order  q, order of the local error estimate
/// @param atol  a number, or one for each component
/// @param span  t_end - t0, negative backwards
template <System Sys, class Atol>
real_of<typename Sys::State> matlab_initial_step(const Sys& system, real_of<typename Sys::State> t,
                                                 const typename Sys::State& y, int error_order,
                                                 real_of<typename Sys::State> rtol, const Atol& atol,
                                                 real_of<typename Sys::State> span,
                                                 real_of<typename Sys::State> longest) {
  using State = typename Sys::State;
  using Real = real_of<State>;
  State f0 = y;
  system.rhs(t, y, f0);
  // |v / max(|y|, atol/rtol)|_inf
  const auto relative = [&](const State& v) {
    Real largest{0};
    for (Eigen::Index i = 0; i < y.size(); ++i)
      largest = std::max(largest, std::abs(v[i]) / std::max(std::abs(y[i]), detail::atol_of(atol, i) / rtol));
    return largest;
  };
  const Real rate = relative(f0);
  if (starts_at_rest(rate / rtol, span))
    return first_step_from_rest(
        system, t, y, [&](const State& v) { return relative(v) / rtol; }, span, longest);
  const Real h = Real(0.8) * std::pow(rtol, Real(1) / static_cast<Real>(error_order));
  return longest * rate > h ? h / rate : longest;
}

}  // namespace hmax
