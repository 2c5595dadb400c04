#include "cli/phase/plane.hpp"

namespace hmax {

std::vector<RestPoint> rest_points_of(const std::vector<Equilibrium>& equilibria) {
  std::vector<RestPoint> points;
  for (const Equilibrium& e : equilibria)
    points.push_back({e.state(0), e.state(1), std::string(name_of(e.type)), e.eigenvalues});
  return points;
}

PhasePlane plane_of(const PlanarField& field, const Window& window, const std::vector<std::string>& names,
                    const std::vector<Equilibrium>& equilibria) {
  PhasePlane plane{.x = names[0],
                   .v = names[1],
                   .x_range = Range{window.lower(0), window.upper(0)},
                   .v_range = Range{window.lower(1), window.upper(1)},
                   .direction_field = direction_field(field, window, names),
                   .rest_points = rest_points_of(equilibria)};
  for (const int component : {0, 1})
    plane.nullclines[static_cast<std::size_t>(component)] = plane_curves(nullcline(field, component, window));
  return plane;
}

}  // namespace hmax
