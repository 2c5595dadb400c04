/// Which support a body needs under its weight: why it has no static equilibrium, and the end that holds it
/// best.
#pragma once

#include <optional>
#include <string>

#include "analysis/statics/static_solution.hpp"
#include "catalogue/methods/method.hpp"

namespace hmax {

/// The largest displacement under the load by linear elasticity at rest, |K0^-1 f0| [m]. Nothing where the
/// supports leave a part free to move or turn, and above 20,000 degrees of freedom.
std::optional<double> linear_sag(const TissueBody& body);

/// An end of a body, and how far the body sags where its points are fixed.
struct EndSag {
  int axis;    ///< as `--set axis=` has it: 1 the low end along x, -1 the high one
  double sag;  ///< by linear elasticity [m]
};
/// "low z", "high x".
std::string name_of_end(int axis);

/// The end with which a body sags least, beside the one that is fixed by default.
struct SuggestedSupport {
  int axis;
  double sag;
  int axis_now;
  double sag_now;
};

/// The least linear sag of the six ends with the share `support`, where it is below half of that with the end
/// in use. Nothing where the user chose the support, of loads beside gravity, and above 20,000 degrees of
/// freedom.
/// @cost  K of the body without supports, and six solutions; about a second at most
std::optional<SuggestedSupport> suggested_support(const Problem& problem);
std::string in_words(const SuggestedSupport& suggested);

/// What helps a body without a static equilibrium, as far as it was tested. Under gravity alone the linear
/// sag with the six ends `--set axis=` as supports is compared with that of the present support, and the
/// search is repeated with the best end: its equilibrium shows that the support is the cause. Otherwise a
/// smaller load or a stiffer material; empty where a part is free to move or turn, which is the cause.
/// @cost  up to seven solutions with K0, and one search for an equilibrium
std::string remedy_without_equilibrium(const Problem& problem);

/// status_of() a search under the whole load; where the support is the cause that it has no equilibrium, that
/// in place of a smaller load; where elements are crushed or inverted, what the same search finds with a
/// model that resists it.
/// @cost  as remedy_without_equilibrium() where the search has found nothing, and a search
std::string status_without_equilibrium(const Problem& problem, const StaticSolution& solution);

}  // namespace hmax
