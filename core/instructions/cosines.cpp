// The coefficients and the order of operations are those of FDLIBM (e_rem_pio2.c, k_cos.c, k_sin.c), which
// musl has too:
//
// Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
// Developed at SunSoft, a Sun Microsystems, Inc. business.
// Permission to use, copy, modify, and distribute this software is freely granted, provided that this notice
// is preserved.
#include "core/instructions/cosines.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/instructions/compiled_for.hpp"

namespace hmax {

namespace {

/// x = n pi/2 + y + rest with |y| <= pi/4.
struct Reduced {
  double y, rest;
  std::uint64_t n;  ///< in its lowest bits
};

[[gnu::always_inline]] inline Reduced reduced(double x) {
  constexpr double two_over_pi = 6.36619772367581382433e-01, to_integer = 0x1.8p52,
                   half_pi = 1.57079632673412561417e+00,  // its first 33 bits
      half_pi_rest = 6.07710050650619224932e-11;
  const double shifted = x * two_over_pi + to_integer, n = shifted - to_integer;
  const double r = x - n * half_pi, w = n * half_pi_rest, y = r - w;
  return {y, (r - y) - w, std::bit_cast<std::uint64_t>(shifted)};
}

/// Whether n is that of FDLIBM, which rounds by thresholds, and one step of its reduction is enough.
[[gnu::always_inline]] inline bool is_plain(double x, double y) {
  return (x < 32) & (std::abs(y) < 0.7853) & (std::abs(y) > 0x1p-11);
}

/// cos(y + rest), |y| <= pi/4.
[[gnu::always_inline]] inline double cosine_of(const Reduced& at) {
  constexpr double C1 = 4.16666666666666019037e-02, C2 = -1.38888888888741095749e-03,
                   C3 = 2.48015872894767294178e-05, C4 = -2.75573143513906633035e-07,
                   C5 = 2.08757232129817482790e-09, C6 = -1.13596475577881948265e-11;
  const double z = at.y * at.y, w = z * z;
  const double r = z * (C1 + z * (C2 + z * C3)) + w * w * (C4 + z * (C5 + z * C6));
  const double half = 0.5 * z, one = 1.0 - half;
  return one + (((1.0 - one) - half) + (z * r - at.y * at.rest));
}

/// sin(y + rest), |y| <= pi/4.
[[gnu::always_inline]] inline double sine_of(const Reduced& at) {
  constexpr double S1 = -1.66666666666666324348e-01, S2 = 8.33333333332248946124e-03,
                   S3 = -1.98412698298579493134e-04, S4 = 2.75573137070700676789e-06,
                   S5 = -2.50507602534068634195e-08, S6 = 1.58969099521155010221e-10;
  const double z = at.y * at.y, w = z * z, v = z * at.y;
  const double r = S2 + z * (S3 + z * S4) + z * w * (S5 + z * S6);
  return at.y - ((z * (0.5 * at.rest - v * r) - at.rest) - v * S1);
}

/// Numbers that go through vector registers together: two of the widest kind.
constexpr std::size_t block = 16;

/// out = cos(x) where is_plain(); whether that is everywhere.
[[gnu::always_inline]] inline bool plain_cosines(const double* __restrict x, double* __restrict out) {
  std::uint64_t others = 0;
  for (std::size_t i = 0; i < block; ++i) {
    const double size = std::abs(x[i]);
    const Reduced at = reduced(size);
    // cos, -sin, -cos, sin for n = 0, 1, 2, 3: chosen and signed by bits, so that no lane branches.
    const std::uint64_t odd = -(at.n & 1), sign = ((at.n + 1) & 2) << 62;
    const auto c = std::bit_cast<std::uint64_t>(cosine_of(at)), s = std::bit_cast<std::uint64_t>(sine_of(at));
    out[i] = std::bit_cast<double>(((s & odd) | (c & ~odd)) ^ sign);
    others |= is_plain(size, at.y) ? 0 : 1;
  }
  return others == 0;
}

/// The cosines of a block.
[[gnu::always_inline]] inline void block_of_cosines(const double* __restrict x, double* __restrict out) {
  if (!plain_cosines(x, out))
    for (std::size_t i = 0; i < block; ++i)
      if (const double size = std::abs(x[i]); !is_plain(size, reduced(size).y)) out[i] = std::cos(size);
}

/// One block after the other; the last one is filled up.
[[gnu::always_inline]] inline void cosines_in_blocks(std::span<const double> x, std::span<double> out) {
  const std::size_t rest = x.size() % block, whole = x.size() - rest;
  for (std::size_t first = 0; first < whole; first += block)
    block_of_cosines(x.data() + first, out.data() + first);
  if (rest == 0) return;
  std::array<double, block> last, found;
  last.fill(1);
  std::copy_n(x.data() + whole, rest, last.data());
  block_of_cosines(last.data(), found.data());
  std::copy_n(found.data(), rest, out.data() + whole);
}

}  // namespace

void cosines(std::span<const double> x, std::span<double> out, InstructionSet set) {
  if (HMAX_HAVE_MUSL)
    CompiledFor<cosines_in_blocks>::of(set)(x, out);
  else
    std::ranges::transform(x, out.begin(), [](double each) { return std::cos(each); });
}

}  // namespace hmax
