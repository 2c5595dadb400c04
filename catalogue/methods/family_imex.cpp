/// The implicit-explicit methods of the catalogue.
#include <tuple>
#include <type_traits>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/families.hpp"
#include "integrators/implicit/imex.hpp"

namespace hmax {

namespace {

template <class T>
Method imex() {
  Method method = described_implicit<T>();
  method.a_stable = method.l_stable = true;  // in what is declared stiff
  method.needs_split = true;
  method.bind = bound(T::error_order, []<class Sys>(std::type_identity<Sys>) {
    return ImexRk<T, typename Sys::State, stiff_equations_type<Sys>>{};
  });
  method.amplification = shared(additive_amplification(T::tableau, T::order));
  return method;
}

}  // namespace

void add_imex(std::vector<Method>& all) {
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    (all.push_back(imex<T>()), ...);
  }(std::type_identity<tableaux::AllImex>{});
}

}  // namespace hmax
