/// The diagonally implicit Runge-Kutta methods of the catalogue.
#include <algorithm>
#include <tuple>
#include <type_traits>

#include <fmt/format.h>

#include "analysis/amplification/one_step_amplification.hpp"
#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/families.hpp"
#include "core/numbers.hpp"
#include "integrators/implicit/dirk.hpp"
#include "integrators/implicit/dirk_tableaux.hpp"

namespace hmax {

namespace {

/// The part of a step before its first stage, where f at the start of the step is not used either.
template <class T>
constexpr double unseen_part() {
  if (!has_error_estimate(T::tableau)) return 0;
  return static_cast<double>(*std::min_element(T::tableau.c.begin(), T::tableau.c.end()));
}

/// The line of one diagonally implicit method: everything else is in its struct.
template <class T>
Method diagonally_implicit() {
  // A stage of which only the error estimate is made is no stage of the method.
  int stages = 0;
  for (const long double weight : T::tableau.b) stages += weight != 0;
  Method method = described_implicit<T>();
  method.stages = stages;
  if (unseen_part<T>() > 0)
    method.note = fmt::format("its error estimate does not see a jump in time in the first {} of a step",
                              to_text(unseen_part<T>()));
  method.amplification =
      shared(runge_kutta_amplification(detail::flattened(T::tableau.a), T::tableau.b, T::order));
  method.bind = bound(T::error_order, []<class Sys>(std::type_identity<Sys>) {
    return Dirk<T, typename Sys::State, equations_type<Sys>>{};
  });
  return method;
}

}  // namespace

void add_diagonally_implicit(std::vector<Method>& all) {
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    (all.push_back(diagonally_implicit<T>()), ...);
  }(std::type_identity<tableaux::AllDiagonallyImplicit>{});
}

}  // namespace hmax
