/// The Rosenbrock and W-methods of the catalogue.
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/families.hpp"
#include "integrators/implicit/rosenbrock.hpp"
#include "integrators/implicit/rosenbrock_tableaux.hpp"

namespace hmax {

namespace {

/// The line of one method: everything else is in its struct.
template <class T>
Method rosenbrock() {
  Method method{.id = std::string(T::id),
                .order = T::order,
                .error_order = T::error_order,
                .stages = static_cast<int>(T::tableau.stages),
                .is_explicit = false,
                .needs_jacobian = true,
                .a_stable = T::a_stable,
                .l_stable = T::l_stable,
                .source = std::string(T::source),
                .linearly_implicit = true};
  method.amplification = shared(rosenbrock_amplification(T::tableau, T::order));
  for (const std::string_view alias : T::aliases) method.aliases.emplace_back(alias);
  method.bind = [](const Problem& problem) {
    return bind_problem(problem, T::error_order, []<class Sys>(std::type_identity<Sys>) {
      return Rosenbrock<T, typename Sys::State, equations_type<Sys>>{};
    });
  };
  return method;
}

}  // namespace

void add_rosenbrock(std::vector<Method>& all) {
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    (all.push_back(rosenbrock<T>()), ...);
  }(std::type_identity<tableaux::AllRosenbrock>{});
}

}  // namespace hmax
