/// The size of the very first step, guessed from the right-hand side.
#pragma once

#include <algorithm>
#include <cmath>

#include "integrators/state.hpp"
#include "integrators/tolerances.hpp"

namespace hmax {

/// The starting step of [hairer1993solving, II.4]: an explicit Euler step of h0 estimates the second
/// derivative, and h is chosen so that h^q max(|f|, |y''|) = 0.01. Two evaluations of f.
///   h0 = 0.01 |y| / |f|,   |y''| ~ |f(t + h0, y + h0 f) - f| / h0,
///   h = min(100 h0, (0.01 / max(|f|, |y''|))^(1/q))
/// @param error_order  q, order of the local error estimate
/// @param norm         RmsNorm or MatlabNorm, which carry the tolerances
/// @param span         t_end - t0, negative backwards
/// @returns the length of the step, > 0 and at most that of `span`
template <System Sys, class Norm>
real_of<typename Sys::State> hairer_initial_step(const Sys& system, real_of<typename Sys::State> t,
                                                 const typename Sys::State& y, int error_order,
                                                 const Norm& norm, real_of<typename Sys::State> span) {
  using State = typename Sys::State;
  using Real = real_of<State>;
  State f0 = y, f1 = y, y1 = y;
  system.rhs(t, y, f0);
  auto size_of = [&](auto&& component) { return std::sqrt(norm.squared(y, y, component)); };
  // |y| and |f| in units of the tolerances.
  const Real d0 = size_of([&](Eigen::Index i) { return y[i]; });
  const Real d1 = size_of([&](Eigen::Index i) { return f0[i]; });
  // 1e-6 where y or f says nothing.
  Real h0 = d0 < Real(1e-5) || d1 < Real(1e-5) ? Real(1e-6) : Real(0.01) * d0 / d1;
  if (!std::isfinite(h0)) h0 = Real(1e-6);
  const Real length = std::abs(span);
  h0 = std::min(h0, length);
  const Real step = span < 0 ? -h0 : h0;
  // Explicit Euler: y + h0 f(t, y).
  y1 = y + step * f0;
  system.rhs(t + step, y1, f1);
  const Real d2 = size_of([&](Eigen::Index i) { return (f1[i] - f0[i]) / h0; });
  const Real steepest = std::max(d1, d2);
  // Where f and y'' vanish: max(1e-6, h0 / 1000).
  const Real h1 = steepest <= Real(1e-15)
                      ? std::max(Real(1e-6), h0 * Real(1e-3))
                      : std::pow(Real(0.01) / steepest, Real(1) / static_cast<Real>(error_order));
  // Not far beyond the guess, and not beyond the end.
  const Real h = std::min({100 * h0, h1, length});
  return h > 0 && std::isfinite(h) ? h : h0;
}

/// The starting step of MATLAB's ode23 and ode45: h = 0.8 rtol^(1/q) / |f / max(|y|, atol/rtol)|_inf, at
/// most h_max [shampine1997matlab]. One evaluation of f.
/// @param error_order  q, order of the local error estimate
/// @param atol  a number, or one for each component
template <System Sys, class Atol>
real_of<typename Sys::State> matlab_initial_step(const Sys& system, real_of<typename Sys::State> t,
                                                 const typename Sys::State& y, int error_order,
                                                 real_of<typename Sys::State> rtol, const Atol& atol,
                                                 real_of<typename Sys::State> h_max) {
  using Real = real_of<typename Sys::State>;
  typename Sys::State f0 = y;
  system.rhs(t, y, f0);
  Real rate{0};
  for (Eigen::Index i = 0; i < y.size(); ++i)
    rate = std::max(rate, std::abs(f0[i]) / std::max(std::abs(y[i]), detail::atol_of(atol, i) / rtol));
  const Real h = Real(0.8) * std::pow(rtol, Real(1) / static_cast<Real>(error_order));
  // h_max where f = 0.
  return h_max * rate > h ? h / rate : h_max;
}

}  // namespace hmax
