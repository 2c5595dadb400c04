/// Bodies on meshes in equilibrium: the forces to be solved for, and what to say of a body that finds none.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "analysis/statics/static_solution.hpp"
#include "catalogue/methods/method.hpp"

namespace hmax {

/// The instant whose forces a static equilibrium balances [s]: when every ramp has ended, or 0 where a load
/// never settles.
double equilibrium_time(const TissueBody& body);
/// The same of any problem: 0 of those that are no body.
double equilibrium_time(const Problem& problem);

/// The equilibrium of forces of a body under a multiple of its load as it is at equilibrium_time().
StaticModel static_model(const Problem& problem, double load_scale);

/// The equilibrium under a multiple of the whole load. The load acts at once or, where that leads to elements
/// turned inside out, in ten steps; the history then holds both. A load that moves, as a tool does, is
/// followed along its ramp in 20 steps or as many as `settings` says. Where there is no stable equilibrium
/// the solution may be an unstable one.
/// @param load_scale  1 for a load that moves
StaticSolution found_equilibrium(const Problem& problem, double load_scale, const StaticSettings& settings,
                                 const Clock& clock);

/// Where a search has ended at elements about to invert, and the model restores such elements: the
/// equilibrium beyond. Where some are inverted in it, it does not count as converged, since no tissue comes
/// there, but tells what a simulator shows. `solution` itself where there is none.
/// @param solution  of found_equilibrium() with these arguments
StaticSolution beyond_inversion(const Problem& problem, double load_scale, const StaticSettings& settings,
                                const Clock& clock, StaticSolution solution);

/// "converged", "not_converged", "buckles" where the only equilibrium found is not stable, "collapsed" where
/// the search ended at elements about to turn inside out, or "inverted" where some are.
std::string_view outcome_of(const Problem& problem, const StaticSolution& solution);

/// Why a solution is none, and the element that gives way if one does.
std::string cause_of(const Problem& problem, const StaticSolution& solution);

/// The same with what helps, in words of `hmax static`.
/// @param names_model  that resists being crushed; false: somebody has tried it
std::string status_of(const Problem& problem, const StaticSolution& solution, bool names_model = true);

/// A tetrahedron by its number, an averaged pressure by that of its point; springs and skin triangles in
/// hmax's order, from 1, since files do not number them.
struct NamedElement {
  /// "tetrahedron", "nodal pressure", "spring", "skin triangle" or "support spring"
  std::string_view kind;
  std::int64_t number;
  std::vector<std::int64_t> points;  ///< by point_number()
};
/// "tetrahedron 17", "the pressure at node 4", "the spring of points 4, 9".
std::string in_words(const NamedElement& element);
/// @param element  in the order of elements_of(body) (limits/modes/fastest_mode.hpp)
NamedElement named_element(const Problem& problem, Eigen::Index element);

}  // namespace hmax
