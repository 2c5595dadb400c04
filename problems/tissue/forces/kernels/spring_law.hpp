/// The laws of springs that the kernels have.
#pragma once

#include "core/instructions/device_code.hpp"

namespace hmax {

/// phi = s.
struct LinearSpring {
  [[nodiscard]] double phi(double s) const { return s; }
  [[nodiscard]] double slope(double) const { return 1; }
  [[nodiscard]] double integral(double s) const { return s * s / 2; }
};

/// phi = s + b s^3: with b > 0 stiffer the more it is stretched or pressed.
struct CubicSpring {
  double b = 1;
  [[nodiscard]] HMAX_DEVICE double phi(double s) const { return s * (1 + b * s * s); }
  [[nodiscard]] HMAX_DEVICE double slope(double s) const { return 1 + 3 * b * s * s; }
  [[nodiscard]] double integral(double s) const { return s * s * (2 + b * s * s) / 4; }
};

}  // namespace hmax
