/// Radau IIA in the catalogue.
#include <type_traits>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/families.hpp"
#include "integrators/implicit/radau.hpp"

namespace hmax {

void add_radau(std::vector<Method>& all) {
  all.push_back({.id = "radau_iia_5",
                 .order = 5,
                 .error_order = 4,
                 .stages = 3,
                 .is_explicit = false,
                 .needs_jacobian = true,
                 .a_stable = true,
                 .l_stable = true,
                 .source = "hairer1996solving",
                 .bind = bound(4,
                               []<class Sys>(std::type_identity<Sys>) {
                                 return RadauIIA5<typename Sys::State, equations_type<Sys>>{};
                               }),
                 .amplification = shared(full_runge_kutta_amplification(detail::flattened(radau::tableau.a),
                                                                        radau::tableau.b, 5))});
}

}  // namespace hmax
