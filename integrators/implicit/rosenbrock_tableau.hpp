/// Rosenbrock and W-methods as constexpr data, and the proof of their order at compile time.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "integrators/explicit/tableau.hpp"

namespace hmax {

/// A method with `Stages` stages in the variables u = h Gamma k, in which a step needs no product with J
/// [hairer1996solving, IV.7 (7.25)]:
///   (I - h gamma J) u_i = h gamma [ f(t + alpha_i h, y + sum_j a_ij u_j) + h d_i df/dt ] + gamma sum_j c_ij
///   u_j, y_new = y + sum_i m_i u_i,   err = sum_i e_i u_i,
/// a and c strictly lower triangular, shape (s, s). Kept in long double so that a state of any real type gets
/// coefficients correct to its last digit, or to the last published one.
template <std::size_t Stages>
struct RosenbrockTableau {
  static constexpr std::size_t stages = Stages;  ///< s
  long double gamma = 0;                         ///< the diagonal of Gamma, the same in all stages
  /// Rows of the arguments, and of the coupling of the u_i.
  std::array<std::array<long double, Stages>, Stages> a{}, c{};
  std::array<long double, Stages> m{}, e{};      ///< e = m - m_hat, all zero without an embedded method
  std::array<long double, Stages> alpha{}, d{};  ///< nodes, and the row sums of Gamma
};

/// Continuous output: y(t + theta h) = y + sum_i u_i sum_j p_ij theta^(j+1), theta in [0, 1].
template <std::size_t Stages, std::size_t Degree>
struct RosenbrockInterpolant {
  static constexpr std::size_t degree = Degree;
  std::array<std::array<long double, Degree>, Stages> p{};  ///< p_ij: stage i, power j + 1 of theta
};

/// The same method in its original variables [hairer1996solving, IV.7 (7.4)]:
///   k_i = f(t + alpha_i h, y + h sum_j alpha_ij k_j) + h J sum_j gamma_ij k_j + h d_i df/dt,
///   y_new = y + h sum_i b_i k_i,
/// where gamma_ij is lower triangular with gamma on its diagonal.
template <std::size_t S>
struct RosenbrockForm {
  std::array<std::array<long double, S>, S> alpha{}, gamma{};  ///< Gamma with its diagonal
  std::array<long double, S> b{}, b_err{};                     ///< weights, and b - b_hat
};

namespace detail {
template <std::size_t S>
using Square = std::array<std::array<long double, S>, S>;

/// M^-1 of a lower triangular M with nonzero diagonal, by forward substitution column by column.
template <std::size_t S>
constexpr Square<S> inverse_of_lower(const Square<S>& lower) {
  Square<S> inverse{};
  for (std::size_t j = 0; j < S; ++j)
    for (std::size_t i = j; i < S; ++i) {
      long double sum = i == j ? 1 : 0;
      for (std::size_t k = j; k < i; ++k) sum -= lower[i][k] * inverse[k][j];
      inverse[i][j] = sum / lower[i][i];
    }
  return inverse;
}

/// v M as a row vector.
template <std::size_t S>
constexpr std::array<long double, S> row_times(const std::array<long double, S>& v, const Square<S>& M) {
  std::array<long double, S> product{};
  for (std::size_t i = 0; i < S; ++i)
    for (std::size_t j = 0; j < S; ++j) product[j] += v[i] * M[i][j];
  return product;
}

/// sum_j M_ij of each row i.
template <std::size_t S>
constexpr std::array<long double, S> row_sums(const Square<S>& M) {
  std::array<long double, S> sums{};
  for (std::size_t i = 0; i < S; ++i)
    for (std::size_t j = 0; j < S; ++j) sums[i] += M[i][j];
  return sums;
}

/// Gamma^-1 = I / gamma - (c_ij).
template <std::size_t S>
constexpr Square<S> inverse_gamma(const RosenbrockTableau<S>& tableau) {
  Square<S> inverse{};
  for (std::size_t i = 0; i < S; ++i)
    for (std::size_t j = 0; j <= i; ++j) inverse[i][j] = i == j ? 1 / tableau.gamma : -tableau.c[i][j];
  return inverse;
}
}  // namespace detail

/// From the original variables to those of the stepper, u = h Gamma k [hairer1996solving, IV.7]:
///   a = alpha Gamma^-1,   c = I / gamma - Gamma^-1,   m = b Gamma^-1,   e = b_err Gamma^-1,
///   alpha_i = sum_j alpha_ij,   d_i = sum_j gamma_ij.
template <std::size_t S>
constexpr RosenbrockTableau<S> transformed(const RosenbrockForm<S>& form) {
  const auto inverse = detail::inverse_of_lower(form.gamma);
  RosenbrockTableau<S> tableau{.gamma = form.gamma[0][0],
                               .a = {},
                               .c = {},
                               .m = detail::row_times(form.b, inverse),
                               .e = detail::row_times(form.b_err, inverse),
                               .alpha = detail::row_sums(form.alpha),
                               .d = detail::row_sums(form.gamma)};
  for (std::size_t i = 0; i < S; ++i) {
    tableau.a[i] = detail::row_times(form.alpha[i], inverse);
    for (std::size_t j = 0; j < i; ++j) tableau.c[i][j] = -inverse[i][j];
  }
  return tableau;
}

/// The way back, to the variables of the order conditions: Gamma = (I / gamma - c)^-1, alpha = a Gamma,
/// b = m Gamma, b_err = e Gamma.
template <std::size_t S>
constexpr RosenbrockForm<S> original(const RosenbrockTableau<S>& tableau) {
  RosenbrockForm<S> form{
      .alpha = {}, .gamma = detail::inverse_of_lower(detail::inverse_gamma(tableau)), .b = {}, .b_err = {}};
  for (std::size_t i = 0; i < S; ++i) form.alpha[i] = detail::row_times(tableau.a[i], form.gamma);
  form.b = detail::row_times(tableau.m, form.gamma);
  form.b_err = detail::row_times(tableau.e, form.gamma);
  return form;
}

/// Continuous output given in the original variables, y + h sum_i k_i sum_j p_ij theta^(j+1). The weights
/// of u are Gamma^-T p, since h k = Gamma^-1 u.
template <std::size_t S, std::size_t D>
constexpr RosenbrockInterpolant<S, D> transformed(const RosenbrockForm<S>& form,
                                                  const std::array<std::array<long double, D>, S>& p) {
  const auto inverse = detail::inverse_of_lower(form.gamma);
  RosenbrockInterpolant<S, D> interpolant;
  for (std::size_t i = 0; i < S; ++i)
    for (std::size_t k = 0; k < S; ++k)
      for (std::size_t j = 0; j < D; ++j) interpolant.p[i][j] += p[k][j] * inverse[k][i];
  return interpolant;
}

/// Continuous output of the form of the RODAS codes, with rows r_n = sum_i h_ni u_i:
///   y(t + theta h) = (1 - theta) y + theta [ y_new + (1 - theta) (r_1 + theta (r_2 + theta (r_3 + ...))) ].
template <std::size_t S, std::size_t Rows>
constexpr RosenbrockInterpolant<S, Rows + 1> rodas_interpolant(
    const std::array<long double, S>& m, const std::array<std::array<long double, S>, Rows>& h) {
  RosenbrockInterpolant<S, Rows + 1> interpolant;
  for (std::size_t i = 0; i < S; ++i) {
    interpolant.p[i][0] = m[i];
    // theta (1 - theta) theta^n r_(n+1) = (theta^(n+1) - theta^(n+2)) r_(n+1)
    for (std::size_t n = 0; n < Rows; ++n) {
      interpolant.p[i][n] += h[n][i];
      interpolant.p[i][n + 1] -= h[n][i];
    }
  }
  return interpolant;
}

/// exact: J = df/dy at (t, y). anything: the conditions hold for every matrix in the place of J
/// (W-methods).
enum class JacobianIs { exact, anything };

/// Calls visit(nodes, wanted, g) for every tree with at most max_nodes nodes, smaller ones first, until it
/// returns false; the condition of the tree is sum_i b_i g_i = wanted.
/// With the exact Jacobian the trees are those of Runge-Kutta methods, wanted = 1 / gamma(t), and a node with
/// a single child sums over alpha_ij + gamma_ij instead of alpha_ij [hairer1996solving, IV.7, theorem 7.3].
/// With any matrix in its place a node with a single child comes in two kinds, over alpha_ij and over
/// gamma_ij; trees with a node of the second kind must contribute nothing: wanted = 0.
template <std::size_t S, class Visit>
constexpr void visit_trees(const RosenbrockForm<S>& form, JacobianIs jacobian, int max_nodes, Visit&& visit) {
  using Vector = std::array<long double, S>;
  struct Tree {
    int nodes;
    long double wanted;
    bool may_grow;           // whether more children may be grafted on its root
    std::size_t last_child;  // children are grafted in non-decreasing order, so each tree appears once
    Vector product;          // of its children, each summed over alpha_ij
    Vector g;
  };
  // M v
  auto times = [](const detail::Square<S>& M, const Vector& v) {
    Vector result{};
    for (std::size_t i = 0; i < S; ++i)
      for (std::size_t j = 0; j < S; ++j) result[i] += M[i][j] * v[j];
    return result;
  };
  std::vector<Tree> trees;
  auto add = [&](const Tree& tree) {
    trees.push_back(tree);
    return visit(tree.nodes, tree.wanted, std::span<const long double>(tree.g));
  };
  // The tree of one node: wanted = 1, g = 1.
  Vector ones{};
  ones.fill(1);
  if (!add({1, 1, true, 0, ones, ones})) return;
  for (int nodes = 2; nodes <= max_nodes; ++nodes) {
    const std::size_t known = trees.size();
    for (std::size_t u = 0; u < known; ++u) {
      for (std::size_t v = trees[u].last_child; trees[u].may_grow && v < known; ++v) {
        if (trees[u].nodes + trees[v].nodes != nodes) continue;
        // u o v: v grafted on the root of u.
        Tree grown = trees[u];
        const Vector over_alpha = times(form.alpha, trees[v].g), over_gamma = times(form.gamma, trees[v].g);
        const bool single = trees[u].nodes == 1;
        for (std::size_t i = 0; i < S; ++i) grown.product[i] *= over_alpha[i];
        grown.g = grown.product;
        for (std::size_t i = 0; single && jacobian == JacobianIs::exact && i < S; ++i)
          grown.g[i] += over_gamma[i];
        // 1 / gamma(u o v) = |u| / (|u| + |v|) / (gamma(u) gamma(v)), zero when u or v has the second kind.
        grown.wanted = trees[u].wanted * trees[v].wanted * static_cast<long double>(trees[u].nodes) /
                       static_cast<long double>(nodes);
        grown.nodes = nodes;
        grown.last_child = v;
        if (!add(grown)) return;
        // A single child over gamma_ij: a tree of the second kind, on which nothing more is grafted.
        if (single && jacobian == JacobianIs::anything && !add({nodes, 0, false, v, {}, over_gamma})) return;
      }
    }
  }
}

/// The order of the weights b: the largest p <= max_order whose conditions hold for every tree with at most p
/// nodes.
/// @param tolerance  largest accepted defect of one condition: published coefficients have 16 digits
template <std::size_t S>
constexpr int order_of(const RosenbrockForm<S>& form, const std::array<long double, S>& b,
                       JacobianIs jacobian, int max_order = 6, long double tolerance = 1e-16L) {
  int order = max_order;
  visit_trees(form, jacobian, max_order, [&](int nodes, long double wanted, std::span<const long double> g) {
    long double sum = -wanted;
    for (std::size_t i = 0; i < S; ++i) sum += b[i] * g[i];
    if (detail::magnitude(sum) <= tolerance) return true;
    order = nodes - 1;
    return false;
  });
  return order;
}

/// The order of continuous output with the exact Jacobian, uniform in theta: the largest p <= max_order for
/// which every tree with at most p nodes satisfies  sum_i b_i(theta) g_i = wanted theta^|t|, power by
/// power.
template <std::size_t S, std::size_t D>
constexpr int order_of_interpolant(const RosenbrockTableau<S>& tableau,
                                   const RosenbrockInterpolant<S, D>& interpolant, int max_order = 6,
                                   long double tolerance = 1e-14L) {
  int order = max_order;
  const auto form = original(tableau);
  detail::Square<S> b{};  // row j: the weights of theta^(j+1)
  for (std::size_t j = 0; j < D; ++j) {
    std::array<long double, S> column{};
    for (std::size_t i = 0; i < S; ++i) column[i] = interpolant.p[i][j];
    b[j] = detail::row_times(column, form.gamma);
  }
  visit_trees(form, JacobianIs::exact, max_order,
              [&](int nodes, long double wanted, std::span<const long double> g) {
                bool satisfied = static_cast<std::size_t>(nodes) <= D;
                for (std::size_t j = 0; satisfied && j < D; ++j) {
                  long double sum = static_cast<int>(j) + 1 == nodes ? -wanted : 0.0L;
                  for (std::size_t i = 0; i < S; ++i) sum += b[j][i] * g[i];
                  satisfied = detail::magnitude(sum) <= tolerance;
                }
                if (!satisfied) order = nodes - 1;
                return satisfied;
              });
  return order;
}

/// R(infinity) = 1 - b^T (alpha_ij + gamma_ij)^-1 1 with the exact Jacobian; zero for L-stable methods.
/// [hairer1996solving, IV.7 (7.14)]
template <std::size_t S>
constexpr long double stability_at_infinity(const RosenbrockForm<S>& form) {
  detail::Square<S> beta{};
  for (std::size_t i = 0; i < S; ++i)
    for (std::size_t j = 0; j <= i; ++j) beta[i][j] = form.alpha[i][j] + form.gamma[i][j];
  long double sum = 1;
  for (const long double x : detail::row_times(form.b, detail::inverse_of_lower(beta))) sum -= x;
  return sum;
}

/// First same as last: the slope of the last stage is f at the new point.
template <std::size_t S>
constexpr bool is_fsal(const RosenbrockTableau<S>& tableau) {
  return S > 1 && tableau.alpha[S - 1] == 1 && tableau.m[S - 1] == 0 && tableau.a[S - 1] == tableau.m;
}

/// True when the tableau has an error estimate: some e_i is not zero.
template <std::size_t S>
constexpr bool has_error_estimate(const RosenbrockTableau<S>& tableau) {
  for (const long double e : tableau.e)
    if (e != 0) return true;
  return false;
}

/// The first claim of a method that its coefficients do not keep.
enum class BrokenRosenbrockClaim {
  none,            ///< every claim holds
  triangles,       ///< a or c is not strictly lower triangular
  row_sums,        ///< alpha_i or d_i is not the sum of its row
  order,           ///< with the exact Jacobian: missed or exceeded
  w_order,         ///< with any Jacobian: missed or exceeded
  embedded_order,  ///< missed, exceeded or not claimed
  error_order,     ///< not min(order, embedded_order) + 1
  interpolant,     ///< ends or order of continuous output
  l_stable,        ///< R(infinity) = 0 claimed wrongly, or not claimed
  stiffly_accurate
};

/// Checks the continuous output of a method, its own unless another one is given: it meets both ends, its
/// order is reached and not exceeded.
template <class Method>
constexpr bool keeps_its_rosenbrock_interpolant_claims(const decltype(Method::interpolant)& interpolant,
                                                       const decltype(Method::tableau)& tableau) {
  // sum_j p_ij = m_i: the output at theta = 1 is y_new.
  for (std::size_t i = 0; i < tableau.stages; ++i) {
    long double at_end = -tableau.m[i];
    for (const long double p : interpolant.p[i]) at_end += p;
    if (detail::magnitude(at_end) > 1e-13L) return false;
  }
  return order_of_interpolant(tableau, interpolant, Method::interpolant_order + 1) ==
         Method::interpolant_order;
}

/// Checks every claim of `Method` (see rosenbrock_tableaux.hpp) against a tableau, its own unless another
/// one is given: orders that are reached and not exceeded, row sums, R(infinity) = 0 of L-stable methods.
/// The tests check A-stability.
template <class Method>
constexpr BrokenRosenbrockClaim broken_rosenbrock_claim(
    const decltype(Method::tableau)& tableau = Method::tableau) {
  using enum BrokenRosenbrockClaim;
  constexpr std::size_t s = Method::tableau.stages;
  for (std::size_t i = 0; i < s; ++i)
    for (std::size_t j = i; j < s; ++j)
      if (tableau.a[i][j] != 0 || tableau.c[i][j] != 0) return triangles;
  const auto form = original(tableau);
  // alpha_i and d_i are stored: they must be the row sums of the coefficients in use.
  const auto alpha = detail::row_sums(form.alpha), d = detail::row_sums(form.gamma);
  for (std::size_t i = 0; i < s; ++i)
    if (detail::magnitude(alpha[i] - tableau.alpha[i]) > 1e-14L ||
        detail::magnitude(d[i] - tableau.d[i]) > 1e-14L)
      return row_sums;
  auto reaches = [&](const auto& b, JacobianIs jacobian, int claimed) {
    return order_of(form, b, jacobian, claimed + 1) == claimed;
  };
  if (!reaches(form.b, JacobianIs::exact, Method::order)) return order;
  if (!reaches(form.b, JacobianIs::anything, Method::w_order)) return w_order;
  if (has_error_estimate(tableau) != (Method::embedded_order > 0)) return embedded_order;
  if (Method::embedded_order > 0) {
    auto b_hat = form.b;
    // b_hat = b - b_err
    for (std::size_t i = 0; i < s; ++i) b_hat[i] -= form.b_err[i];
    if (!reaches(b_hat, JacobianIs::exact, Method::embedded_order)) return embedded_order;
    const int lower = Method::embedded_order < Method::order ? Method::embedded_order : Method::order;
    if (Method::error_order != lower + 1) return error_order;
  } else if (Method::error_order != 0) {
    return error_order;
  }
  if (!keeps_its_rosenbrock_interpolant_claims<Method>(Method::interpolant, tableau)) return interpolant;
  // The end of a step and the embedded solution are the last arguments: e is the last u alone.
  for (std::size_t j = 0; Method::stiffly_accurate && j < s; ++j)
    if (tableau.m[j] - tableau.a[s - 1][j] != tableau.e[j] || tableau.e[j] != (j + 1 == s ? 1 : 0))
      return stiffly_accurate;
  if (Method::l_stable != (detail::magnitude(stability_at_infinity(form)) < 1e-12L)) return l_stable;
  return none;
}

}  // namespace hmax
