/// The coefficients of Adams methods, computed from their definitions: integrals of the polynomial through
/// past values of f. adams_proof.cpp proves their orders.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace hmax::adams {

/// gamma_j, j < N: weights of backward differences in the explicit Adams methods,
///   y_n+1 = y_n + h sum_j gamma_j nabla^j f_n,    sum_{i <= m} gamma_i / (m + 1 - i) = 1
/// [hairer1993solving, III.1].
template <std::size_t N>
constexpr std::array<long double, N> gamma() {
  std::array<long double, N> gamma{};
  for (std::size_t m = 0; m < N; ++m) {
    gamma[m] = 1;
    for (std::size_t i = 0; i < m; ++i) gamma[m] -= gamma[i] / static_cast<long double>(m + 1 - i);
  }
  return gamma;
}

/// gamma*_j, j < N: the same of the implicit Adams methods, which end in f_n+1,
///   y_n+1 = y_n + h sum_j gamma*_j nabla^j f_n+1,    sum_{i <= m} gamma*_i / (m + 1 - i) = 0 for m >= 1.
template <std::size_t N>
constexpr std::array<long double, N> gamma_star() {
  std::array<long double, N> gamma{};
  for (std::size_t m = 0; m < N; ++m) {
    gamma[m] = m == 0 ? 1 : 0;
    for (std::size_t i = 0; i < m; ++i) gamma[m] -= gamma[i] / static_cast<long double>(m + 1 - i);
  }
  return gamma;
}

/// From weights of backward differences to weights of the values themselves, the newest first:
///   sum_j g_j nabla^j f_n = sum_i w_i f_n-i,    w_i = (-1)^i sum_{j >= i} binomial(j, i) g_j.
/// @param g  shape (k), k < 14;  @param w  shape (k)
template <class Real>
constexpr void weights_of_values(std::span<const Real> g, std::span<Real> w) {
  for (Real& weight : w) weight = 0;
  std::array<Real, 14> signed_binomial{1};  // (-1)^i binomial(j, i) of the row j
  for (std::size_t j = 0; j < g.size(); ++j) {
    // Row j of Pascal's triangle from row j - 1, with alternating signs.
    for (std::size_t i = j; j > 0 && i > 0; --i) signed_binomial[i] -= signed_binomial[i - 1];
    for (std::size_t i = 0; i <= j; ++i) w[i] += g[j] * signed_binomial[i];
  }
}

/// g_i with  y(t + s) = y(t) + s sum_i g_i phi_i  for the polynomial whose derivative passes through the
/// values of f that the modified divided differences phi_i at t stand for [shampine1975computer]:
///   c_1,q = 1 / q,   c_i,q = (s + psi_i-2) / psi_i-1 c_i-1,q - s / psi_i-1 c_i-1,q+1,   g_i = c_i,1,
/// where psi_i is the distance from t back to the i-th value before it. At equal distances phi_i is
/// nabla^(i-1) f.
/// @param s    [s], of any sign
/// @param psi  psi_1, psi_2, ... [s], shape (k - 1) at least;  @param g  shape (k), k <= 14
template <class Real>
constexpr void interpolation_weights(Real s, std::span<const Real> psi, std::span<Real> g) {
  std::array<Real, 14> c{};
  const std::size_t k = g.size();
  for (std::size_t q = 0; q < k; ++q) c[q] = Real(1) / static_cast<Real>(q + 1);
  g[0] = c[0];
  for (std::size_t i = 1; i < k; ++i) {
    const Real before = i == 1 ? Real(0) : psi[i - 2];
    const Real here = (s + before) / psi[i - 1], next = s / psi[i - 1];
    for (std::size_t q = 0; q + i < k; ++q) c[q] = here * c[q] - next * c[q + 1];
    g[i] = c[0];
  }
}

/// The order of weights of values, the newest first: the largest p for which
///   sum_i w_i (x - i)^q = 1 / (q + 1) for every q < p,
/// that is, for which y_n+1 = y_n + h sum_i w_i f is exact when f is a polynomial of degree below p.
/// @param x          where the newest value stands, in steps from t_n: 0 in explicit formulas, 1 in implicit
///                   ones
/// @param tolerance  largest accepted defect of one condition
constexpr int order_of(std::span<const long double> w, int x, int max_order, long double tolerance = 1e-15L) {
  for (int q = 0; q < max_order; ++q) {
    long double defect = -1 / static_cast<long double>(q + 1);
    for (std::size_t i = 0; i < w.size(); ++i) {
      long double power = 1;
      for (int n = 0; n < q; ++n) power *= static_cast<long double>(x) - static_cast<long double>(i);
      defect += w[i] * power;
    }
    if (defect > tolerance || defect < -tolerance) return q;
  }
  return max_order;
}

}  // namespace hmax::adams
