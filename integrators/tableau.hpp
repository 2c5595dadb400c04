/// Explicit Runge-Kutta methods as constexpr data, and the proof of their order at compile time.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace hmax {

/// The coefficients of an explicit Runge-Kutta method with `Stages` stages, letters as in [hairer1993solving] II.1:
///   k_i = f(t + c_i h, y + h sum_{j<i} a_ij k_j),    y_new = y + h sum_i b_i k_i,
///   err = h sum_i b_err_i k_i   with b_err = b - b_hat, all zero where the method has no embedded one.
/// Kept in long double so that a state of any real type gets coefficients correct to its last digit.
template <std::size_t Stages>
struct ButcherTableau {
  static constexpr std::size_t stages = Stages;
  std::array<std::array<long double, Stages>, Stages> a{};
  std::array<long double, Stages> b{}, b_err{}, c{};
};

/// Continuous output as data: y(t + theta h) = y + h sum_i b_i(theta) k_i with b_i(theta) = sum_j p_ij theta^(j+1),
/// theta in [0, 1]. The sum runs over the stages of the method and `Extra` more, evaluated only when asked for:
///   k_{s+e} = f(t + c_e h, y + h sum_j a_ej k_j).
template <std::size_t Stages, std::size_t Extra, std::size_t Degree>
struct Interpolant {
  static constexpr std::size_t stages = Stages, extra = Extra, degree = Degree;
  std::array<std::array<long double, Degree>, Stages + Extra> p{};
  std::array<std::array<long double, Stages + Extra>, Extra> a{};
  std::array<long double, Extra> c{};
};

namespace detail {
constexpr long double magnitude(long double x) { return x < 0 ? -x : x; }
}  // namespace detail

/// The largest defect |sum_j a_ij - c_i| of the rows, and the row (counted from 0) it stands in.
struct RowDefect {
  std::size_t row;
  long double defect;
};

/// Views of a tableau of any stage count: a is row-major, shape (s, s); b and c have shape (s).
constexpr RowDefect largest_row_defect(std::span<const long double> a, std::span<const long double> c) {
  const std::size_t s = c.size();
  RowDefect worst{0, 0};
  for (std::size_t i = 0; i < s; ++i) {
    long double sum = 0;
    for (std::size_t j = 0; j < s; ++j) sum += a[i * s + j];
    if (const long double defect = detail::magnitude(sum - c[i]); !(defect <= worst.defect)) worst = {i, defect};
  }
  return worst;
}

/// The order of the weights b with the stages (a, c): the largest p <= max_order for which every rooted tree t with
/// at most p nodes satisfies  sum_i b_i g_i(t) = 1 / gamma(t)  [hairer1993solving, II.2, theorem 2.13].
/// Trees are made by the Butcher product u o v (v grafted on the root of u): g(u o v) = g(u) . (A g(v)) and
/// gamma(u o v) = gamma(u) gamma(v) (|u| + |v|) / |u|. Children are grafted in non-decreasing order, so each tree
/// appears once. Row sums are not assumed: c does not enter.
/// @param tolerance  largest accepted defect of one condition, to allow for coefficients given as decimals
constexpr int order_of(std::span<const long double> a, std::span<const long double> b, int max_order = 8,
                       long double tolerance = 1e-14L) {
  struct Tree {
    int nodes;
    long double gamma;
    std::size_t last_child;  // index of the child grafted last; children never decrease
  };
  const std::size_t s = b.size();
  std::vector<Tree> trees{{1, 1, 0}};
  std::vector<std::vector<long double>> g{std::vector<long double>(s, 1)};
  auto satisfied = [&](std::size_t t) {
    long double sum = 0;
    for (std::size_t i = 0; i < s; ++i) sum += b[i] * g[t][i];
    return detail::magnitude(sum - 1 / trees[t].gamma) <= tolerance;
  };
  if (!satisfied(0)) return 0;
  for (int order = 2; order <= max_order; ++order) {
    const std::size_t known = trees.size();
    for (std::size_t u = 0; u < known; ++u) {
      for (std::size_t v = trees[u].last_child; v < known; ++v) {
        if (trees[u].nodes + trees[v].nodes != order) continue;
        const auto nodes = static_cast<long double>(order);
        std::vector<long double> weights(s, 0);
        for (std::size_t i = 0; i < s; ++i) {
          long double sum = 0;
          for (std::size_t j = 0; j < s; ++j) sum += a[i * s + j] * g[v][j];
          weights[i] = g[u][i] * sum;
        }
        trees.push_back({order, trees[u].gamma * trees[v].gamma * nodes / static_cast<long double>(trees[u].nodes), v});
        g.push_back(weights);
        if (!satisfied(trees.size() - 1)) return order - 1;
      }
    }
  }
  return max_order;
}

/// The order of the propagated weights b, or of the embedded ones b - b_err.
template <std::size_t S>
constexpr int order_of(const ButcherTableau<S>& tableau, bool embedded = false, int max_order = 8) {
  std::array<long double, S * S> a{};
  std::array<long double, S> b{};
  for (std::size_t i = 0; i < S; ++i) {
    for (std::size_t j = 0; j < S; ++j) a[i * S + j] = tableau.a[i][j];
    b[i] = tableau.b[i] - (embedded ? tableau.b_err[i] : 0.0L);
  }
  return order_of(a, b, max_order);
}

/// True when every row of a sums to its node c to within rounding.
template <std::size_t S>
constexpr bool rows_are_consistent(const ButcherTableau<S>& tableau) {
  std::array<long double, S * S> a{};
  for (std::size_t i = 0; i < S; ++i)
    for (std::size_t j = 0; j < S; ++j) a[i * S + j] = tableau.a[i][j];
  return largest_row_defect(a, tableau.c).defect <= 1e-14L;
}

/// First same as last: the last stage is f at the new point and serves as the first stage of the next step.
template <std::size_t S>
constexpr bool is_fsal(const ButcherTableau<S>& tableau) {
  if (S < 2 || tableau.c[S - 1] != 1 || tableau.b[S - 1] != 0) return false;
  for (std::size_t j = 0; j < S; ++j)
    if (tableau.a[S - 1][j] != tableau.b[j]) return false;
  return true;
}

/// True when the tableau carries an embedded method, that is an error estimate.
template <std::size_t S>
constexpr bool has_error_estimate(const ButcherTableau<S>& tableau) {
  for (const long double e : tableau.b_err)
    if (e != 0) return true;
  return false;
}

/// The interpolant meets both ends: b_i(1) = b_i (extra stages have b_i = 0), and b_i(0) = 0 by construction.
template <std::size_t S, std::size_t E, std::size_t D>
constexpr bool meets_both_ends(const ButcherTableau<S>& tableau, const Interpolant<S, E, D>& interpolant) {
  for (std::size_t i = 0; i < S + E; ++i) {
    long double sum = 0;
    for (const long double p : interpolant.p[i]) sum += p;
    if (detail::magnitude(sum - (i < S ? tableau.b[i] : 0.0L)) > 1e-13L) return false;
  }
  return true;
}

}  // namespace hmax
