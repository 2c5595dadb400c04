/// The cubic polynomial through both ends of a step, for methods without continuous output of their own.
#pragma once

#include "integrators/state.hpp"

namespace hmax {

/// out = u(theta) with u(0) = y0, u(1) = y1, u'(0) = h f0, u'(1) = h f1 [hairer1993solving, II.6]:
///   u = y0 + theta ((y1 - y0) theta (3 - 2 theta) + h (1 - theta) ((1 - theta) f0 - theta f1)).
/// Its error is O(h^4) of the solution's fourth derivative. `out` is none of the others.
template <class State>
void hermite(real_of<State> h, const State& y0, const State& y1, const State& f0, const State& f1,
             real_of<State> theta, State& out) {
  using Real = real_of<State>;
  const Real rest = 1 - theta;
  const Real d = theta * theta * (3 - 2 * theta), a = h * theta * rest * rest, b = -h * theta * theta * rest;
  detail::assign(out, [&](auto access) {
    return access(y0) + (d * (access(y1) - access(y0)) + (a * access(f0) + b * access(f1)));
  });
}

}  // namespace hmax
