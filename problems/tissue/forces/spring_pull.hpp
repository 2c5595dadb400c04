/// The forces of springs: the one source of processors and devices, as green_pull.hpp has those of
/// tetrahedra.
#pragma once

#include "core/instructions/device_code.hpp"
#include "problems/tissue/forces/green_pull.hpp"

namespace hmax::kernel_loops {

/// T / l = k L (s + b s^3) / l as k L (1 / L - 1 / l) (1 + b s^2) with s = l / L - 1, where d leads from the
/// near to the far end. Points that coincide have d = 0 and meet no force. `Lanes` has root(v), too.
/// @param length_inverse, tension  where 1 / L [1/m] and k L [N] stand, for Lanes::load()
template <class Lanes, bool cubic, class V>
HMAX_DEVICE inline V spring_pull(const double* length_inverse, const double* tension, V b, const V* d) {
  const V one = Lanes::splat(1), now = Lanes::root(dot<Lanes>(d, d) + Lanes::splat(1e-300));
  const V per_length = Lanes::load(length_inverse);
  const V pull = Lanes::load(tension) * (per_length - one / now);
  if constexpr (!cubic) return pull;
  const V s = now * per_length - one;
  return pull * (one + b * (s * s));
}

}  // namespace hmax::kernel_loops
