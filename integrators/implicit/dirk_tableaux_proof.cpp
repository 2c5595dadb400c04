/// The proof of every claim of the diagonally implicit methods; compiled once, here.
#include "integrators/explicit/tableau_claims.hpp"
#include "integrators/implicit/dirk_tableaux.hpp"

namespace hmax::tableaux {

static_assert(ProvesItsClaims<ImplicitEuler>);
static_assert(ProvesItsClaims<Trapezoidal>);
static_assert(ProvesItsClaims<ImplicitMidpoint>);
static_assert(ProvesItsClaims<TrBdf2>);
static_assert(ProvesItsClaims<Sdirk4>);

}  // namespace hmax::tableaux
