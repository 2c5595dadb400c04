/// The explicit Runge-Kutta methods of the catalogue, and those of users' files.
#include <algorithm>
#include <tuple>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/bind_explicit_rk.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/families.hpp"
#include "core/input_error.hpp"

namespace hmax {

namespace {

/// @param which  an index into tableaux::All, or a RuntimeTableau
template <class Which>
Runner bind_to(const Which& which, const Problem& problem) {
  Runner runner = std::visit([&](const auto& system) { return bind_explicit_rk(which, system, problem.y0); },
                             problem.system);
  runner.end_state_extended = extend_explicit_rk(which, problem);
  return runner;
}

/// Whether the weights of the error estimate cancel at every node: then it is 0 where f depends on time
/// alone.
template <std::size_t S>
constexpr bool misses_quadrature(const ButcherTableau<S>& tableau) {
  for (std::size_t i = 0; i < S; ++i) {
    long double at_node = 0;
    for (std::size_t j = 0; j < S; ++j)
      if (tableau.c[j] == tableau.c[i]) at_node += tableau.b_err[j];
    if (at_node != 0) return false;
  }
  return has_error_estimate(tableau);
}

/// The line of one explicit Runge-Kutta method: everything else is in its struct.
template <class T>
Method explicit_rk(std::size_t index) {
  Method method = described<T>();
  method.first_same_as_last = is_fsal(T::tableau);
  if (misses_quadrature(T::tableau))
    method.note = "its error estimate is zero where f depends on time alone, f(0) + f(h) - f(0) - f(h)";
  method.bind = [index](const Problem& problem) { return bind_to(index, problem); };
  method.amplification =
      shared(runge_kutta_amplification(detail::flattened(T::tableau.a), T::tableau.b, T::order));
  return method;
}

}  // namespace

void add_explicit_rk(std::vector<Method>& all) {
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    std::size_t index = 0;
    (all.push_back(explicit_rk<T>(index++)), ...);
  }(std::type_identity<tableaux::All>{});
}

Method make_method(const RuntimeTableau& tableau) {
  for (const Method& method : methods())
    if (method.id == tableau.name || std::ranges::find(method.aliases, tableau.name) != method.aliases.end())
      throw input_error("the tableau is called '{}' like a method of hmax; give it a `name` of its own",
                        tableau.name);
  Method method{.id = tableau.name,
                .family = "explicit_runge_kutta",
                .order = tableau.computed_order,
                .error_order = error_order_of(tableau),
                .stages = static_cast<int>(tableau.stages()),
                .source = "the user's tableau"};
  method.bind = [tableau](const Problem& problem) { return bind_to(tableau, problem); };
  method.amplification = shared(runge_kutta_amplification(tableau.a, tableau.b, tableau.computed_order));
  return method;
}

}  // namespace hmax
