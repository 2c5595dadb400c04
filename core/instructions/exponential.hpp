/// exp(x) - 1 and exp(x) from one reduction, the same on processors and devices.
//
// The coefficients and the order of operations are those of FDLIBM (s_expm1.c), which musl has too:
//
// Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
// Developed at SunSoft, a Sun Microsystems, Inc. business.
// Permission to use, copy, modify, and distribute this software is freely granted, provided that this notice
// is preserved.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/instructions/device_code.hpp"

namespace hmax {

namespace exponential_parts {

/// exp(x) = 2^k (1 + (r - e)), |r| <= 0.35.
struct Reduced {
  double r, e;
  std::int32_t k;
};

/// Beyond these exp(x) is infinite, or too small for a normal number.
constexpr double most = 7.09782712893383973096e+02, least = -7.08396418532264106224e+02;

/// @param x  finite, |x| < 710
[[gnu::always_inline]] HMAX_DEVICE inline Reduced reduced(double x) {
  constexpr double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10,
                   per_ln2 = 1.44269504088896338700e+00;
  constexpr double Q1 = -3.33333333333331316428e-02, Q2 = 1.58730158725481460165e-03,
                   Q3 = -7.93650757867487942473e-05, Q4 = 4.00821782732936239552e-06,
                   Q5 = -2.01099218183624371326e-07;
  const auto high = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(x) >> 32) & 0x7fffffff;
  std::int32_t k = 0;
  if (high > 0x3fd62e42)  // ln(2) / 2; up to 3/2 ln(2) by one
    k = high < 0x3ff0a2b2 ? (x < 0 ? -1 : 1) : static_cast<std::int32_t>(per_ln2 * x + (x < 0 ? -0.5 : 0.5));
  const double upper = x - k * ln2_high, lower = k * ln2_low, r = upper - lower, lost = (upper - r) - lower;
  const double half = 0.5 * r, z = r * half;
  const double q = 1.0 + z * (Q1 + z * (Q2 + z * (Q3 + z * (Q4 + z * Q5))));
  const double t = 3.0 - q * half, ratio = z * ((q - t) / (6.0 - r * t));
  return {r, k == 0 ? r * ratio - z : (r * (ratio - lost) - lost) - z, k};
}

/// 2^k. @param k  of a normal number
HMAX_DEVICE inline double power_of_two(std::int32_t k) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(0x3ff + k) << 52);
}

/// 2^k (1 + (r - e)), also of k = 1024.
HMAX_DEVICE inline double scaled(const Reduced& at) {
  const double y = (at.r - at.e) + 1.0;
  return at.k == 1024 ? y * 2.0 * 0x1p1023 : y * power_of_two(at.k);
}

}  // namespace exponential_parts

/// exp(x) - 1 with the bits of musl, within 1 unit of the last digit.
HMAX_DEVICE inline double exponential_less_one(double x) {
  if (!(std::abs(x) > 0x1p-54)) return x;  // also no number
  if (x > exponential_parts::most) return x * 0x1p1023;
  if (x < -38.8) return -1;
  const exponential_parts::Reduced at = exponential_parts::reduced(x);
  const auto& [r, e, k] = at;
  if (k == 0) return r - e;
  if (k == -1) return 0.5 * (r - e) - 0.5;
  if (k == 1) return r < -0.25 ? -2.0 * (e - (r + 0.5)) : 1.0 + 2.0 * (r - e);
  if (k < 0 || k > 56) return exponential_parts::scaled(at) - 1.0;
  const double shift = exponential_parts::power_of_two(-k);
  return (k < 20 ? (r - e) + (1 - shift) : (r - (e + shift)) + 1) * exponential_parts::power_of_two(k);
}

/// exp(x) within 1 unit of the last digit; 0 where it is smaller than normal numbers.
HMAX_DEVICE inline double exponential(double x) {
  if (!(std::abs(x) > 0x1p-54)) return 1.0 + x;  // also no number
  if (x > exponential_parts::most) return x * 0x1p1023;
  if (x < exponential_parts::least) return 0;
  return exponential_parts::scaled(exponential_parts::reduced(x));
}

}  // namespace hmax
