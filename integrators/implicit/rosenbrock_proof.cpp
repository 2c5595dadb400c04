/// The proof of every claim of the Rosenbrock methods; compiled once, here, to keep the data quick to
/// include.
#include "integrators/implicit/rosenbrock_tableaux.hpp"

namespace hmax::tableaux {

static_assert(broken_rosenbrock_claim<LinearlyImplicitEuler>() == BrokenRosenbrockClaim::none);
static_assert(broken_rosenbrock_claim<Rosenbrock23>() == BrokenRosenbrockClaim::none &&
              is_fsal(Rosenbrock23::tableau));
static_assert(broken_rosenbrock_claim<Rodas4>() == BrokenRosenbrockClaim::none);
static_assert(broken_rosenbrock_claim<Rodas5P>() == BrokenRosenbrockClaim::none);

}  // namespace hmax::tableaux
