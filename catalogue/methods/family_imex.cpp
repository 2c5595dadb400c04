/// The implicit-explicit methods of the catalogue.
#include <string>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/families.hpp"
#include "integrators/implicit/imex.hpp"

namespace hmax {

namespace {

template <class T>
Method imex() {
  return {.id = std::string(T::id),
          .order = T::order,
          .error_order = T::error_order,
          .stages = static_cast<int>(T::tableau.stages),
          .is_explicit = false,
          .needs_jacobian = true,
          .a_stable = true,  // in what is declared stiff
          .l_stable = true,
          .source = std::string(T::source),
          .needs_split = true,
          .bind =
              [](const Problem& problem) {
                return bind_problem(problem, T::error_order, []<class Sys>(std::type_identity<Sys>) {
                  return ImexRk<T, typename Sys::State, stiff_equations_type<Sys>>{};
                });
              },
          .amplification = shared(additive_amplification(T::tableau, T::order))};
}

}  // namespace

void add_imex(std::vector<Method>& all) {
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    (all.push_back(imex<T>()), ...);
  }(std::type_identity<tableaux::AllImex>{});
}

}  // namespace hmax
