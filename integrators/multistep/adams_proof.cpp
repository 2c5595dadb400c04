/// The proof that the Adams formulas of k values have order k, and no more; compiled once, here.
#include <utility>

#include "integrators/multistep/adams_coefficients.hpp"

namespace hmax::adams {

namespace {
/// The explicit formula of k values f_n, ..., f_n-k+1 and the implicit one of f_n+1, ..., f_n-k+2 have
/// order k, not k + 1.
template <std::size_t K>
constexpr bool has_order_k() {
  std::array<long double, K> bashforth{}, moulton{};
  weights_of_values<long double>(gamma<K>(), bashforth);
  weights_of_values<long double>(gamma_star<K>(), moulton);
  return order_of(bashforth, 0, K + 1) == K && order_of(moulton, 1, K + 1) == K;
}
}  // namespace

/// K = 1, ..., 6, the orders that Adams takes.
static_assert([]<std::size_t... I>(std::index_sequence<I...>) {
  return (has_order_k<I + 1>() && ...);
}(std::make_index_sequence<6>{}));

}  // namespace hmax::adams
