/// What tetrahedra and springs do to one of their points: the one source of processors and devices.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/instructions/device_code.hpp"
#include "problems/tissue/forces/kernels/element_stiffness.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"
#include "problems/tissue/positional/element_constraints.hpp"

namespace hmax {

/// A linear tetrahedron.
struct PointTetrahedron {
  double slopes[4][3];    ///< gradients of the shape functions [1/m]
  double lambda, mu;      ///< Lame coefficients times the volume [J]
  std::int32_t point[4];  ///< numbers of the corners; on the processor those of free points, -1 for held ones
};

/// A spring, likewise.
struct PointSpring {
  double rest[3];            ///< from the first to the second end [m]
  double length, stiffness;  ///< L [m], k [N/m]
  std::int32_t point[2];
};

/// What a point with the gradient g of its shape function feels of a law.
/// @tparam V  a number, or numbers side by side
template <class V>
struct AlongSlope {
  V stress[3];  ///< P g
  V block[6];   ///< d(P g)/du by its own displacement u, entry (i, j) at symmetric(i, j)
};

/// a.b
template <class V>
HMAX_DEVICE inline V product_of_three(const V* a, const V* b) {
  return sum_of_three<V>(a[0] * b[0], a[1] * b[1], a[2] * b[2]);
}

/// H g, and H^T g
template <class V>
HMAX_DEVICE inline void times(const V (*H)[3], const V* g, V* to) {
  for (int i = 0; i < 3; ++i) to[i] = product_of_three(H[i], g);
}
template <class V>
HMAX_DEVICE inline void transposed_times(const V (*H)[3], const V* g, V* to) {
  for (int i = 0; i < 3; ++i) to[i] = sum_of_three<V>(H[0][i] * g[0], H[1][i] * g[1], H[2][i] * g[2]);
}

/// The square of each column, 0 + (1 + 2).
template <class V>
HMAX_DEVICE inline V square_of_column(const V (*H)[3], int j) {
  return sum_of_three<V>(H[0][j] * H[0][j], H[1][j] * H[1][j], H[2][j] * H[2][j]);
}

template <class V>
HMAX_DEVICE inline void along_small(const V (*H)[3], const V& lambda, const V& mu, const V* g,
                                    AlongSlope<V>& felt) {
  V Hg[3], gH[3];
  times(H, g, Hg);
  transposed_times(H, g, gH);
  const V pressure = lambda * sum_of_three(H[0][0], H[1][1], H[2][2]), shear = mu * product_of_three(g, g);
  for (int i = 0; i < 3; ++i) felt.stress[i] = g[i] * pressure + (Hg[i] + gH[i]) * mu;
  for (int j = 0; j < 3; ++j)
    for (int i = j; i < 3; ++i) {
      V& entry = felt.block[kernel_loops::symmetric(i, j)];
      entry = g[i] * ((lambda + mu) * g[j]);
      if (i == j) entry = entry + shear;
    }
}

template <class V>
HMAX_DEVICE inline void along_green(const V (*H)[3], const V& lambda, const V& mu, const V* g,
                                    AlongSlope<V>& felt) {
  V F[3][3], Hg[3], h[3], Hh[3], stressed[3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) F[i][j] = i == j ? H[i][j] + V(1) : H[i][j];
  times(H, g, Hg);
  for (int i = 0; i < 3; ++i) h[i] = g[i] + Hg[i];
  transposed_times(H, h, Hh);
  // 2 E g = (H + H^T F) g, and S g
  const V trace = sum_of_three(H[0][0], H[1][1], H[2][2]) +
                  V(0.5) * (square_of_column(H, 0) + square_of_column(H, 1) + square_of_column(H, 2));
  for (int i = 0; i < 3; ++i) stressed[i] = g[i] * (lambda * trace) + (Hg[i] + Hh[i]) * mu;
  times(F, stressed, felt.stress);
  const V shear = mu * product_of_three(g, g), along = product_of_three(g, stressed);
  for (int j = 0; j < 3; ++j)
    for (int i = j; i < 3; ++i) {
      V& entry = felt.block[kernel_loops::symmetric(i, j)];
      entry = h[i] * ((lambda + mu) * h[j]) + product_of_three(F[i], F[j]) * shear;
      if (i == j) entry = entry + along;
    }
}

/// J is linear along changes that g^T has on the right.
template <class V>
HMAX_DEVICE inline void along_neo_hookean(const V (*H)[3], const V& first_lame, const V& second_lame,
                                          const V* g, AlongSlope<V>& felt) {
  const V mu = second_lame * V(4.0 / 3), lambda = first_lame + second_lame * V(5.0 / 6);
  V K[3][3], Hg[3], gH[3], Kg[3], Fg[3], Cg[3], stretched[3], squeezed[3];
  kernel_loops::cofactors_of<V>(H, K);
  const V trace = sum_of_three(H[0][0], H[1][1], H[2][2]),
          square = V(2) * trace +
                   sum_of_three(square_of_column(H, 0), square_of_column(H, 1), square_of_column(H, 2)),
          n = square + V(4),
          volume = trace + sum_of_three(K[0][0], K[1][1], K[2][2]) +
                   sum_of_three<V>(H[0][0] * K[0][0], H[1][0] * K[1][0], H[2][0] * K[2][0]);
  times(H, g, Hg);
  transposed_times(H, g, gH);
  times(K, g, Kg);
  const V stretch = V(2) * mu / (n * n), shear = V(0.75) * mu, pull = mu * square / (V(4) * n);
  // C = I + D, D = tr(H) I - H^T + K
  for (int i = 0; i < 3; ++i) {
    const V Dg = g[i] * trace - gH[i] + Kg[i];
    Fg[i] = g[i] + Hg[i], Cg[i] = g[i] + Dg;
    stretched[i] = Fg[i] * stretch, squeezed[i] = Cg[i] * lambda;
    felt.stress[i] = (Hg[i] - Dg) * shear + Fg[i] * pull + squeezed[i] * volume;
  }
  const V straight = mu * (V(1) - V(1) / n) * product_of_three(g, g);
  for (int j = 0; j < 3; ++j)
    for (int i = j; i < 3; ++i) {
      V& entry = felt.block[kernel_loops::symmetric(i, j)];
      entry = stretched[i] * Fg[j] + squeezed[i] * Cg[j];
      if (i == j) entry = entry + straight;
    }
}

/// Of one tetrahedron alone: its rotation takes as many steps as it needs.
HMAX_DEVICE inline void along_corotational(const double (*H)[3], double lambda, double mu, const double* g,
                                           AlongSlope<double>& felt) {
  using Lanes = OneElement<double>;
  kernel_loops::CorotationalParts<Lanes> parts;
  double e[3][3], block[3][3];
  kernel_loops::nearest_rotation<Lanes, double>(H, parts.R);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      e[i][j] = H[i][j] - parts.R[i][j];
      if (i == j) parts.R[i][j] += 1;
    }
  kernel_loops::turning<Lanes>(parts.R, e, parts.T);
  double trace = 0;  // of R^T F - I
  for (int i = 0; i < 3; ++i) {
    parts.g[0][i] = g[i];
    parts.Rg[0][i] = kernel_loops::dot<Lanes>(parts.R[i], g);
    trace = trace + kernel_loops::dot<Lanes>(parts.R[i], e[i]);
  }
  parts.shear = mu + mu, parts.squeezed = lambda, parts.turned = lambda * trace - parts.shear;
  for (int i = 0; i < 3; ++i)
    felt.stress[i] = parts.shear * kernel_loops::dot<Lanes>(e[i], g) + lambda * trace * parts.Rg[0][i];
  kernel_loops::corotational_stiffness(parts, 0, 0, block);
  for (int j = 0; j < 3; ++j)
    for (int i = j; i < 3; ++i) felt.block[kernel_loops::symmetric(i, j)] = block[i][j];
}

/// What a tetrahedron does to a corner: felt times its volume, so that the force on it is -felt.stress.
/// @param U       displacements of the other three corners less that of this one, one at each U[a]
/// @param slopes  of the other three;  @param g  of this one
template <TetLaw law, class V>
HMAX_DEVICE inline void tetrahedron_at_point(const V (*U)[3], const V (*slopes)[3], const V* g,
                                             const V& lambda, const V& mu, AlongSlope<V>& felt) {
  V H[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      H[i][j] = sum_of_three<V>(U[0][i] * slopes[0][j], U[1][i] * slopes[1][j], U[2][i] * slopes[2][j]);
  if constexpr (law == TetLaw::green) along_green<V>(H, lambda, mu, g, felt);
  if constexpr (law == TetLaw::small_strain) along_small<V>(H, lambda, mu, g, felt);
  if constexpr (law == TetLaw::neo_hookean) along_neo_hookean<V>(H, lambda, mu, g, felt);
  if constexpr (law == TetLaw::corotational) along_corotational(H, lambda, mu, g, felt);
}

/// f += the force on the first or the second end of a spring, K += -df/dq of it, entry (i, j), i >= j, at
/// K[3 j + i].
/// @param law  phi(s) and slope(s), see springs.hpp
/// @param d    from the first to the second end [m]
template <class Law>
HMAX_DEVICE inline void add_spring_at_point(const Law& law, const PointSpring& spring, bool is_first,
                                            const double* d, double* f, double* K) {
  constexpr double least = std::numeric_limits<double>::min();
  const double size = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), l = size < least ? least : size;
  double e[3], block[3][3];
  for (int i = 0; i < 3; ++i) e[i] = d[i] / l;
  const double tension =
      kernel_loops::spring_tension(law, spring.stiffness * spring.length, spring.length, l);
  kernel_loops::spring_stiffness(law, spring.stiffness, spring.length, l, e, block);
  for (int i = 0; i < 3; ++i) f[i] = f[i] + (is_first ? tension : -tension) * e[i];
  for (int j = 0; j < 3; ++j)
    for (int i = j; i < 3; ++i) K[3 * j + i] = K[3 * j + i] + block[i][j];
}

}  // namespace hmax
