/// The proof of every claim of the explicit Runge-Kutta methods; compiled once, here, to keep the data quick
/// to include.
#include <tuple>
#include <type_traits>

#include "integrators/explicit/tableau_claims.hpp"
#include "integrators/explicit/tableaux.hpp"

namespace hmax::tableaux {

template <ProvesItsClaims T>
constexpr bool proved = true;

// A claim that does not hold fails here, with the name of the method.
static_assert([]<class... T>(std::type_identity<std::tuple<T...>>) {
  return (proved<T> && ...);
}(std::type_identity<All>{}));

// Those methods save one evaluation a step.
static_assert(is_fsal(BogackiShampine32::tableau) && is_fsal(DormandPrince54::tableau) &&
              is_fsal(Tsitouras54::tableau) && is_fsal(Dop853::tableau));

}  // namespace hmax::tableaux
