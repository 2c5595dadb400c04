/// Panels of what motions settle to: maps of the plane, basins, stroboscopic sections, bifurcation diagrams.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "plots/curves.hpp"
#include "plots/figure.hpp"

namespace hmax {

/// A fixed point of a map of the plane.
struct MapPoint {
  double x, v;
  std::string type;  ///< as of equilibria
  bool spurious;     ///< made by the method: the equation does not rest there
};

/// Two points that a map exchanges.
struct MapPair {
  std::array<double, 2> first, second;
  std::string type;
};

/// What a map of the plane does.
struct PlaneMap {
  std::string title = {};
  std::string x = "x [m]", v = "v [m/s]";
  std::optional<Range> x_range = {}, v_range = {};
  std::vector<PlaneCurve> iterates = {};  ///< each from its start
  std::vector<MapPoint> fixed_points = {};
  std::vector<MapPair> period_two = {};
};

/// Iterates as dots, fixed points by type, those that the method made in another colour, exchanged points
/// joined by a line. Filled marks are stable, open ones unstable.
Panel map_panel(const PlaneMap& map);

/// A grid of starts, and where each of them ends.
struct BasinMap {
  int columns = 0, rows = 0;
  Range x = {}, v = {};             ///< of the whole
  std::vector<int> attractor = {};  ///< [row * columns + column], rows upwards; -1: none
};

/// The grid as tinted areas, cells of a row that belong together as one rectangle.
/// @param labels  of the attractors, in the order of their numbers; `none` of the cells without
std::vector<Area> basin_areas(const BasinMap& map, const std::vector<std::string>& labels,
                              const std::string& none);

/// Points without a line, small when they are many.
Curve cloud(const std::string& label, std::vector<double> x, std::vector<double> y, int colour = 0);

}  // namespace hmax
