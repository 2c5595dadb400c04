/// The proof of every claim of the additive pairs; compiled once, here, to keep the data quick to include.
#include "integrators/imex_tableaux.hpp"

namespace hmax::tableaux {

/// Orders that are reached and not exceeded, by both methods of a pair, over all trees of two colours.
template <class Method>
constexpr bool keeps_its_claims() {
  const auto has_order = [](bool embedded, int order) {
    return order_of(Method::tableau, embedded, order + 1) == order;
  };
  const auto& [nonstiff, stiff] = Method::tableau;
  if (!is_imex(Method::tableau) || !has_order(false, Method::order)) return false;
  if (has_error_estimate(nonstiff) != (Method::embedded_order > 0)) return false;
  if (Method::error_order != (Method::embedded_order > 0 ? Method::embedded_order + 1 : 0)) return false;
  return Method::embedded_order == 0 || has_order(true, Method::embedded_order);
}

static_assert(keeps_its_claims<ImexEuler>());
static_assert(keeps_its_claims<ImexArk324>());
static_assert(keeps_its_claims<ImexArk436>());

}  // namespace hmax::tableaux
