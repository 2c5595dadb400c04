/// The `Lanes` of one tetrahedron or spring, for element_pull.hpp and element_stiffness.hpp. Not for sources
/// that are compiled for an instruction set.
#pragma once

#include <cmath>

#include "core/instructions/device_code.hpp"

namespace hmax {

template <class Real>
struct OneElement {
  using V = Real;
  HMAX_DEVICE static Real splat(double s) { return static_cast<Real>(s); }
  HMAX_DEVICE static Real load(const Real* p) { return *p; }
  HMAX_DEVICE static Real root(Real s) { return std::sqrt(s); }
  HMAX_DEVICE static bool any(bool mask) { return mask; }
};

}  // namespace hmax
