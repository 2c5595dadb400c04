/// The Adams methods of the catalogue.

#include <type_traits>

#include <fmt/format.h>

#include "analysis/amplification/multistep_amplification.hpp"
#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/families.hpp"
#include "integrators/multistep/adams.hpp"
#include "integrators/multistep/adams_pece.hpp"

namespace hmax {

namespace {

Method fixed_step_adams(std::string_view prefix, AdamsMode mode, int k) {
  return {.id = fmt::format("{}_{}", prefix, k),
          .order = k,
          .error_order = 0,
          .stages = mode == AdamsMode::pece ? 2 : 1,
          .source = "hairer1993solving",
          // Where the corrected state is not evaluated, the newest derivative too is one of the step before.
          .steps_back = mode == AdamsMode::pec ? k : k - 1,
          .bind = bound(
              0, [=]<class Sys>(std::type_identity<Sys>) { return Adams<typename Sys::State>(mode, k); }),
          .amplification = shared(adams_amplification(mode, k, k))};
}

/// It has no runs at fixed step, so none in long double either.
Runner bind_adams_pece(const Problem& problem) {
  return bind_engine(problem, []<class Sys>(std::type_identity<Sys>) {
    return detail::StepperEngine<AdamsPece<typename Sys::State>>{};
  });
}

}  // namespace

void add_adams(std::vector<Method>& all) {
  for (const auto& [prefix, mode] : {std::pair{"adams_bashforth", AdamsMode::bashforth},
                                     {"abm_pece", AdamsMode::pece},
                                     {"abm_pec", AdamsMode::pec}})
    for (int k = 1; k <= 6; ++k) all.push_back(fixed_step_adams(prefix, mode, k));
  all.push_back({.id = "adams_pece",
                 .aliases = {"ode113"},
                 .order = 0,
                 .error_order = 2,
                 .stages = 2,
                 .source = "shampine1975computer",
                 .fixed_step = false,
                 .own_control = true,
                 .bind = bind_adams_pece});
}

}  // namespace hmax
