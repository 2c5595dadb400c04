/// Methods with a mistake in their coefficients, for tests of what notices it.
#pragma once

#include <variant>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/bind_explicit_rk.hpp"
#include "catalogue/methods/method.hpp"

namespace hmax {

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
