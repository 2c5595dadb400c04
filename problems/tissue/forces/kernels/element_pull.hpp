/// The forces of tetrahedra, fibres, springs, dampers and triangles: the one source of processors and
/// devices.
///
/// Stresses are first Piola-Kirchhoff ones of displacement gradients H = F - I times the volume V of the
/// element, whose coefficients are V lambda / 2 and V mu [J]; elasticity.hpp has the laws. `Lanes` has `V`, a
/// register of elements side by side or one number, load(p) of it, and splat(s), a register of one number;
/// kernel_loops.hpp says why it is of an unnamed namespace.
#pragma once

#include <cstddef>

#include "core/instructions/device_code.hpp"
#include "problems/tissue/forces/kernels/rotation.hpp"
#include "problems/tissue/forces/kernels/small_matrices.hpp"
#include "problems/tissue/forces/kernels/tet_law.hpp"

namespace hmax::kernel_loops {

/// H = du/dX = (u1 - u0, u2 - u0, u3 - u0) Bm, entry (i, j) at H[i][j].
/// @param U  column a at U[a];  @param g  Bm, row a at g[a]
template <class Lanes, class V>
HMAX_DEVICE inline void displacement_gradient(const V (*U)[3], const V (*g)[3], V (*H)[3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) H[i][j] = U[0][i] * g[0][j] + U[1][i] * g[1][j] + U[2][i] * g[2][j];
}

/// V S of the second Piola-Kirchhoff stress S = lambda tr(E) I + 2 mu E, where 2 E = F^T F - I, without the
/// difference: 2 E_ii = H_ii + (F^T H)_ii.
template <class V>
HMAX_DEVICE inline void second_piola(const V (*H)[3], const V (*F)[3], V half_lambda, V mu, V (&S)[6]) {
  const auto product = [&](int i, int j, const V(*B)[3]) {
    return F[0][i] * B[0][j] + F[1][i] * B[1][j] + F[2][i] * B[2][j];
  };
  for (int i = 0; i < 3; ++i) S[i] = H[i][i] + product(i, i, H);
  S[3] = product(0, 1, F), S[4] = product(0, 2, F), S[5] = product(1, 2, F);
  const V pressure = half_lambda * (S[0] + S[1] + S[2]);
  for (int k = 0; k < 6; ++k) S[k] *= mu;
  for (int k = 0; k < 3; ++k) S[k] += pressure;
}

/// V F S of Green's strain.
template <class Lanes, class V>
HMAX_DEVICE inline void green_stress(const V (*H)[3], V half_lambda, V mu, V (*P)[3]) {
  V F[3][3], S[6];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) F[i][j] = i == j ? H[i][j] + Lanes::splat(1) : H[i][j];
  second_piola(H, F, half_lambda, mu, S);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      P[i][j] = F[i][0] * S[symmetric(0, j)] + F[i][1] * S[symmetric(1, j)] + F[i][2] * S[symmetric(2, j)];
}

/// V (mu (H + H^T) + lambda tr(H) I).
template <class V>
HMAX_DEVICE inline void small_stress(const V (*H)[3], V half_lambda, V mu, V (*P)[3]) {
  const V pressure = (half_lambda + half_lambda) * (H[0][0] + H[1][1] + H[2][2]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) P[i][j] = mu * (H[i][j] + H[j][i]);
  for (int i = 0; i < 3; ++i) P[i][i] += pressure;
}

/// V (mu (F - C) + mu' s / (4 (s + 4)) F + (lambda' (J - 1) + p) C) of the stable neo-Hookean solid, mu' =
/// 4/3 mu, lambda' = lambda + 5/6 mu, s = |F|^2 - 3, C = dJ/dF = I + D with D = tr(H) I - H^T + K and the
/// cofactors K of H, so that no number is the difference of larger ones.
/// @param pressure  V p [J], where there is one
template <class Lanes, class V, class... Pressure>
HMAX_DEVICE inline void neo_hookean_stress(const V (*H)[3], V half_lambda, V mu, V (*P)[3],
                                           Pressure... pressure) {
  V K[3][3];
  const V trace = H[0][0] + H[1][1] + H[2][2];
  const V square = square_change<Lanes, V>(H, trace), volume = volume_change<Lanes, V>(H, trace, K);
  const V stretched = Lanes::splat(1.0 / 3) * mu * square / (square + Lanes::splat(4));
  const V squeezed = ((((half_lambda + half_lambda) + Lanes::splat(5.0 / 6) * mu) * volume) + ... + pressure);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const V D = (i == j ? trace - H[j][i] : -H[j][i]) + K[i][j], one = Lanes::splat(i == j ? 1 : 0);
      P[i][j] = mu * (H[i][j] - D) + stretched * (one + H[i][j]) + squeezed * (one + D);
    }
}

/// V (2 mu (F - R) + lambda tr(R^T (F - R)) R) with the rotation R nearest to F.
template <class Lanes, class Number, class V>
HMAX_DEVICE inline void corotational_stress(const V (*H)[3], V half_lambda, V mu, V (*P)[3]) {
  V R[3][3], e[3][3];
  nearest_rotation<Lanes, Number>(H, R);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      e[i][j] = H[i][j] - R[i][j];
      if (i == j) R[i][j] += Lanes::splat(1);
    }
  const V pressure = (half_lambda + half_lambda) *
                     (dot<Lanes>(R[0], e[0]) + dot<Lanes>(R[1], e[1]) + dot<Lanes>(R[2], e[2]));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) P[i][j] = (mu + mu) * e[i][j] + pressure * R[i][j];
}

/// V P Bm^T: what the corners 1, 2 and 3 are pulled back with, that of corner a + 1 at pull[a]. The force
/// at corner 0 is their sum, (1 + 2) + 3.
template <class Lanes, class V>
HMAX_DEVICE inline void corner_pull(const V (*P)[3], const V (*g)[3], V (*pull)[3]) {
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) pull[a][i] = dot<Lanes>(P[i], g[a]);
}

/// The same of a law.
/// @param half_lambda, mu  where V lambda / 2 and V mu [J] stand, for Lanes::load()
template <class Lanes, TetLaw law, class V, class Number>
HMAX_DEVICE inline void tet_pull(const V (*U)[3], const V (*g)[3], const Number* half_lambda,
                                 const Number* mu, V (*pull)[3]) {
  V H[3][3], P[3][3];
  displacement_gradient<Lanes>(U, g, H);
  if constexpr (law == TetLaw::green) green_stress<Lanes, V>(H, Lanes::load(half_lambda), Lanes::load(mu), P);
  if constexpr (law == TetLaw::small_strain) small_stress<V>(H, Lanes::load(half_lambda), Lanes::load(mu), P);
  if constexpr (law == TetLaw::neo_hookean)
    neo_hookean_stress<Lanes, V>(H, Lanes::load(half_lambda), Lanes::load(mu), P);
  if constexpr (law == TetLaw::corotational)
    corotational_stress<Lanes, Number, V>(H, Lanes::load(half_lambda), Lanes::load(mu), P);
  corner_pull<Lanes, V>(P, g, pull);
}

/// H at point g of the rule of a tetrahedron of ten nodes.
/// @param U     displacements relative to those of point 0, that of point a at U[a]
/// @param rule  of four points g: gradient(g, a, j) of G [1/m], volume(g) V_g [m^3], half_lambda() and mu()
///              [Pa]
template <class V, class Rule>
HMAX_DEVICE inline void ten_node_gradient(const V (*U)[3], const Rule& rule, int g, V (*H)[3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      H[i][j] = U[1][i] * rule.gradient(g, 1, j);
      for (int a = 2; a < 10; ++a) H[i][j] += U[a][i] * rule.gradient(g, a, j);
    }
}

/// sum_g V_g P_g G_g^T of a stable neo-Hookean tetrahedron of ten nodes, what its points are pulled back
/// with: calls take(a, pull) for each of them.
/// @param U, rule  as of ten_node_gradient()
template <class Lanes, class V, class Rule, class Take>
HMAX_DEVICE inline void ten_node_pull(const V (*U)[3], const Rule& rule, const Take& take) {
  V P[4][3][3];
  for (int g = 0; g < 4; ++g) {
    V H[3][3];
    ten_node_gradient(U, rule, g, H);
    const V volume = rule.volume(g);
    neo_hookean_stress<Lanes, V>(H, volume * rule.half_lambda(), volume * rule.mu(), P[g]);
  }
  for (int a = 0; a < 10; ++a) {
    V pull[3] = {0, 0, 0};
    for (int g = 0; g < 4; ++g) {
      const V G[3] = {rule.gradient(g, a, 0), rule.gradient(g, a, 1), rule.gradient(g, a, 2)};
      for (int i = 0; i < 3; ++i) pull[i] += dot<Lanes>(P[g][i], G);
    }
    take(a, pull);
  }
}

/// A fibre that is stretched from the unit vector a to l n = F a.
template <class V>
struct FibreStretch {
  V strain;    ///< l - 1; of small strain a.H a
  V square;    ///< l^2 - 1; not set of small strain
  V along[3];  ///< n; of small strain a
};

/// From H a rather than F, so that small strains keep their digits.
/// @param U       the edges of its tetrahedron, as displacement_gradient() has them
/// @param slopes  Bm a: of the corners 1, 2 and 3
template <class Lanes, class V>
HMAX_DEVICE inline FibreStretch<V> stretch_of_fibre(const V (*U)[3], const V* slopes, const V* a,
                                                    bool small_strain) {
  V d[3];
  for (int i = 0; i < 3; ++i) d[i] = U[0][i] * slopes[0] + U[1][i] * slopes[1] + U[2][i] * slopes[2];
  const V turned = dot<Lanes>(a, d);
  if (small_strain) return {turned, 0, {a[0], a[1], a[2]}};
  const V square = (turned + turned) + dot<Lanes>(d, d), all = 1 + square,
          length = Lanes::root(all > 0 ? all : 0);
  return {square / (1 + length),
          square,
          {(a[0] + d[0]) / length, (a[1] + d[1]) / length, (a[2] + d[2]) / length}};
}

/// E_f (l - 1) [Pa]; pressed fibres buckle, those of small strain push.
template <class V>
HMAX_DEVICE inline V fibre_tension(const FibreStretch<V>& now, V young, bool small_strain) {
  return small_strain || now.strain > 0 ? young * now.strain : 0;
}

/// T / l = k L (s + b s^3) / l as k L (1 / L - 1 / l) (1 + b s^2) with s = l / L - 1, where d leads from the
/// near to the far end. Points that coincide have d = 0 and meet no force. `Lanes` has root(v), too.
/// @param length_inverse, tension  where 1 / L [1/m] and k L [N] stand, for Lanes::load()
template <class Lanes, bool cubic, class V, class Number>
HMAX_DEVICE inline V spring_pull(const Number* length_inverse, const Number* tension, V b, const V* d) {
  constexpr double least = sizeof(Number) == sizeof(double) ? 1e-300 : 1e-30;
  const V one = Lanes::splat(1), now = Lanes::root(dot<Lanes>(d, d) + Lanes::splat(least));
  const V per_length = Lanes::load(length_inverse);
  const V pull = Lanes::load(tension) * (per_length - one / now);
  if constexpr (!cubic) return pull;
  const V s = now * per_length - one;
  return pull * (one + b * (s * s));
}

/// Of d, from the near to the far end of one spring: its length, at least the smallest normal number, and its
/// direction e = d / length, 0 where the ends coincide.
template <class Lanes, class Real>
HMAX_DEVICE inline Real direction(const Real* d, Real* e) {
  constexpr double least = sizeof(Real) == sizeof(double) ? 0x1p-1022 : 0x1p-126;
  const Real size = Lanes::root(dot<Lanes>(d, d)),
             length = size < Lanes::splat(least) ? Lanes::splat(least) : size;
  for (int i = 0; i < 3; ++i) e[i] = d[i] / length;
  return length;
}

/// k L phi(s) of one spring of any law [N], which pulls its near end along e.
/// @param law  phi(s), see springs.hpp;  @param tension, rest, length  k L [N], L and l [m]
template <class Law, class Real>
HMAX_DEVICE inline Real spring_tension(const Law& law, Real tension, Real rest, Real length) {
  return tension * static_cast<Real>(law.phi((length - rest) / rest));
}

/// c (e.w) e, the pull of one damper c [N s/m] at the near end, as SpringSet::add_damper_force() has it.
/// @param d, w  from the near to the far end: position [m], velocity [m/s]
template <class Lanes, class Real>
HMAX_DEVICE inline void damper_pull(Real damper, const Real* d, const Real* w, Real* pull) {
  Real e[3];
  direction<Lanes>(d, e);
  const Real along = damper * dot<Lanes>(e, w);
  for (int i = 0; i < 3; ++i) pull[i] = along * e[i];
}

/// F = (x1 - x0, x2 - x0) Bm of one triangle in space, column b at F[b].
/// @param D  column a at D[a];  @param g  Bm, row after row
template <class Real>
HMAX_DEVICE inline void triangle_gradient(const Real (*D)[3], const Real* g, Real (*F)[3]) {
  for (int b = 0; b < 2; ++b)
    for (int i = 0; i < 3; ++i) F[b][i] = D[0][i] * g[b] + D[1][i] * g[2 + b];
}

/// Plane stress S = Y / (1 - nu^2) ((1 - nu) E + nu tr(E) I); of both the entries 00 11 01.
/// @param modulus  Y / (1 - nu^2) [Pa]
template <class Real>
HMAX_DEVICE inline void plane_stress(Real modulus, Real poisson, const Real* E, Real* S) {
  const Real pressure = poisson * (E[0] + E[1]);
  for (int k = 0; k < 3; ++k) S[k] = modulus * ((1 - poisson) * E[k] + (k < 2 ? pressure : Real{0}));
}

/// The same of Green's strain E = (F^T F - I) / 2.
template <class Lanes, class Real>
HMAX_DEVICE inline void membrane_stress(Real modulus, Real poisson, const Real (*F)[3], Real* S) {
  const Real E[3] = {(dot<Lanes>(F[0], F[0]) - 1) / 2, (dot<Lanes>(F[1], F[1]) - 1) / 2,
                     dot<Lanes>(F[0], F[1]) / 2};
  plane_stress(modulus, poisson, E, S);
}

/// V F S Bm^T: what the corners 1 and 2 of one triangle are pulled back with. The force at corner 0 is their
/// sum.
/// @param volume  V [m^3]
template <class Lanes, class Real>
HMAX_DEVICE inline void triangle_pull(const Real (*D)[3], const Real* g, Real volume, Real modulus,
                                      Real poisson, Real (*pull)[3]) {
  Real F[2][3], S[3];
  triangle_gradient(D, g, F);
  membrane_stress<Lanes>(modulus, poisson, F, S);
  for (int i = 0; i < 3; ++i) {
    const Real a = volume * F[0][i], b = volume * F[1][i], P0 = a * S[0] + b * S[2], P1 = a * S[2] + b * S[1];
    for (int k = 0; k < 2; ++k) pull[k][i] = P0 * g[std::ptrdiff_t{2} * k] + P1 * g[2 * k + 1];
  }
}

}  // namespace hmax::kernel_loops
