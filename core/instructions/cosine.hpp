/// The cosine and the sine of one number with the bits of musl, for the lanes of the processor and the
/// threads of devices.
//
// The coefficients and the order of operations are those of FDLIBM (e_rem_pio2.c, k_cos.c, k_sin.c), which
// musl has too:
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

namespace hmax::cosine_parts {

/// x = n pi/2 + y + rest with |y| <= pi/4.
struct Reduced {
  double y, rest;
  std::uint64_t n;  ///< in its lowest bits
};

constexpr double two_over_pi = 6.36619772367581382433e-01, to_integer = 0x1.8p52,
                 half_pi = 1.57079632673412561417e+00,  ///< its first 33 bits
    half_pi_rest = 6.07710050650619224932e-11,          ///< beyond them
    half_pi_next = 6.07710050630396597660e-11,          ///< the next 33 bits
    half_pi_next_rest = 2.02226624879595063154e-21,     ///< beyond them
    half_pi_third = 2.02226624871116645580e-21,         ///< the 33 bits after those
    half_pi_third_rest = 8.47842766036889956997e-32;

/// Angles from here on take more digits of pi than reduced_with_care() has [rad].
constexpr double far_angle = 0x1.921fbp20;

/// By rounding to the nearest n, in one step.
[[gnu::always_inline]] HMAX_DEVICE inline Reduced reduced(double x) {
  const double shifted = x * two_over_pi + to_integer, n = shifted - to_integer;
  const double r = x - n * half_pi, w = n * half_pi_rest, y = r - w;
  return {y, (r - y) - w, std::bit_cast<std::uint64_t>(shifted)};
}

/// Whether n is that of FDLIBM, which rounds by thresholds, and one step of its reduction is enough.
[[gnu::always_inline]] HMAX_DEVICE inline bool is_plain(double x, double y) {
  return (x < 32) & (std::abs(y) < 0.7853) & (std::abs(y) > 0x1p-11);
}

/// cos(y + rest), |y| <= pi/4.
[[gnu::always_inline]] HMAX_DEVICE inline double cosine_of(const Reduced& at) {
  constexpr double C1 = 4.16666666666666019037e-02, C2 = -1.38888888888741095749e-03,
                   C3 = 2.48015872894767294178e-05, C4 = -2.75573143513906633035e-07,
                   C5 = 2.08757232129817482790e-09, C6 = -1.13596475577881948265e-11;
  const double z = at.y * at.y, w = z * z;
  const double r = z * (C1 + z * (C2 + z * C3)) + w * w * (C4 + z * (C5 + z * C6));
  const double half = 0.5 * z, one = 1.0 - half;
  return one + (((1.0 - one) - half) + (z * r - at.y * at.rest));
}

constexpr double sine_first = -1.66666666666666324348e-01;
/// (sin(y) - y) / y^3 = sine_first + z times this, z = y^2.
[[gnu::always_inline]] HMAX_DEVICE inline double sine_series(double z) {
  constexpr double S2 = 8.33333333332248946124e-03, S3 = -1.98412698298579493134e-04,
                   S4 = 2.75573137070700676789e-06, S5 = -2.50507602534068634195e-08,
                   S6 = 1.58969099521155010221e-10;
  const double w = z * z;
  return S2 + z * (S3 + z * S4) + z * w * (S5 + z * S6);
}

/// sin(y + rest), |y| <= pi/4.
[[gnu::always_inline]] HMAX_DEVICE inline double sine_of(const Reduced& at) {
  const double z = at.y * at.y, v = z * at.y;
  return at.y - ((z * (0.5 * at.rest - v * sine_series(z)) - at.rest) - v * sine_first);
}

/// cos(x): cos, -sin, -cos, sin for n = 0, 1, 2, 3, chosen and signed by bits, so that no lane branches.
[[gnu::always_inline]] HMAX_DEVICE inline double cosine_at(const Reduced& at) {
  const std::uint64_t odd = -(at.n & 1), sign = ((at.n + 1) & 2) << 62;
  const auto c = std::bit_cast<std::uint64_t>(cosine_of(at)), s = std::bit_cast<std::uint64_t>(sine_of(at));
  return std::bit_cast<double>(((s & odd) | (c & ~odd)) ^ sign);
}

/// The bits 32 to 63.
HMAX_DEVICE inline std::uint32_t high_word(double x) {
  return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(x) >> 32);
}

/// As FDLIBM does: near 0 as it is, up to 9 pi/4 by thresholds, beyond and near multiples of pi/2 by rounding
/// and with further steps where digits cancel.
/// @param x  in [0, far_angle)
HMAX_DEVICE inline Reduced reduced_with_care(double x) {
  const std::uint32_t high = high_word(x);
  if (high <= 0x3fe921fb) return {x, 0, 0};
  double n = 0;
  if (high <= 0x4002d97c)  // 3 pi/4
    n = high == 0x3ff921fb ? 0 : 1;
  else if (high <= 0x400f6a7a)
    n = high == 0x400921fb ? 0 : 2;
  else if (high <= 0x4015fdbc)
    n = high == 0x4012d97c ? 0 : 3;
  else if (high <= 0x401c463b)
    n = high == 0x401921fb ? 0 : 4;
  const bool cancels = n == 0;
  if (cancels) n = (x * two_over_pi + to_integer) - to_integer;
  double r = x - n * half_pi, w = n * half_pi_rest;
  if (constexpr double quarter_pi = 0x1.921fb54442d18p-1; cancels && std::abs(r - w) > quarter_pi) {
    n += r - w < 0 ? -1 : 1;
    r = x - n * half_pi;
    w = n * half_pi_rest;
  }
  double y = r - w;
  const auto lost = [&] {
    return static_cast<int>(high >> 20) - static_cast<int>(high_word(y) >> 20 & 0x7ff);
  };
  const auto next = [&](double digits, double rest) {
    const double before = r;
    w = n * digits;
    r = before - w;
    w = n * rest - ((before - r) - w);
    y = r - w;
  };
  if (cancels && lost() > 16) {
    next(half_pi_next, half_pi_next_rest);
    if (lost() > 49) next(half_pi_third, half_pi_third_rest);
  }
  return {y, (r - y) - w, static_cast<std::uint64_t>(n)};
}

/// In one step where that is enough. @param x  in [0, far_angle)
HMAX_DEVICE inline Reduced reduced_anyhow(double x) {
  const Reduced at = reduced(x);
  return is_plain(x, at.y) ? at : reduced_with_care(x);
}

}  // namespace hmax::cosine_parts

namespace hmax {

/// cos(x) with the bits of musl. @param x  in (-far_angle, far_angle)
HMAX_DEVICE inline double cosine(double x) {
  return cosine_parts::cosine_at(cosine_parts::reduced_anyhow(std::abs(x)));
}

/// sin(x), likewise.
HMAX_DEVICE inline double sine(double x) {
  using namespace cosine_parts;
  const double size = std::abs(x);
  if (size < 0x1p-26) return x;
  if (high_word(size) <= 0x3fe921fb) {  // up to pi/4, without a rest
    const double z = x * x;
    return x + z * x * (sine_first + z * sine_series(z));
  }
  const Reduced at = reduced_anyhow(size);
  const double found = (at.n & 1) != 0 ? cosine_of(at) : sine_of(at);
  return ((at.n & 2) != 0) != (x < 0) ? -found : found;
}

}  // namespace hmax
