/// The proof of every claim of the additive pairs; compiled once, here, to keep the data quick to include.
#include <tuple>
#include <type_traits>

#include "integrators/implicit/imex_tableaux.hpp"

namespace hmax::tableaux {

template <class T>
requires(keeps_its_claims<T>()) constexpr bool proved = true;

// A claim that does not hold fails here, with the name of the method.
static_assert([]<class... T>(std::type_identity<std::tuple<T...>>) {
  return (proved<T> && ...);
}(std::type_identity<AllImex>{}));

}  // namespace hmax::tableaux
