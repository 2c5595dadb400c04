/// The constraints of tetrahedra and of springs: the one source of processors and devices.
#pragma once

#include <cmath>
#include <limits>

#include "core/instructions/device_code.hpp"
#include "problems/tissue/forces/kernels/element_pull.hpp"

namespace hmax {

/// 0 + (1 + 2)
template <class V>
HMAX_DEVICE inline V sum_of_three(const V& first, const V& second, const V& third) {
  return first + (second + third);
}

/// C(q) of a tetrahedron and dC/dq_i = P g_i at gradients[i], with P = dC/dF and the gradients g_i of the
/// shape functions, see TissueConstraints.
/// @tparam V  a number, or numbers side by side
/// @param U       u_(a + 1) - u_0 at U[a]
/// @param g       Bm [1/m], row a at g[a]
/// @param excess  a - 1; of the volumetric constraint alone
template <class V>
HMAX_DEVICE inline void tetrahedron_constraint(const V (*U)[3], const V (*g)[3], bool volumetric,
                                               const V& excess, V& value, V (*gradients)[3]) {
  using std::sqrt;
  V H[3][3], P[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      H[i][j] = sum_of_three<V>(U[0][i] * g[0][j], U[1][i] * g[1][j], U[2][i] * g[2][j]);
  if (volumetric) {
    V K[3][3];
    kernel_loops::cofactors_of<V>(H, K);
    const V trace = sum_of_three(H[0][0], H[1][1], H[2][2]);
    value = trace + sum_of_three(K[0][0], K[1][1], K[2][2]) +
            sum_of_three<V>(H[0][0] * K[0][0], H[1][0] * K[1][0], H[2][0] * K[2][0]) - excess;  // det F - a
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) P[i][j] = K[i][j] - H[j][i];  // the cofactors of F
    for (int i = 0; i < 3; ++i) P[i][i] = P[i][i] + (V(1) + trace);
  } else {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) P[i][j] = i == j ? H[i][j] + V(1) : H[i][j];
    V square[3];  // of each column
    for (int j = 0; j < 3; ++j)
      square[j] = sum_of_three<V>(P[0][j] * P[0][j], P[1][j] * P[1][j], P[2][j] * P[2][j]);
    value = sqrt(square[0] + square[1] + square[2]);
    const V unit = V(1) / (value + V(std::numeric_limits<double>::min()));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) P[i][j] = P[i][j] * unit;
  }
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < 3; ++a)
      gradients[a + 1][i] = sum_of_three<V>(P[i][0] * g[a][0], P[i][1] * g[a][1], P[i][2] * g[a][2]);
    gradients[0][i] = -sum_of_three(gradients[1][i], gradients[2][i], gradients[3][i]);
  }
}

/// C = l - L of a spring, and dC/dq of its ends.
/// @param d  from the first end to the second [m]
/// @returns C
HMAX_DEVICE inline double spring_constraint(const double* d, double length, double (*gradients)[3]) {
  constexpr double least = std::numeric_limits<double>::min();
  const double size = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), l = size < least ? least : size;
  for (int i = 0; i < 3; ++i) {
    gradients[0][i] = -d[i] / l;
    gradients[1][i] = d[i] / l;
  }
  return l - length;
}

}  // namespace hmax
