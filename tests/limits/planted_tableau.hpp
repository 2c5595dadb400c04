/// Methods with a mistake in their coefficients, for tests of what notices it.
#pragma once

#include <variant>
#include <vector>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/bind_explicit_rk.hpp"
#include "catalogue/methods/method.hpp"

namespace hmax {

/// The coefficients of a method that the compiler knows, for a mistake to be planted in.
template <class Known>
RuntimeTableau at_run_time() {
  const auto& t = Known::tableau;
  RuntimeTableau tableau{.name = "planted",
                         .a = {},
                         .b = {t.b.begin(), t.b.end()},
                         .b_err = std::vector<long double>(t.b.size()),
                         .c = {t.c.begin(), t.c.end()},
                         .computed_order = Known::order};
  for (const auto& row : t.a) tableau.a.insert(tableau.a.end(), row.begin(), row.end());
  return tableau;
}

/// Whether what stage i computes enters the step: what only an error estimate reads does not.
inline std::vector<bool> stages_used(const RuntimeTableau& t) {
  const std::size_t s = t.stages();
  std::vector<bool> used(s);
  for (std::size_t i = s; i-- > 0;) {
    used[i] = t.b[i] != 0;
    for (std::size_t later = i + 1; later < s; ++later)
      used[i] = used[i] || (used[later] && t.a[later * s + i] != 0);
  }
  return used;
}

/// Coefficients that steppers take as they are: the better match of the check that RuntimeTableau has.
struct PlantedTableau : RuntimeTableau {};
inline void require_kept(const PlantedTableau&) {}

/// What make_method() makes of a tableau, without the check.
inline Method planted_method(const RuntimeTableau& wrong) {
  Method method{.id = wrong.name,
                .family = "explicit_runge_kutta",
                .order = wrong.computed_order,
                .stages = static_cast<int>(wrong.stages()),
                .source = "a test"};
  method.bind = [tableau = PlantedTableau{wrong}](const Problem& problem) {
    return std::visit(
        [&](const auto& system) { return detail::bind_coefficients(tableau, 0, system, problem.y0); },
        problem.system);
  };
  method.amplification = shared(runge_kutta_amplification(wrong.a, wrong.b, wrong.computed_order));
  return method;
}

}  // namespace hmax
