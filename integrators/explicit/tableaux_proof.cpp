/// The proof of every claim of the explicit Runge-Kutta methods; compiled once, here, to keep the data quick
/// to include.
#include "integrators/explicit/tableau_claims.hpp"
#include "integrators/explicit/tableaux.hpp"

namespace hmax::tableaux {

static_assert(ProvesItsClaims<ExplicitEuler>);
static_assert(ProvesItsClaims<Rk2Midpoint>);
static_assert(ProvesItsClaims<Rk2Heun>);
static_assert(ProvesItsClaims<Rk2Ralston>);
static_assert(ProvesItsClaims<Rk3Kutta>);
static_assert(ProvesItsClaims<Ssprk33>);
static_assert(ProvesItsClaims<Rk4>);
static_assert(ProvesItsClaims<Rk4ThreeEighths>);
static_assert(ProvesItsClaims<BogackiShampine32> && is_fsal(BogackiShampine32::tableau));
static_assert(ProvesItsClaims<DormandPrince54> && is_fsal(DormandPrince54::tableau));
static_assert(ProvesItsClaims<Tsitouras54> && is_fsal(Tsitouras54::tableau));
static_assert(ProvesItsClaims<Fehlberg78>);
static_assert(ProvesItsClaims<Dop853> && is_fsal(Dop853::tableau));

}  // namespace hmax::tableaux
