/// The forces of St. Venant-Kirchhoff tetrahedra and of springs: the one source of processors and devices.
///
/// `Lanes` has `V`, a register of elements side by side or one number, load(p) of it, and splat(s), a
/// register of one number; kernel_loops.hpp says why it is of an unnamed namespace.
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

/// H = du/dX = (u1 - u0, u2 - u0, u3 - u0) Bm, entry (i, j) at H[i][j].
/// @param U  column a at U[a];  @param g  Bm, row a at g[a]
template <class Lanes, class V>
HMAX_DEVICE inline void displacement_gradient(const V (*U)[3], const V (*g)[3], V (*H)[3]) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) H[i][j] = U[0][i] * g[0][j] + U[1][i] * g[1][j] + U[2][i] * g[2][j];
}

/// V S of the second Piola-Kirchhoff stress S = lambda tr(E) I + 2 mu E, where 2 E = F^T F - I, without the
/// difference: 2 E_ii = H_ii + (F^T H)_ii.
/// @param half_lambda, mu_at  where V lambda / 2 and V mu [J] stand
template <class Lanes, class V>
HMAX_DEVICE inline void green_stress(const V (*H)[3], const V (*F)[3], const double* half_lambda,
                                     const double* mu_at, V (&S)[6]) {
  const auto product = [&](int i, int j, const V(*B)[3]) {
    return F[0][i] * B[0][j] + F[1][i] * B[1][j] + F[2][i] * B[2][j];
  };
  for (int i = 0; i < 3; ++i) S[i] = H[i][i] + product(i, i, H);
  S[3] = product(0, 1, F), S[4] = product(0, 2, F), S[5] = product(1, 2, F);
  const V mu = Lanes::load(mu_at);
  const V pressure = Lanes::load(half_lambda) * (S[0] + S[1] + S[2]);
  for (int k = 0; k < 6; ++k) S[k] *= mu;
  for (int k = 0; k < 3; ++k) S[k] += pressure;
}

/// V F S Bm^T: what the corners 1, 2 and 3 are pulled back with, that of corner a + 1 at pull[a]. The force
/// at corner 0 is their sum, (1 + 2) + 3.
template <class Lanes, class V>
HMAX_DEVICE inline void green_pull(const V (*U)[3], const V (*g)[3], const double* half_lambda,
                                   const double* mu, V (*pull)[3]) {
  V H[3][3], F[3][3], S[6], P[3][3];
  displacement_gradient<Lanes>(U, g, H);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) F[i][j] = i == j ? H[i][j] + Lanes::splat(1) : H[i][j];
  green_stress<Lanes>(H, F, half_lambda, mu, S);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      P[i][j] = F[i][0] * S[symmetric(0, j)] + F[i][1] * S[symmetric(1, j)] + F[i][2] * S[symmetric(2, j)];
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < 3; ++i) pull[a][i] = dot<Lanes>(P[i], g[a]);
}

/// T / l = k L (s + b s^3) / l as k L (1 / L - 1 / l) (1 + b s^2) with s = l / L - 1, where d leads from the
/// near to the far end. Points that coincide have d = 0 and meet no force. `Lanes` has root(v), too.
/// @param length_inverse, tension  where 1 / L [1/m] and k L [N] stand, for Lanes::load()
template <class Lanes, bool cubic, class V>
HMAX_DEVICE inline V spring_pull(const double* length_inverse, const double* tension, V b, const V* d) {
  const V one = Lanes::splat(1), now = Lanes::root(dot<Lanes>(d, d) + Lanes::splat(1e-300));
  const V per_length = Lanes::load(length_inverse);
  const V pull = Lanes::load(tension) * (per_length - one / now);
  if constexpr (!cubic) return pull;
  const V s = now * per_length - one;
  return pull * (one + b * (s * s));
}

}  // namespace hmax::kernel_loops
