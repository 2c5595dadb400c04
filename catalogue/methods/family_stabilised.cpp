/// The stabilised explicit methods of the catalogue.
#include <string>

#include "analysis/amplification/stabilised_amplification.hpp"
#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/families.hpp"
#include "integrators/explicit/stabilized_rk.hpp"

namespace hmax {

namespace {

template <class Polynomials>
Method stabilised_method() {
  return {.id = std::string(Polynomials::id),
          .order = 2,
          .error_order = 3,
          .stages = 0,  // chosen at run time
          .source = std::string(Polynomials::source),
          .stages_by_radius = true,
          .bind = bound(3,
                        []<class Sys>(std::type_identity<Sys>) {
                          return StabilizedRk<Polynomials, typename Sys::State>{};
                        }),
          .amplification = shared(stabilised_amplification<Polynomials>())};
}

}  // namespace

void add_stabilised(std::vector<Method>& all) {
  all.push_back(stabilised_method<Rkc2>());
  all.push_back(stabilised_method<Rkl2>());
}

}  // namespace hmax
