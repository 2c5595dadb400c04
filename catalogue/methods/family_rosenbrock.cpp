/// The Rosenbrock and W-methods of the catalogue.
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
  Method method = described_implicit<T>();
  method.linearly_implicit = true;
  method.amplification = shared(rosenbrock_amplification(T::tableau, T::order));
  method.bind = bound(T::error_order, []<class Sys>(std::type_identity<Sys>) {
    return Rosenbrock<T, typename Sys::State, equations_type<Sys>>{};
  });
  return method;
}

}  // namespace

void add_rosenbrock(std::vector<Method>& all) {
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    (all.push_back(rosenbrock<T>()), ...);
  }(std::type_identity<tableaux::AllRosenbrock>{});
}

}  // namespace hmax
