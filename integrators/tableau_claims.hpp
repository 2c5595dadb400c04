/// What a method says about itself, held against its coefficients.
#pragma once

#include <cstddef>

#include "integrators/tableau.hpp"

namespace hmax {

/// The first claim of a method that its coefficients do not keep.
enum class BrokenClaim {
  none,
  explicit_stages,
  row_sums,
  order,
  embedded_order,
  embedded_order_low,
  error_order,
  interpolant
};

/// Checks every claim of `Method` (see tableaux.hpp) against a tableau, its own unless another one is given:
/// explicit stages, row sums, orders that are reached and not exceeded, continuous output that meets both
/// ends.
template <class Method>
constexpr BrokenClaim broken_claim(const decltype(Method::tableau)& tableau = Method::tableau) {
  auto has_order = [&](const auto& t, bool embedded, int order) {
    return order_of(t, embedded, order + 1) == order;
  };
  if (!is_explicit(tableau)) return BrokenClaim::explicit_stages;
  if (!rows_are_consistent(tableau)) return BrokenClaim::row_sums;
  if (!has_order(tableau, false, Method::order)) return BrokenClaim::order;
  if (has_error_estimate(tableau) != (Method::embedded_order > 0)) return BrokenClaim::embedded_order;
  if (Method::embedded_order > 0 && !has_order(tableau, true, Method::embedded_order))
    return BrokenClaim::embedded_order;
  if constexpr (requires { Method::b_err_low; }) {
    auto low = tableau;
    low.b_err = Method::b_err_low;
    if (!has_order(low, true, Method::embedded_order_low)) return BrokenClaim::embedded_order_low;
    // |e|^2 / |e_low| with e = O(h^(p + 1)) and e_low = O(h^(p_low + 1)).
    if (Method::error_order != 2 * (Method::embedded_order + 1) - (Method::embedded_order_low + 1))
      return BrokenClaim::error_order;
  } else if (Method::error_order != (Method::embedded_order > 0 ? Method::embedded_order + 1 : 0)) {
    return BrokenClaim::error_order;
  }
  if constexpr (requires { Method::interpolant; }) {
    if (!meets_both_ends(tableau, Method::interpolant)) return BrokenClaim::interpolant;
    const auto all = extended(tableau, Method::interpolant);
    if (!is_explicit(all) || !rows_are_consistent(all)) return BrokenClaim::interpolant;
    if (order_of_interpolant(tableau, Method::interpolant, Method::interpolant_order + 1) !=
        Method::interpolant_order)
      return BrokenClaim::interpolant;
  }
  return BrokenClaim::none;
}

template <class Method>
concept ProvesItsClaims = broken_claim<Method>()
== BrokenClaim::none;

}  // namespace hmax
