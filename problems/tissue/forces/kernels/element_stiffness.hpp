/// The stiffness of tetrahedra, fibres and springs: the one source of processors and devices, as
/// element_pull.hpp.
#pragma once

#include <cstddef>

#include "core/instructions/device_code.hpp"
#include "problems/tissue/forces/kernels/element_pull.hpp"

namespace hmax::kernel_loops {

/// Sets g_0 = -(g_1 + g_2 + g_3).
template <class V>
HMAX_DEVICE inline void first_gradient(V (*g)[3]) {
  for (int i = 0; i < 3; ++i) g[0][i] = -(g[1][i] + g[2][i] + g[3][i]);
}

/// What the stiffness of Green's strain is made of: gradients g_a, h_a = F g_a, lambda h_a, mu h_a, mu B and
/// c, see TissueKernels::green_stiffness. Not used are lh[0] and mh[3].
template <class Lanes>
struct StiffnessParts {
  typename Lanes::V g[4][3], h[4][3], lh[4][3], mh[4][3], B[6], c;
};

/// @param U  as of displacement_gradient()
/// @param parts  has Bm, row a at g[a + 1]
template <class Lanes, class V>
HMAX_DEVICE inline void stiffness_parts(const V (*U)[3], V half, V mu, StiffnessParts<Lanes>& parts) {
  auto& [g, h, lh, mh, B, c] = parts;
  V F[3][3];
  displacement_gradient<Lanes>(U, g + 1, F);
  for (int i = 0; i < 3; ++i) F[i][i] += Lanes::splat(1);
  for (int a = 1; a < 4; ++a)
    for (int i = 0; i < 3; ++i) h[a][i] = dot<Lanes>(F[i], g[a]);
  first_gradient(g);
  for (int i = 0; i < 3; ++i) h[0][i] = -(h[1][i] + h[2][i] + h[3][i]);
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) B[symmetric(i, j)] = dot<Lanes>(F[i], F[j]);
  const V lambda = half + half;
  c = half * (B[0] + B[1] + B[2] - Lanes::splat(3)) - mu;
  for (int k = 0; k < 6; ++k) B[k] *= mu;
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) mh[a][i] = mu * h[a][i], lh[a + 1][i] = lambda * h[a + 1][i];
}

/// The block (b, a) of a pair of corners a < b, column j at entries[j]:
///   lambda h_b[i] h_a[j] + mu h_a[i] h_b[j] + mu K_ab B_ij + s_ab e_ij,  K_ab = g_a.g_b,
///   s_ab = c K_ab + mu h_a.h_b.
template <class Lanes, class V>
HMAX_DEVICE inline void pair_stiffness(const StiffnessParts<Lanes>& parts, int a, int b, V (*entries)[3]) {
  const auto& [g, h, lh, mh, B, c] = parts;
  const V k = dot<Lanes>(g[a], g[b]), s = c * k + dot<Lanes>(mh[a], h[b]);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      entries[j][i] = lh[b][i] * h[a][j] + mh[a][i] * h[b][j] + k * B[symmetric(i, j)];
      if (i == j) entries[j][i] += s;
    }
}

/// What the stiffness of the stable neo-Hookean solid is made of: gradients g_a, F g_a, C g_a, F, and V times
/// mu' (1 - 1 / n), 2 mu' / n^2, lambda' and lambda' (J - a), n = |F|^2 + 1; see StableNeoHookean.
/// @tparam points  how many of its points have these gradients
template <class Lanes, int points = 4>
struct NeoHookeanParts {
  typename Lanes::V g[points][3], Fg[points][3], Cg[points][3], F[3][3], straight, stretched, squeezed,
      turned;
};

/// @param H  the displacement gradient
/// @param parts  has the gradients g_a
/// @param pressure  V times one that is added to that of the solid, or nothing, as of neo_hookean_stress()
template <class Lanes, int points, class V, class... Pressure>
HMAX_DEVICE inline void neo_hookean_parts_of(const V (*H)[3], V half, V mu,
                                             NeoHookeanParts<Lanes, points>& parts, Pressure... pressure) {
  auto& [g, Fg, Cg, F, straight, stretched, squeezed, turned] = parts;
  V K[3][3];
  const V trace = H[0][0] + H[1][1] + H[2][2], one = Lanes::splat(1);
  const V n = square_change<Lanes, V>(H, trace) + Lanes::splat(4);
  const V volume = volume_change<Lanes, V>(H, trace, K);
  V C[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      F[i][j] = i == j ? H[i][j] + one : H[i][j];
      C[i][j] = (i == j ? one + (trace - H[j][i]) : -H[j][i]) + K[i][j];
    }
  for (int a = 0; a < points; ++a)
    for (int i = 0; i < 3; ++i) Fg[a][i] = dot<Lanes>(F[i], g[a]), Cg[a][i] = dot<Lanes>(C[i], g[a]);
  const V shear = Lanes::splat(4.0 / 3) * mu;
  straight = shear * (one - one / n);
  stretched = (shear + shear) / (n * n);
  squeezed = (half + half) + Lanes::splat(5.0 / 6) * mu;
  turned = ((squeezed * volume - Lanes::splat(0.75) * shear) + ... + pressure);
}

/// @param U  as of displacement_gradient()
/// @param parts  has Bm, row a at g[a + 1]
template <class Lanes, class V>
HMAX_DEVICE inline void neo_hookean_parts(const V (*U)[3], V half, V mu, NeoHookeanParts<Lanes>& parts) {
  auto& g = parts.g;
  V H[3][3];
  displacement_gradient<Lanes>(U, g + 1, H);
  first_gradient(g);
  neo_hookean_parts_of(H, half, mu, parts);
}

/// The block of corners a and b, entry (i, j) at block[i][j]:
///   mu' (1 - 1 / n) g_a.g_b e_ij + 2 mu' / n^2 (F g_a)_i (F g_b)_j + lambda' (C g_a)_i (C g_b)_j
///   + lambda' (J - a) (e_j x F (g_a x g_b))_i.
/// That of b and a is the transposed one to the last bit.
template <class Lanes, int points, class V>
HMAX_DEVICE inline void neo_hookean_stiffness(const NeoHookeanParts<Lanes, points>& parts, int a, int b,
                                              V (*block)[3]) {
  const auto& [g, Fg, Cg, F, straight, stretched, squeezed, turned] = parts;
  V normal[3], w[3];
  cross(g[a], g[b], normal);
  for (int i = 0; i < 3; ++i) w[i] = turned * dot<Lanes>(F[i], normal);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      block[i][j] = stretched * (Fg[a][i] * Fg[b][j]) + squeezed * (Cg[a][i] * Cg[b][j]);
  const V along = straight * dot<Lanes>(g[a], g[b]);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    block[i][i] += along;
    block[i][j] += w[k];
    block[j][i] -= w[k];
  }
}

/// The parts of a tetrahedron of ten nodes at point g of its rule.
/// @param U, rule  as of ten_node_gradient()
/// @param parts  has the gradients of some of its points
template <class Lanes, int points, class V, class Rule>
HMAX_DEVICE inline void ten_node_parts(const V (*U)[3], const Rule& rule, int g,
                                       NeoHookeanParts<Lanes, points>& parts) {
  V H[3][3];
  ten_node_gradient(U, rule, g, H);
  const V volume = rule.volume(g);
  neo_hookean_parts_of(H, volume * rule.half_lambda(), volume * rule.mu(), parts);
}

/// Its block of points a and b: the sum of those of its rule. That of b and a is the transposed one to the
/// last bit.
/// @param parts_at  parts_at(g) gives ten_node_parts(), which have the gradients of a and b there
template <class V, class PartsAt>
HMAX_DEVICE inline void ten_node_stiffness(const PartsAt& parts_at, int a, int b, V (*block)[3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) block[i][j] = 0;
  for (int g = 0; g < 4; ++g) {
    V own[3][3];
    neo_hookean_stiffness(parts_at(g), a, b, own);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) block[i][j] += own[i][j];
  }
}

/// What the stiffness of the corotational solid is made of: gradients g_a, R g_a, the rotation R, its
/// turning() T, and V times 2 mu, lambda and lambda tr(R^T F - I) - 2 mu; see Corotational.
template <class Lanes>
struct CorotationalParts {
  typename Lanes::V g[4][3], Rg[4][3], R[3][3], T[6], shear, squeezed, turned;
};

/// @param U  as of displacement_gradient()
/// @param parts  has Bm, row a at g[a + 1]
template <class Lanes, class Number, class V>
HMAX_DEVICE inline void corotational_parts(const V (*U)[3], V half, V mu, CorotationalParts<Lanes>& parts) {
  auto& [g, Rg, R, T, shear, squeezed, turned] = parts;
  V H[3][3], e[3][3];
  displacement_gradient<Lanes>(U, g + 1, H);
  nearest_rotation<Lanes, Number>(H, R);
  first_gradient(g);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      e[i][j] = H[i][j] - R[i][j];
      if (i == j) R[i][j] += Lanes::splat(1);
    }
  for (int a = 0; a < 4; ++a)
    for (int i = 0; i < 3; ++i) Rg[a][i] = dot<Lanes>(R[i], g[a]);
  turning<Lanes>(R, e, T);
  shear = mu + mu;
  squeezed = half + half;
  turned = squeezed * (dot<Lanes>(R[0], e[0]) + dot<Lanes>(R[1], e[1]) + dot<Lanes>(R[2], e[2])) - shear;
}

/// The block of corners a and b, entry (i, j) at block[i][j]:
///   2 mu g_a.g_b e_ij + lambda (R g_a)_i (R g_b)_j
///   + (lambda tr(R^T F - I) - 2 mu) (g_a x R^T e_i).T (g_b x R^T e_j).
/// That of b and a is the transposed one to the last bit.
template <class Lanes, class V>
HMAX_DEVICE inline void corotational_stiffness(const CorotationalParts<Lanes>& parts, int a, int b,
                                               V (*block)[3]) {
  const auto& [g, Rg, R, T, shear, squeezed, turned] = parts;
  V x[3][3], y[3][3];
  for (int i = 0; i < 3; ++i) cross(g[a], R[i], x[i]), cross(g[b], R[i], y[i]);
  const V along = shear * dot<Lanes>(g[a], g[b]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const V* const p = x[i];
      const V* const q = y[j];
      const V turn = T[0] * (p[0] * q[0]) + T[1] * (p[1] * q[1]) + T[2] * (p[2] * q[2]) +
                     T[3] * (p[0] * q[1] + p[1] * q[0]) + T[4] * (p[0] * q[2] + p[2] * q[0]) +
                     T[5] * (p[1] * q[2] + p[2] * q[1]);
      block[i][j] = squeezed * (Rg[a][i] * Rg[b][j]) + turned * turn;
      if (i == j) block[i][j] += along;
    }
}

/// Whether a fibre resists more stretch.
template <class V>
HMAX_DEVICE inline bool is_taut(const FibreStretch<V>& now, bool small_strain) {
  constexpr double rounding = 1e-12;  // a fibre at rest is taut however it was turned
  return small_strain || now.square >= -rounding;
}

/// V E_f (n n^T + (1 - 1/l) (I - n n^T)) [N m] of a taut fibre, entry (i, j) at B[i][j]: the block of corners
/// a and b is g_a.a g_b.a times it.
/// @param young, volume  E_f [Pa], V [m^3]
template <class V>
HMAX_DEVICE inline void fibre_stiffness(const FibreStretch<V>& now, V young, V volume, bool small_strain,
                                        V (*B)[3]) {
  const V across = small_strain || !(now.strain > 0) ? 0 : now.strain / (1 + now.strain),
          size = volume * young;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const V along = now.along[i] * now.along[j];
      B[i][j] = size * (along + across * ((i == j ? 1 : 0) - along));
    }
}

/// dT/dl e e^T + T / l (I - e e^T) of a spring, entry (i, j) at B[i][j].
/// @param law  phi(s) and slope(s), see springs.hpp
/// @param stiffness, rest, length  k [N/m], L and l [m];  @param e  its direction
template <class Law>
HMAX_DEVICE inline void spring_stiffness(const Law& law, double stiffness, double rest, double length,
                                         const double* e, double (*B)[3]) {
  const double s = (length - rest) / rest, across = stiffness * rest * law.phi(s) / length,
               along = stiffness * law.slope(s) - across;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) B[i][j] = across * (i == j ? 1.0 : 0.0) + along * e[i] * e[j];
}

/// -dF/dx of one damper c [N s/m], c / l (e (w - (e.w) e)^T + (e.w) (I - e e^T)), as
/// SpringSet::add_damper_stiffness() has it: not symmetric. Its -dF/dv is c e e^T.
/// @param w  the velocity of the far end less that of the near one [m/s]
template <class Lanes>
HMAX_DEVICE inline void damper_stiffness(double damper, double length, const double* e, const double* w,
                                         double (*B)[3]) {
  const double along = dot<Lanes>(e, w), size = damper / length;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      B[i][j] = size * (e[i] * (w[j] - along * e[j]) + along * ((i == j ? 1.0 : 0.0) - e[i] * e[j]));
}

/// How triangle_pull() changes with component c of corner b, 1 or 2.
/// @param F, S  of triangle_gradient() and membrane_stress()
HMAX_DEVICE inline void triangle_stiffness(const double (*F)[3], const double* S, const double* g,
                                           double volume, double modulus, double poisson, int b, int c,
                                           double (*pull)[3]) {
  const double* const own = g + std::ptrdiff_t{2} * (b - 1);
  const double E[3] = {F[0][c] * own[0], F[1][c] * own[1], (F[0][c] * own[1] + F[1][c] * own[0]) / 2};
  double T[3];
  plane_stress(modulus, poisson, E, T);
  for (int i = 0; i < 3; ++i) {
    const double turned[2] = {i == c ? own[0] * S[0] + own[1] * S[2] : 0.0,
                              i == c ? own[0] * S[2] + own[1] * S[1] : 0.0};
    const double P0 = volume * (turned[0] + (F[0][i] * T[0] + F[1][i] * T[2])),
                 P1 = volume * (turned[1] + (F[0][i] * T[2] + F[1][i] * T[1]));
    for (int k = 0; k < 2; ++k) pull[k][i] = P0 * g[std::ptrdiff_t{2} * k] + P1 * g[2 * k + 1];
  }
}

}  // namespace hmax::kernel_loops
