/// Adaptive steps in one word: the order of the error estimate is that of the method.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "integrators/control.hpp"
#include "integrators/explicit/user_tableau.hpp"

namespace hmax {

/// Steps steered by the error estimate of a method: adaptive<tableaux::DormandPrince54>({1e-8, 1e-8}), or
/// adaptive<Method>(default_tolerances(y0)).
/// @tparam Method      a struct with error_order, as those of the tableaux; 0 does not compile
/// @tparam Controller  IntegralController, PiController, DeadbandController or MatlabController
template <class Method, template <class> class Controller = PiController, class Real = double>
Adaptive<Real, Controller> adaptive(Tolerances<Real> tolerances = {}) {
  static_assert(Method::error_order > 0, "the method has no error estimate: run it with FixedStep");
  return {tolerances, Method::error_order};
}

/// The same with an absolute tolerance for each component: adaptive<Method>({1e-6, Eigen::Vector2d(1e-9,
/// 1e-6)}).
template <class Method, template <class> class Controller = PiController, class Real = double>
Adaptive<Real, Controller, ComponentRmsNorm> adaptive(ComponentTolerances<Real> tolerances) {
  static_assert(Method::error_order > 0, "the method has no error estimate: run it with FixedStep");
  return {std::move(tolerances), Method::error_order};
}

/// The same of a tableau that is known only at run time.
/// @throws std::invalid_argument  where it has no error estimate
template <template <class> class Controller = PiController, class Real = double>
Adaptive<Real, Controller> adaptive(const RuntimeTableau& tableau, Tolerances<Real> tolerances) {
  if (!tableau.has_error())
    throw std::invalid_argument("the tableau '" + tableau.name +
                                "' has no error estimate; give it b_hat, or run it with FixedStep");
  // err = y_new - y_hat = O(h^q) with q one above the lower of both orders.
  return {tolerances, std::min(tableau.computed_order, tableau.embedded_order) + 1};
}

}  // namespace hmax
