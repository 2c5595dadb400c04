/// What pictures of a plane show of its field.
#pragma once

#include <string>
#include <vector>

#include "analysis/dynamics/phase_plane.hpp"
#include "plots/curves.hpp"

namespace hmax {

std::vector<RestPoint> rest_points_of(const std::vector<Equilibrium>& equilibria);
/// Field, nullclines, equilibria.
/// @param names  of the states, with their units
PhasePlane plane_of(const PlanarField& field, const Window& window, const std::vector<std::string>& names,
                    const std::vector<Equilibrium>& equilibria);

}  // namespace hmax
