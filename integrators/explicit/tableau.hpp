/// Explicit Runge-Kutta methods as constexpr data, and the proof of their order at compile time.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace hmax {

/// The coefficients of an explicit Runge-Kutta method with `Stages` stages, letters as in [hairer1993solving]
/// II.1:
///   k_i = f(t + c_i h, y + h sum_{j<i} a_ij k_j),    y_new = y + h sum_i b_i k_i,
///   err = h sum_i b_err_i k_i   with b_err = b - b_hat, all zero where the method has no embedded one.
/// Kept in long double so that a state of any real type gets coefficients correct to its last digit.
template <std::size_t Stages>
struct ButcherTableau {
  static constexpr std::size_t stages = Stages;
  std::array<std::array<long double, Stages>, Stages> a{};  ///< a_ij: row i of stage i
  std::array<long double, Stages> b{}, b_err{}, c{};        ///< weights, b - b_hat, nodes
};

/// Continuous output as data: y(t + theta h) = y + h sum_i b_i(theta) k_i with b_i(theta) = sum_j p_ij
/// theta^(j+1), theta in [0, 1]. The sum runs over the stages of the method and `Extra` more, evaluated only
/// when asked for:
///   k_{s+e} = f(t + c_e h, y + h sum_j a_ej k_j).
template <std::size_t Stages, std::size_t Extra, std::size_t Degree>
struct Interpolant {
  static constexpr std::size_t stages = Stages, extra = Extra, degree = Degree;
  std::array<std::array<long double, Degree>, Stages + Extra> p{};  ///< p_ij: stage i, power j + 1 of theta
  std::array<std::array<long double, Stages + Extra>, Extra> a{};   ///< rows of the extra stages
  std::array<long double, Extra> c{};                               ///< nodes of the extra stages
};

namespace detail {
/// std::abs is not constexpr in C++20.
constexpr long double magnitude(long double x) { return x < 0 ? -x : x; }

/// The rows of a matrix one after the other, shape (N N).
template <std::size_t N>
constexpr std::array<long double, N * N> flattened(const std::array<std::array<long double, N>, N>& matrix) {
  std::array<long double, N * N> flat{};
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) flat[i * N + j] = matrix[i][j];
  return flat;
}
}  // namespace detail

/// The largest defect |sum_j a_ij - c_i| of the rows, and the row (counted from 0) it stands in.
struct RowDefect {
  std::size_t row;
  long double defect;
};

/// The row of A whose sum differs most from its node. NaN counts as the largest defect.
/// @param a  row-major, shape (s, s);  @param c  shape (s)
constexpr RowDefect largest_row_defect(std::span<const long double> a, std::span<const long double> c) {
  const std::size_t s = c.size();
  RowDefect worst{0, 0};
  for (std::size_t i = 0; i < s; ++i) {
    long double sum = 0;
    for (std::size_t j = 0; j < s; ++j) sum += a[i * s + j];
    if (const long double defect = detail::magnitude(sum - c[i]); !(defect <= worst.defect))
      worst = {i, defect};
  }
  return worst;
}

/// Calls visit(nodes, gamma, g) for every rooted tree t with at most max_nodes nodes, smaller trees first,
/// until it returns false; g_i(t), shape (s), is the product of stages in the order conditions
/// [hairer1993solving, II.2]. Trees are made by the Butcher product u o v (v grafted on the root of u): g(u o
/// v) = g(u) . (A g(v)) and gamma(u o v) = gamma(u) gamma(v) (|u| + |v|) / |u|. Children are grafted in
/// non-decreasing order, so each tree appears once. Row sums are not assumed: c does not enter.
/// With several matrices, of an additive method, every node but the root has one of as many colours, which
/// says whose matrix A it is grafted with [kennedy2003additive]; the colour of the root says whose weights b
/// to take and is left to visit.
/// @param parts  the matrices, each row-major, shape (s, s)
template <std::size_t Colours, class Visit>
constexpr void visit_trees(const std::array<std::span<const long double>, Colours>& parts, std::size_t s,
                           int max_nodes, Visit&& visit) {
  struct Tree {
    int nodes;                        ///< |t|
    long double gamma;                ///< product, over all nodes, of the size of the subtree at the node
    std::size_t last_child;           // tree and colour of the child grafted last; children never decrease
    std::vector<long double> g, a_g;  // a_g: A g of one colour after the other
  };
  // All trees so far, by number of nodes: the parts of larger ones.
  std::vector<Tree> trees;
  auto add = [&](int nodes, long double gamma, std::size_t last_child, std::vector<long double> g) {
    std::vector<long double> a_g(Colours * s, 0);
    for (std::size_t colour = 0; colour < Colours; ++colour)
      for (std::size_t i = 0; i < s; ++i)
        for (std::size_t j = 0; j < s; ++j) a_g[colour * s + i] += parts[colour][i * s + j] * g[j];
    trees.push_back({nodes, gamma, last_child, g, a_g});
    return visit(nodes, gamma, std::span<const long double>(g));
  };
  // The tree of one node: g = 1, gamma = 1.
  if (!add(1, 1, 0, std::vector<long double>(s, 1))) return;
  for (int nodes = 2; nodes <= max_nodes; ++nodes) {
    const std::size_t known = trees.size();
    for (std::size_t u = 0; u < known; ++u) {
      // A child is a tree v in one colour; children never decrease, so each tree appears once.
      for (std::size_t child = trees[u].last_child; child < known * Colours; ++child) {
        const std::size_t v = child / Colours, colour = child % Colours;
        if (trees[u].nodes + trees[v].nodes != nodes) continue;
        std::vector<long double> g = trees[u].g;
        for (std::size_t i = 0; i < s; ++i) g[i] *= trees[v].a_g[colour * s + i];
        const long double ratio = static_cast<long double>(nodes) / static_cast<long double>(trees[u].nodes);
        if (!add(nodes, trees[u].gamma * trees[v].gamma * ratio, child, std::move(g))) return;
      }
    }
  }
}

/// The same for the trees of one colour.
/// @param a  row-major, shape (s, s)
template <class Visit>
constexpr void visit_trees(std::span<const long double> a, std::size_t s, int max_nodes, Visit&& visit) {
  visit_trees(std::array<std::span<const long double>, 1>{a}, s, max_nodes, std::forward<Visit>(visit));
}

/// The order of the weights b with the stages a: the largest p <= max_order for which every rooted tree t
/// with at most p nodes satisfies  sum_i b_i g_i(t) = 1 / gamma(t)  [hairer1993solving, II.2, theorem 2.13].
/// @param tolerance  largest accepted defect of one condition, to allow for coefficients given as decimals
constexpr int order_of(std::span<const long double> a, std::span<const long double> b, int max_order = 8,
                       long double tolerance = 1e-14L) {
  int order = max_order;
  visit_trees(a, b.size(), max_order, [&](int nodes, long double gamma, std::span<const long double> g) {
    long double sum = 0;
    for (std::size_t i = 0; i < b.size(); ++i) sum += b[i] * g[i];
    if (detail::magnitude(sum - 1 / gamma) <= tolerance) return true;
    order = nodes - 1;
    return false;
  });
  return order;
}

/// The order of the propagated weights b, or of the embedded ones b - b_err: see above.
/// @param max_order  the highest order that is checked, and the highest that is returned
template <std::size_t S>
constexpr int order_of(const ButcherTableau<S>& tableau, bool embedded = false, int max_order = 8) {
  std::array<long double, S> b = tableau.b;
  for (std::size_t i = 0; embedded && i < S; ++i) b[i] -= tableau.b_err[i];
  return order_of(detail::flattened(tableau.a), b, max_order);
}

/// True when every row of a sums to its node: |sum_j a_ij - c_i| <= 1e-14.
template <std::size_t S>
constexpr bool rows_are_consistent(const ButcherTableau<S>& tableau) {
  return largest_row_defect(detail::flattened(tableau.a), tableau.c).defect <= 1e-14L;
}

/// True when no stage needs itself or a later one: a_ij = 0 for j >= i.
template <std::size_t S>
constexpr bool is_explicit(const ButcherTableau<S>& tableau) {
  for (std::size_t i = 0; i < S; ++i)
    for (std::size_t j = i; j < S; ++j)
      if (tableau.a[i][j] != 0) return false;
  return true;
}

/// First same as last: a_sj = b_j, b_s = 0 and c_s = 1. The last stage is then f at the new point and serves
/// as the first stage of the next step.
template <std::size_t S>
constexpr bool is_fsal(const ButcherTableau<S>& tableau) {
  if (S < 2 || tableau.c[S - 1] != 1 || tableau.b[S - 1] != 0) return false;
  for (std::size_t j = 0; j < S; ++j)
    if (tableau.a[S - 1][j] != tableau.b[j]) return false;
  return true;
}

/// True when a_sj = b_j: the result is the value of the last stage. Where A is invertible, R(infinity) = 0
/// [hairer1996solving, IV.3]; an explicit first stage needs a look at R itself.
template <std::size_t S>
constexpr bool is_stiffly_accurate(const ButcherTableau<S>& tableau) {
  return tableau.a[S - 1] == tableau.b;
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

/// The stages of the method and the extra ones of its interpolant as one tableau; only a and c are filled.
template <std::size_t S, std::size_t E, std::size_t D>
constexpr ButcherTableau<S + E> extended(const ButcherTableau<S>& tableau,
                                         const Interpolant<S, E, D>& interpolant) {
  ButcherTableau<S + E> all;
  for (std::size_t i = 0; i < S; ++i) {
    for (std::size_t j = 0; j < S; ++j) all.a[i][j] = tableau.a[i][j];
    all.c[i] = tableau.c[i];
  }
  for (std::size_t e = 0; e < E; ++e) {
    all.a[S + e] = interpolant.a[e];
    all.c[S + e] = interpolant.c[e];
  }
  return all;
}

/// The order of continuous output, uniform in theta: the largest p <= max_order for which every tree t with
/// at most p nodes satisfies  sum_i b_i(theta) g_i(t) = theta^|t| / gamma(t)  [hairer1993solving, II.6], that
/// is
///   sum_i p_ij g_i(t) = 1 / gamma(t) for j + 1 = |t|, else 0.
template <std::size_t S, std::size_t E, std::size_t D>
constexpr int order_of_interpolant(const ButcherTableau<S>& tableau, const Interpolant<S, E, D>& interpolant,
                                   int max_order = 8, long double tolerance = 1e-13L) {
  int order = max_order;
  const auto a = detail::flattened(extended(tableau, interpolant).a);
  visit_trees(a, S + E, max_order, [&](int nodes, long double gamma, std::span<const long double> g) {
    // sum_i p_ij g_i(t) = theta^|t| / gamma(t), power by power; degree D has no power |t| > D.
    bool satisfied = static_cast<std::size_t>(nodes) <= D;
    for (std::size_t j = 0; satisfied && j < D; ++j) {
      long double sum = static_cast<int>(j) + 1 == nodes ? -1 / gamma : 0.0L;
      for (std::size_t i = 0; i < S + E; ++i) sum += interpolant.p[i][j] * g[i];
      satisfied = detail::magnitude(sum) <= tolerance;
    }
    if (!satisfied) order = nodes - 1;
    return satisfied;
  });
  return order;
}

/// Continuous output that meets value and slope at both ends, of a method whose last stage is f(t + h,
/// y_new):
///   y(t + theta h) = y + theta (r_1 + (1 - theta)(r_2 + theta (r_3 + (1 - theta)(r_4 + theta (r_5 +
///   ...))))), r_1 = y_new - y,  r_2 = h k_1 - r_1,  r_3 = 2 r_1 - h (k_1 + k_s),  r_{4+m} = h sum_i d_mi
///   k_i.
/// Without rows d it is cubic Hermite interpolation. [hairer1993solving, II.6 (6.13) and the codes of its
/// appendix]
/// @param d  shape (rows, S + E)
/// @param a  the extra stages, shape (E, S + E);  @param c  their nodes, shape (E)
template <std::size_t S, std::size_t E = 0, std::size_t Rows = 0>
constexpr Interpolant<S, E, 3 + Rows> nested_interpolant(
    const ButcherTableau<S>& tableau, const std::array<std::array<long double, S + E>, Rows>& d = {},
    const std::array<std::array<long double, S + E>, E>& a = {}, const std::array<long double, E>& c = {}) {
  Interpolant<S, E, 3 + Rows> interpolant{.p = {}, .a = a, .c = c};
  for (std::size_t i = 0; i < S + E; ++i) {
    const long double b = i < S ? tableau.b[i] : 0.0L, first = i == 0, last = i == S - 1;
    // Weights of k_i in r_1 / h, r_2 / h and r_3 / h, then d.
    std::array<long double, 3 + Rows> r{b, first - b, 2 * b - first - last};
    for (std::size_t m = 0; m < Rows; ++m) r[3 + m] = d[m][i];
    // Horner from the innermost bracket: q <- (q + r_n) times theta or (1 - theta), q held as coefficients of
    // theta^j.
    std::array<long double, 4 + Rows> q{};
    for (std::size_t n = 3 + Rows; n-- > 0;) {
      q[0] += r[n];
      const bool by_theta = n % 2 == 0;
      for (std::size_t j = 3 + Rows; j > 0; --j) q[j] = by_theta ? q[j - 1] : q[j] - q[j - 1];
      if (by_theta) q[0] = 0;
    }
    for (std::size_t j = 0; j < 3 + Rows; ++j) interpolant.p[i][j] = q[j + 1];
  }
  return interpolant;
}

}  // namespace hmax
