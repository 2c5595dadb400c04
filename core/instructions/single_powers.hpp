/// Logarithms and powers of two in single precision, the same on processors and devices.
//
// The tables and the order of operations are those of musl 1.2 (log2f.c, exp2f.c):
//
// Copyright (c) 2017-2018, Arm Limited.
// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>

#include "core/instructions/device_code.hpp"

namespace hmax {

/// log2(x), within 0.75 units of the last digit. @param x  positive, finite and not subnormal
HMAX_DEVICE inline float single_log2(float x) {
  struct Near {
    double inverse, log;  // of c near the middle of a sixteenth of an octave
  };
  static constexpr Near table[16] = {
      {0x1.661ec79f8f3bep0, -0x1.efec65b963019p-2}, {0x1.571ed4aaf883dp0, -0x1.b0b6832d4fca4p-2},
      {0x1.49539f0f010bp0, -0x1.7418b0a1fb77bp-2},  {0x1.3c995b0b80385p0, -0x1.39de91a6dcf7bp-2},
      {0x1.30d190c8864a5p0, -0x1.01d9bf3f2b631p-2}, {0x1.25e227b0b8eap0, -0x1.97c1d1b3b7afp-3},
      {0x1.1bb4a4a1a343fp0, -0x1.2f9e393af3c9fp-3}, {0x1.12358f08ae5bap0, -0x1.960cbbf788d5cp-4},
      {0x1.0953f419900a7p0, -0x1.a6f9db6475fcep-5}, {0x1p0, 0x0p0},
      {0x1.e608cfd9a47acp-1, 0x1.338ca9f24f53dp-4}, {0x1.ca4b31f026aap-1, 0x1.476a9543891bap-3},
      {0x1.b2036576afce6p-1, 0x1.e840b4ac4e4d2p-3}, {0x1.9c2d163a1aa2dp-1, 0x1.40645f0c6651cp-2},
      {0x1.886e6037841edp-1, 0x1.88e9c2c1b9ff8p-2}, {0x1.767dcf5534862p-1, 0x1.ce0a44eb17bccp-2}};
  const auto bits = std::bit_cast<std::uint32_t>(x);
  if (bits == 0x3f800000) return 0;  // no -0
  // x = 2^k z with z in [0x1.66p-1, 0x1.66p0).
  const std::uint32_t from = bits - 0x3f330000;
  const auto k = static_cast<std::int32_t>(from) >> 23;
  const double z = std::bit_cast<float>(bits - (from & 0xff800000));
  const Near& near = table[from >> 19 & 15];
  const double r = z * near.inverse - 1, r2 = r * r;
  const double low = 0x1.ecabf496832ep-2 * r + -0x1.715479ffae3dep-1;
  const double first = 0x1.715475f35c8b8p0 * r + (near.log + k);
  return static_cast<float>((-0x1.712b6f70a7e4dp-2 * r2 + low) * r2 + first);
}

/// 2^x, within 0.502 units of the last digit. @param x  |x| < 126
HMAX_DEVICE inline float single_exp2(float x) {
  // The bits of 2^(i/32), less i/32 in the exponent.
  static constexpr std::uint64_t table[32] = {
      0x3ff0000000000000, 0x3fefd9b0d3158574, 0x3fefb5586cf9890f, 0x3fef9301d0125b51, 0x3fef72b83c7d517b,
      0x3fef54873168b9aa, 0x3fef387a6e756238, 0x3fef1e9df51fdee1, 0x3fef06fe0a31b715, 0x3feef1a7373aa9cb,
      0x3feedea64c123422, 0x3feece086061892d, 0x3feebfdad5362a27, 0x3feeb42b569d4f82, 0x3feeab07dd485429,
      0x3feea47eb03a5585, 0x3feea09e667f3bcd, 0x3fee9f75e8ec5f74, 0x3feea11473eb0187, 0x3feea589994cce13,
      0x3feeace5422aa0db, 0x3feeb737b0cdc5e5, 0x3feec49182a3f090, 0x3feed503b23e255d, 0x3feee89f995ad3ad,
      0x3feeff76f2fb5e47, 0x3fef199bdd85529c, 0x3fef3720dcef9069, 0x3fef5818dcfba487, 0x3fef7c97337b9b5f,
      0x3fefa4afa2a490da, 0x3fefd0765b6e4540};
  // x = k/32 + r.
  constexpr double to_32nds = 0x1.8p47;
  const double shifted = x + to_32nds, r = x - (shifted - to_32nds), r2 = r * r;
  const auto k = std::bit_cast<std::uint64_t>(shifted);
  const double scale = std::bit_cast<double>(table[k & 31] + (k << 47));
  const double high = 0x1.c6af84b912394p-5 * r + 0x1.ebfce50fac4f3p-3;
  return static_cast<float>((high * r2 + (0x1.62e42ff0c52d6p-1 * r + 1)) * scale);
}

}  // namespace hmax
