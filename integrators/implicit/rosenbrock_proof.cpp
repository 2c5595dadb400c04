/// The proof of every claim of the Rosenbrock methods; compiled once, here, to keep the data quick to
/// include.
#include <tuple>
#include <type_traits>

#include "integrators/implicit/rosenbrock_tableaux.hpp"

namespace hmax::tableaux {

template <class T>
requires(broken_rosenbrock_claim<T>() == BrokenRosenbrockClaim::none) constexpr bool proved = true;

// A claim that does not hold fails here, with the name of the method.
static_assert([]<class... T>(std::type_identity<std::tuple<T...>>) {
  return (proved<T> && ...);
}(std::type_identity<AllRosenbrock>{}));

static_assert(is_fsal(Rosenbrock23::tableau));

}  // namespace hmax::tableaux
