/// The proof of every claim of the additive pairs; compiled once, here, to keep the data quick to include.
#include "integrators/implicit/imex_tableaux.hpp"

namespace hmax::tableaux {

static_assert(keeps_its_claims<ImexEuler>());
static_assert(keeps_its_claims<ImexArk324>());
static_assert(keeps_its_claims<ImexArk436>());

}  // namespace hmax::tableaux
