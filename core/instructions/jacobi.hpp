/// Rotations of Jacobi's method for eigenvectors of small symmetric matrices.
#pragma once

#include "core/instructions/device_code.hpp"

namespace hmax {

/// Turns the symmetric A by the angle that makes entry (p, q) zero, and the columns of Q with it.
/// @tparam Lanes  splat(s), a register of one number, and root(v)
template <class Lanes, int size, class V>
HMAX_DEVICE inline void jacobi_rotation(int p, int q, V (&A)[size][size], V (&Q)[size][size]) {
  const V one = Lanes::splat(1), zero = Lanes::splat(0), twice = A[p][q] + A[p][q], d = A[q][q] - A[p][p];
  const V far = Lanes::root(d * d + twice * twice), base = d < zero ? d - far : d + far;
  const V t = twice / (base == zero ? one : base), c = one / Lanes::root(one + t * t), s = c * t;
  for (int k = 0; k < size; ++k) {
    const V row_p = A[p][k], row_q = A[q][k];
    A[p][k] = c * row_p - s * row_q;
    A[q][k] = s * row_p + c * row_q;
  }
  for (int k = 0; k < size; ++k) {
    const V column_p = A[k][p], column_q = A[k][q], vector_p = Q[k][p], vector_q = Q[k][q];
    A[k][p] = c * column_p - s * column_q;
    A[k][q] = s * column_p + c * column_q;
    Q[k][p] = c * vector_p - s * vector_q;
    Q[k][q] = s * vector_p + c * vector_q;
  }
}

}  // namespace hmax
