/// The proof of every claim of the diagonally implicit methods; compiled once, here.
#include <tuple>
#include <type_traits>

#include "integrators/explicit/tableau_claims.hpp"
#include "integrators/implicit/dirk_tableaux.hpp"

namespace hmax::tableaux {

template <ProvesItsClaims T>
constexpr bool proved = true;

// A claim that does not hold fails here, with the name of the method.
static_assert([]<class... T>(std::type_identity<std::tuple<T...>>) {
  return (proved<T> && ...);
}(std::type_identity<AllDiagonallyImplicit>{}));

}  // namespace hmax::tableaux
