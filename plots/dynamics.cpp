#include "plots/dynamics.hpp"

#include <algorithm>
#include <cstddef>

namespace hmax {

Panel map_panel(const PlaneMap& map) {
  constexpr int made_by_method = 5;  // orbits have the colours before it
  Panel panel{.title = map.title, .x = {map.x, false, map.x_range}, .y = {map.v, false, map.v_range}};
  for (std::size_t k = 0; k < map.iterates.size(); ++k) {
    const int colour = static_cast<int>(k) % made_by_method;
    Curve steps{.label = "step by step",
                .style = {.colour = colour, .dash = 0, .marker = 7, .width = 0.6, .size = 0.55}};
    for (const auto& [x, v] : map.iterates[k]) {
      steps.x.push_back(x);
      steps.y.push_back(v);
    }
    if (k > 0) steps.label.clear();
    if (!steps.x.empty())
      panel.marks.push_back({steps.x[0], steps.y[0], {.colour = colour, .marker = 9}, k == 0 ? "start" : ""});
    panel.curves.push_back(std::move(steps));
  }
  for (const MapPair& pair : map.period_two) {
    const std::string label = "to and fro, " + type_in_words(pair.type);
    panel.curves.push_back({.label = "",
                            .x = {pair.first[0], pair.second[0]},
                            .y = {pair.first[1], pair.second[1]},
                            .style = {.colour = made_by_method, .dash = 1, .marker = 0, .width = 1.4}});
    for (const auto& [x, v] : {pair.first, pair.second})
      panel.marks.push_back({x, v, {.colour = made_by_method, .marker = marker_of(pair.type)}, label});
  }
  for (const MapPoint& point : map.fixed_points)
    panel.marks.push_back(
        {point.x,
         point.v,
         {.colour = point.spurious ? made_by_method : 6, .marker = marker_of(point.type)},
         point.spurious ? "made by the method, " + type_in_words(point.type) : type_in_words(point.type)});
  return panel;
}

std::vector<Area> basin_areas(const BasinMap& map, const std::vector<std::string>& labels,
                              const std::string& none) {
  constexpr int grey = 7;
  std::vector<Area> areas;
  for (std::size_t k = 0; k < labels.size(); ++k)
    areas.push_back({.label = labels[k], .colour = static_cast<int>(k % grey)});
  areas.push_back({.label = none, .colour = grey});
  const double w = (map.x.high - map.x.low) / map.columns, h = (map.v.high - map.v.low) / map.rows;
  for (int row = 0; row < map.rows; ++row) {
    const int* const at = map.attractor.data() + std::ptrdiff_t{row} * map.columns;
    for (int column = 0; column < map.columns;) {
      int end = column + 1;
      while (end < map.columns && at[end] == at[column]) ++end;
      Area& area = at[column] < 0 ? areas.back() : areas[static_cast<std::size_t>(at[column])];
      area.x.push_back(map.x.low + w * (column + end) / 2);
      area.y.push_back(map.v.low + h * (row + 0.5));
      area.w.push_back(w * (end - column));
      // A little higher than the row, or the seams would show.
      area.h.push_back(1.04 * h);
      column = end;
    }
  }
  std::erase_if(areas, [](const Area& area) { return area.x.empty(); });
  return areas;
}

Curve cloud(const std::string& label, std::vector<double> x, std::vector<double> y, int colour) {
  const double size = x.size() > 1000 ? 0.25 : x.size() > 100 ? 0.5 : 1.2;
  return {.label = label,
          .x = std::move(x),
          .y = std::move(y),
          .style = {.colour = colour, .marker = 7, .size = size},
          .line = false};
}

}  // namespace hmax
