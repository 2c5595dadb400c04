/// The cubic polynomial through both ends of a step, for methods without continuous output of their own.
#pragma once

#include "integrators/state.hpp"

namespace hmax {

/// u(theta) with u(0) = y0, u(1) = y1, u'(0) = d0, u'(1) = d1 [hairer1993solving, II.6]:
///   u = (1 - theta) y0 + theta y1 + theta (1 - theta) ((2 theta - 1)(y1 - y0) + (1 - theta) d0 - theta d1),
/// exactly y0 and y1 at the ends. Its error is O(h^4) of the solution's fourth derivative.
/// @param y0, y1, d0, d1  numbers, or vectors of the same shape; of these the result is an expression
template <class Real, class Y0, class Y1, class D0, class D1>
inline auto hermite(Real theta, const Y0& y0, const Y1& y1, const D0& d0, const D1& d1) {
  const Real rest = Real(1) - theta;
  return rest * y0 + theta * y1 +
         (theta * rest) * ((Real(2) * theta - Real(1)) * (y1 - y0) + rest * d0 - theta * d1);
}

/// out = u(theta) for a step of size h with the slopes f0, f1 at its ends, d0 = h f0 and d1 = h f1. `out`
/// is none of the others.
template <class State>
void hermite_step(real_of<State> h, const State& y0, const State& y1, const State& f0, const State& f1,
                  real_of<State> theta, State& out) {
  detail::assign(out, [&](auto access) {
    return hermite(theta, access(y0), access(y1), h * access(f0), h * access(f1));
  });
}

}  // namespace hmax
