/// How one point is moved: the one source of processors and devices.
#pragma once

#include <cmath>
#include <cstddef>

#include "core/instructions/device_code.hpp"
#include "core/instructions/jacobi.hpp"

namespace hmax {

/// Matrices here are symmetric, shape (3, 3), entry (i, j) at H[3 j + i]: those of i >= j alone are read.

/// H x = r by H = L L^T. @returns whether H has such factors; it has none where it is not positive definite
HMAX_DEVICE inline bool solve_by_factors(const double* H, const double* r, double* x) {
  double L[3][3];
  for (int k = 0; k < 3; ++k) {
    double pivot = H[std::ptrdiff_t{4} * k];
    if (k == 1) pivot = pivot - L[1][0] * L[1][0];
    if (k == 2) pivot = pivot - (L[2][0] * L[2][0] + L[2][1] * L[2][1]);
    if (pivot <= 0) return false;
    L[k][k] = std::sqrt(pivot);
    for (int i = k + 1; i < 3; ++i) {
      L[i][k] = H[3 * k + i];
      if (k == 1) L[i][k] = L[i][k] - L[i][0] * L[1][0];
      L[i][k] = L[i][k] / L[k][k];
    }
  }
  x[0] = r[0] / L[0][0];
  x[1] = (r[1] - L[1][0] * x[0]) / L[1][1];
  x[2] = (r[2] - (L[2][0] * x[0] + L[2][1] * x[1])) / L[2][2];
  x[2] = x[2] / L[2][2];
  x[1] = (x[1] - L[2][1] * x[2]) / L[1][1];
  x[0] = (x[0] - (L[1][0] * x[1] + L[2][0] * x[2])) / L[0][0];
  return true;
}

/// The same with the amounts of the eigenvalues of H in their places, of at least 1e-12 |H|.
HMAX_DEVICE inline void solve_by_amounts(const double* H, const double* r, double* x) {
  struct One {
    HMAX_DEVICE static double splat(double number) { return number; }
    HMAX_DEVICE static double root(double number) { return std::sqrt(number); }
  };
  constexpr int sweeps = 6;
  double A[3][3], Q[3][3], square = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      A[i][j] = i < j ? H[3 * i + j] : H[3 * j + i];
      Q[i][j] = i == j ? 1 : 0;
      square = square + A[i][j] * A[i][j];
    }
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) jacobi_rotation<One>(p, q, A, Q);
  const double least = 1e-12 * std::sqrt(square);
  for (int i = 0; i < 3; ++i) x[i] = 0;
  for (int k = 0; k < 3; ++k) {
    const double amount = A[k][k] < 0 ? -A[k][k] : A[k][k],
                 far = (Q[0][k] * r[0] + Q[1][k] * r[1] + Q[2][k] * r[2]) / (amount < least ? least : amount);
    for (int i = 0; i < 3; ++i) x[i] = x[i] + far * Q[i][k];
  }
}

/// The step of Newton's method for the equations of one point, see VertexBlockDescent.
/// @param mass     m_i [kg]
/// @param f, K, C  of PointForce; f and K are overwritten
/// @param away     q_i - q_0i - h v_0i
HMAX_DEVICE inline void move_of_point(double mass, double h, double* f, double* K, const double* C,
                                      const double* away, double* move) {
  const double inertia = mass / (h * h);
  for (int j = 0; j < 3; ++j) {
    f[j] = f[j] - inertia * away[j];
    for (int i = j; i < 3; ++i) K[3 * j + i] = K[3 * j + i] + C[3 * j + i] / h;
    double& diagonal = K[std::ptrdiff_t{4} * j];
    diagonal = diagonal + inertia;
  }
  if (!solve_by_factors(K, f, move)) solve_by_amounts(K, f, move);
}

}  // namespace hmax
