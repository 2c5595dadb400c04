/// The laws of springs that the kernels and devices have.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/instructions/device_code.hpp"
#include "core/instructions/exponential.hpp"

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

/// phi = (exp(b s) - 1) / b, the law of soft tissue in tension; pressed it gives way towards -1 / b.
/// @source  [fung1993biomechanics]
struct ExponentialSpring {
  double b = 5;  ///< not 0
  [[nodiscard]] HMAX_DEVICE double phi(double s) const { return exponential_less_one(b * s) / b; }
  [[nodiscard]] HMAX_DEVICE double slope(double s) const { return exponential(b * s); }
  [[nodiscard]] double integral(double s) const {
    // (exp(x) - 1 - x) / b^2, whose first terms cancel for small x.
    const double x = b * s;
    if (std::abs(x) < 1e-2)
      return s * s * (1 + x / 3 * (1 + x / 4 * (1 + x / 5 * (1 + x / 6 * (1 + x / 7))))) / 2;
    return (exponential_less_one(x) - x) / (b * b);
  }
};

/// phi of straight lines through points, prolonged beyond the first and the last: what TableSpring has.
template <class Real>
struct SpringLines {
  const Real *strain, *value, *rise;  ///< of each line: where it begins, ascending, phi there, its slope
  std::int32_t count;                 ///< at least 1

  /// The last line that begins at s or before; the first where there is none.
  [[nodiscard]] HMAX_DEVICE std::int32_t line(Real s) const {
    return static_cast<std::int32_t>(std::upper_bound(strain + 1, strain + count, s) - strain) - 1;
  }
  [[nodiscard]] HMAX_DEVICE Real phi(Real s) const {
    const std::int32_t i = line(s);
    return value[i] + rise[i] * (s - strain[i]);
  }
  [[nodiscard]] HMAX_DEVICE Real slope(Real s) const { return rise[line(s)]; }
};

}  // namespace hmax
