/// Products of 3 x 3 matrices, for the laws of elements. `Lanes` as element_pull.hpp has it.
#pragma once

#include "core/instructions/device_code.hpp"

namespace hmax::kernel_loops {

/// The place of entry (i, j) of a symmetric matrix stored as 00 11 22 01 02 12.
HMAX_DEVICE constexpr int symmetric(int i, int j) { return i == j ? i : i + j + 2; }

/// a.b
template <class Lanes>
HMAX_DEVICE inline typename Lanes::V dot(const typename Lanes::V* a, const typename Lanes::V* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// a x b
template <class V>
HMAX_DEVICE inline void cross(const V* a, const V* b, V* to) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    to[i] = a[j] * b[k] - a[k] * b[j];
  }
}

/// The cofactors of H.
template <class V>
HMAX_DEVICE inline void cofactors_of(const V (*H)[3], V (*K)[3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      K[i][j] = H[i1][j1] * H[i2][j2] - H[i1][j2] * H[i2][j1];
    }
}

/// det(I + H) - 1 and the cofactors K of H.
template <class Lanes, class V>
HMAX_DEVICE inline V volume_change(const V (*H)[3], V trace, V (*K)[3]) {
  cofactors_of<V>(H, K);
  return trace + (K[0][0] + K[1][1] + K[2][2]) + dot<Lanes>(H[0], K[0]);
}

/// det(I + H) - 1
template <class Lanes, class V>
HMAX_DEVICE inline V volume_change(const V (*H)[3]) {
  V K[3][3];
  return volume_change<Lanes, V>(H, H[0][0] + H[1][1] + H[2][2], K);
}

/// |I + H|^2 - 3
template <class Lanes, class V>
HMAX_DEVICE inline V square_change(const V (*H)[3], V trace) {
  return (trace + trace) + (dot<Lanes>(H[0], H[0]) + dot<Lanes>(H[1], H[1]) + dot<Lanes>(H[2], H[2]));
}

}  // namespace hmax::kernel_loops
