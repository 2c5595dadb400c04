/// What a method says about itself, held against its coefficients.
#pragma once

#include <algorithm>
#include <cstddef>

#include "integrators/explicit/tableau.hpp"

namespace hmax {

/// The first claim of a method that its coefficients do not keep.
enum class BrokenClaim {
  none,                        ///< every claim holds
  explicit_stages,             ///< a_ij != 0 for some j >= i
  diagonally_implicit_stages,  ///< the diagonal is not gamma, or a_ij != 0 above it
  stability,                   ///< L-stable, but not A-stable and stiffly accurate
  row_sums,                    ///< sum_j a_ij != c_i
  order,                       ///< of b: missed or exceeded
  embedded_order,              ///< of b - b_err: missed or exceeded, or not claimed
  embedded_order_low,          ///< of b - b_err_low: missed or exceeded
  error_order,                 ///< not the one that follows from the orders
  interpolant                  ///< ends, nodes or order of continuous output
};

/// True when gamma stands on the whole diagonal, but for a first stage that may be explicit, and nothing
/// above.
template <std::size_t S>
constexpr bool is_diagonally_implicit(const ButcherTableau<S>& tableau, long double gamma) {
  for (std::size_t i = 0; i < S; ++i) {
    if (tableau.a[i][i] != gamma && !(i == 0 && tableau.a[0][0] == 0)) return false;
    for (std::size_t j = i + 1; j < S; ++j)
      if (tableau.a[i][j] != 0) return false;
  }
  return true;
}

/// True when y(t + h) - y_new = -constant h^3 d^3y/dt^3 + O(h^4): both trees of three nodes have this defect,
///   sum_i b_i c_i^2 / 2 - 1/6 = sum_ij b_i a_ij c_j - 1/6 = constant.
template <std::size_t S>
constexpr bool has_third_derivative_error(const ButcherTableau<S>& tableau, long double constant) {
  long double quadrature = 0, nested = 0;
  for (std::size_t i = 0; i < S; ++i) {
    quadrature += tableau.b[i] * tableau.c[i] * tableau.c[i] / 2;
    for (std::size_t j = 0; j < S; ++j) nested += tableau.b[i] * tableau.a[i][j] * tableau.c[j];
  }
  return detail::magnitude(quadrature - 1 / 6.0L - constant) < 1e-17L &&
         detail::magnitude(nested - 1 / 6.0L - constant) < 1e-17L;
}

/// Checks the continuous output of a method against its tableau, its own unless another one is given: it
/// meets both ends, its stages stand where they say, its order is reached and not exceeded.
template <class Method>
requires requires { Method::interpolant; }
constexpr bool keeps_its_interpolant_claims(const decltype(Method::interpolant)& interpolant,
                                            const decltype(Method::tableau)& tableau = Method::tableau) {
  constexpr bool implicit = requires { Method::gamma; };
  // Stages of the method and of the interpolant: the extra ones obey the same rules.
  const auto all = extended(tableau, interpolant);
  return meets_both_ends(tableau, interpolant) && (implicit || is_explicit(all)) &&
         rows_are_consistent(all) &&
         order_of_interpolant(tableau, interpolant, Method::interpolant_order + 1) ==
             Method::interpolant_order;
}

/// Checks the second error row of a method that makes one estimate of two: its order is reached and not
/// exceeded.
template <class Method>
requires requires { Method::b_err_low; }
constexpr bool keeps_its_low_order_claim(const decltype(Method::b_err_low)& b_err_low,
                                         const decltype(Method::tableau)& tableau = Method::tableau) {
  // The same tableau with the second error row in the place of the first one.
  auto low = tableau;
  low.b_err = b_err_low;
  return order_of(low, true, Method::embedded_order_low + 1) == Method::embedded_order_low;
}

/// Checks every claim of `Method` (see tableaux.hpp and dirk_tableaux.hpp) against a tableau, its own unless
/// another one is given: the shape of its stages, row sums, orders that are reached and not exceeded,
/// continuous output that meets both ends.
template <class Method>
constexpr BrokenClaim broken_claim(const decltype(Method::tableau)& tableau = Method::tableau) {
  auto has_order = [&](const auto& t, bool embedded, int order) {
    return order_of(t, embedded, order + 1) == order;
  };
  constexpr bool implicit = requires { Method::gamma; };
  if constexpr (implicit) {
    if (!is_diagonally_implicit(tableau, Method::gamma)) return BrokenClaim::diagonally_implicit_stages;
    // L-stable: A-stable, and R(infinity) = 0 by stiff accuracy.
    if (Method::l_stable && !(Method::a_stable && is_stiffly_accurate(tableau)))
      return BrokenClaim::stability;
  } else if (!is_explicit(tableau)) {
    return BrokenClaim::explicit_stages;
  }
  if (!rows_are_consistent(tableau)) return BrokenClaim::row_sums;
  if (!has_order(tableau, false, Method::order)) return BrokenClaim::order;
  if (has_error_estimate(tableau) != (Method::embedded_order > 0)) return BrokenClaim::embedded_order;
  if (Method::embedded_order > 0 && !has_order(tableau, true, Method::embedded_order))
    return BrokenClaim::embedded_order;
  if constexpr (requires { Method::b_err_low; }) {
    if (!keeps_its_low_order_claim<Method>(Method::b_err_low, tableau))
      return BrokenClaim::embedded_order_low;
    // |e|^2 / |e_low| with e = O(h^(p + 1)) and e_low = O(h^(p_low + 1)).
    if (Method::error_order != 2 * (Method::embedded_order + 1) - (Method::embedded_order_low + 1))
      return BrokenClaim::error_order;
  } else if constexpr (requires { Method::third_derivative_error; }) {
    if (!has_third_derivative_error(tableau, Method::third_derivative_error) || Method::error_order != 3)
      return BrokenClaim::error_order;
  } else if (Method::error_order !=
             (Method::embedded_order > 0 ? std::min(Method::order, Method::embedded_order) + 1 : 0)) {
    // err = y_new - y_hat is of the lower order of the two, plus one.
    return BrokenClaim::error_order;
  }
  if constexpr (requires { Method::interpolant; })
    if (!keeps_its_interpolant_claims<Method>(Method::interpolant, tableau)) return BrokenClaim::interpolant;
  return BrokenClaim::none;
}

/// A method of which every claim is true. The lists of methods are compiled with this constraint.
template <class Method>
concept ProvesItsClaims = broken_claim<Method>()
== BrokenClaim::none;

}  // namespace hmax
