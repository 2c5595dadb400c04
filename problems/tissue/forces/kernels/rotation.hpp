/// The rotation of an element: the one source of processors and devices.
///
/// `Lanes` as element_pull.hpp has it, and any(mask) of what a comparison of two registers answers. A lane
/// keeps its numbers while others still change, so that it has the same bits beside any of them.
#pragma once

#include "core/instructions/device_code.hpp"
#include "core/instructions/jacobi.hpp"
#include "problems/tissue/forces/kernels/small_matrices.hpp"

namespace hmax::kernel_loops {

/// A step of Newton's iteration R <- (R + R^-T) / 2 of W = R - I, without the difference of larger numbers:
///   R^-T - I = (D - (J - 1) I) / J,   D = tr(W) I - W^T + K with the cofactors K of W,   J = det R.
template <class Lanes, class V>
HMAX_DEVICE inline void step_to_rotation(const V (*W)[3], V (*next)[3]) {
  V K[3][3];
  const V trace = W[0][0] + W[1][1] + W[2][2], volume = volume_change<Lanes, V>(W, trace, K);
  const V half = Lanes::splat(0.5), inverse = half / (Lanes::splat(1) + volume);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      next[i][j] = half * W[i][j] + ((i == j ? trace - W[j][i] - volume : -W[j][i]) + K[i][j]) * inverse;
}

/// W = R - I of the rotation that makes tr(R^T F) largest, for every F. tr(R^T F) is quadratic in the unit
/// quaternion of R, whose best one is an eigenvector [horn1987quaternions], here by Jacobi's method. Where
/// several are best, one of them.
template <class Lanes, class V>
HMAX_DEVICE inline void best_rotation(const V (*H)[3], V (*W)[3]) {
  constexpr int sweeps = 6;
  V F[3][3], A[4][4], Q[4][4];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) F[i][j] = i == j ? H[i][j] + Lanes::splat(1) : H[i][j];
  const V trace = F[0][0] + F[1][1] + F[2][2];
  A[0][0] = trace;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    A[0][i + 1] = A[i + 1][0] = F[k][j] - F[j][k];
    A[j + 1][k + 1] = A[k + 1][j + 1] = F[j][k] + F[k][j];
    A[i + 1][i + 1] = F[i][i] - F[j][j] - F[k][k];
  }
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) Q[i][j] = Lanes::splat(i == j ? 1 : 0);
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (int p = 0; p < 3; ++p)
      for (int q = p + 1; q < 4; ++q) jacobi_rotation<Lanes>(p, q, A, Q);
  V most = A[0][0], w = Q[0][0], v[3] = {Q[1][0], Q[2][0], Q[3][0]};
  for (int k = 1; k < 4; ++k) {
    const auto is_more = A[k][k] > most;
    most = is_more ? A[k][k] : most;
    w = is_more ? Q[0][k] : w;
    for (int i = 0; i < 3; ++i) v[i] = is_more ? Q[i + 1][k] : v[i];
  }
  const V scale = Lanes::splat(2) / (w * w + dot<Lanes>(v, v));
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    W[i][i] = -scale * (v[j] * v[j] + v[k] * v[k]);
    W[j][k] = scale * (v[j] * v[k] - w * v[i]);
    W[k][j] = scale * (v[j] * v[k] + w * v[i]);
  }
}

/// W = R - I of the rotation R nearest to F = I + H, with the digits of a small H: Newton's iteration, which
/// doubles the digits each time [higham2008functions, 8], and best_rotation() where F inverts, is nearly
/// flat or small. R is a rotation also there.
/// @tparam Number  of a lane
template <class Lanes, class Number, class V>
HMAX_DEVICE inline void nearest_rotation(const V (*H)[3], V (*W)[3]) {
  constexpr int most_steps = 30;
  constexpr double least_volume = 1.0 / 64;  // det F = 1 + (J - 1) loses its digits below
  // The square of a last change, whose square is one of rounding.
  const V close = Lanes::splat(sizeof(Number) == sizeof(double) ? 1e-10 : 2.5e-5), none = Lanes::splat(-1);
  const V trace = H[0][0] + H[1][1] + H[2][2];
  V K[3][3], next[3][3];
  const V square = square_change<Lanes, V>(H, trace) + Lanes::splat(3),
          volume = volume_change<Lanes, V>(H, trace, K) + Lanes::splat(1);
  V change = volume > Lanes::splat(1e-3) * (square * Lanes::root(square)) ? Lanes::splat(1) : none;
  change = volume > Lanes::splat(least_volume) ? change : none;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) W[i][j] = H[i][j];
  for (int step = 0; step < most_steps && Lanes::any(change >= close); ++step) {
    const auto is_open = change >= close;
    step_to_rotation<Lanes>(W, next);
    V now = Lanes::splat(0);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const V d = next[i][j] - W[i][j];
        now += d * d;
        W[i][j] = is_open ? next[i][j] : W[i][j];
      }
    change = is_open ? now : change;
  }
  const auto is_found = (change < close ? change : none) >= Lanes::splat(0);
  step_to_rotation<Lanes>(W, next);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) W[i][j] = next[i][j];
  const V left = is_found ? none : Lanes::splat(1);
  if (!Lanes::any(left > none)) return;
  best_rotation<Lanes>(H, next);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) W[i][j] = is_found ? W[i][j] : next[i][j];
}

/// (tr(S) I - S)^-1 of S = sym(R^T F), which leads from the axis of R^T dF to that of R^T dR; zero where R is
/// not unique.
/// @param R  the rotation;  @param e  F - R
/// @param turn  entry (i, j), i <= j, at symmetric(i, j)
template <class Lanes, class V>
HMAX_DEVICE inline void turning(const V (*R)[3], const V (*e)[3], V (&turn)[6]) {
  V B[3][3], K[3][3], E[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) E[i][j] = R[0][i] * e[0][j] + R[1][i] * e[1][j] + R[2][i] * e[2][j];
  const V trace = E[0][0] + E[1][1] + E[2][2] + Lanes::splat(2);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) B[i][j] = i == j ? trace - E[i][i] : Lanes::splat(-0.5) * (E[i][j] + E[j][i]);
  cofactors_of<V>(B, K);
  const V det = dot<Lanes>(B[0], K[0]), zero = Lanes::splat(0),
          square = dot<Lanes>(B[0], B[0]) + dot<Lanes>(B[1], B[1]) + dot<Lanes>(B[2], B[2]);
  const auto is_unique = (det < zero ? -det : det) > Lanes::splat(1e-12) * (square * Lanes::root(square));
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) turn[symmetric(i, j)] = is_unique ? K[i][j] / det : zero;
}

}  // namespace hmax::kernel_loops
