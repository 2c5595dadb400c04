/// The proof of every claim of the diagonally implicit methods; compiled once, here.
#include "integrators/dirk_tableaux.hpp"
#include "integrators/tableau_claims.hpp"

namespace hmax::tableaux {

static_assert(ProvesItsClaims<ImplicitEuler>);
static_assert(ProvesItsClaims<Trapezoidal>);
static_assert(ProvesItsClaims<ImplicitMidpoint>);
static_assert(ProvesItsClaims<TrBdf2>);
static_assert(ProvesItsClaims<Sdirk4>);

}  // namespace hmax::tableaux
