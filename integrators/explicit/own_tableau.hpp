/// What the compiler asks of an explicit method of one's own before it steps with it.
#pragma once

#include <tuple>
#include <type_traits>

#include "integrators/explicit/tableau.hpp"
#include "integrators/explicit/tableaux.hpp"

namespace hmax {

namespace detail {

/// Coefficients of one's own may be decimals of 16 digits.
inline constexpr long double own_tolerance = 1e-12L;

/// The methods of the house are proved once, in tableaux_proof.cpp.
template <class Method>
inline constexpr bool is_proved = []<class... Known>(std::type_identity<std::tuple<Known...>>) {
  return (std::is_same_v<Method, Known> || ...);
}(std::type_identity<tableaux::All>{});

/// Whether weights sum to one and rows to their nodes: without that a method does not converge.
template <class Method>
constexpr bool is_consistent() {
  const auto& tableau = Method::tableau;
  long double sum = 0;
  for (const long double weight : tableau.b) sum += weight;
  return magnitude(sum - 1) <= own_tolerance &&
         largest_row_defect(flattened(tableau.a), tableau.c).defect <= own_tolerance;
}

/// Whether the method reaches the `order` it names, of which `error_order` is at most one more; orders up to
/// 8 are checked.
template <class Method>
constexpr bool reaches_its_order() {
  constexpr int checked = Method::order < 8 ? Method::order : 8;
  return Method::order >= 1 &&
         order_of(flattened(Method::tableau.a), Method::tableau.b, checked, own_tolerance) == checked;
}

/// Whether the error estimate is of the order that the method names: 0 without one, else one above the lower
/// order of both solutions. Methods with two error rows have another.
template <class Method>
constexpr bool reaches_its_error_order() {
  if constexpr (requires { Method::b_err_low; }) {
    return true;
  } else if constexpr (!has_error_estimate(Method::tableau)) {
    return Method::error_order == 0;
  } else {
    auto b_hat = Method::tableau.b;
    for (std::size_t i = 0; i < b_hat.size(); ++i) b_hat[i] -= Method::tableau.b_err[i];
    const int embedded = order_of(flattened(Method::tableau.a), b_hat, 8, own_tolerance);
    return Method::error_order == (Method::order < embedded ? Method::order : embedded) + 1;
  }
}

}  // namespace detail

/// Refuses to compile a method of one's own whose coefficients are not explicit and consistent, or do not
/// reach the orders that it names.
/// @tparam Method  a struct with `order`, `error_order` and `tableau`
template <class Method>
struct CheckedTableau {
  static constexpr bool known = detail::is_proved<Method>;
  static_assert(known || is_explicit(Method::tableau),
                "the tableau is not explicit: a_ij != 0 for some j >= i");
  static_assert(known || detail::is_consistent<Method>(),
                "the tableau is not consistent: b must sum to 1, and each row of a to its c");
  static_assert(known || detail::reaches_its_order<Method>(), "the tableau does not have the order it names");
  static_assert(known || detail::reaches_its_error_order<Method>(),
                "error_order must be 1 + the lower order of b and b - b_err, or 0 without b_err");
  static constexpr bool value = true;
};

}  // namespace hmax
