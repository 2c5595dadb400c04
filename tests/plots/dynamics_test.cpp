#include "plots/dynamics.hpp"

#include <set>

#include <gtest/gtest.h>

namespace hmax {
namespace {

TEST(MapPanel, NoOrbitHasTheColourOfWhatTheMethodMakes) {
  PlaneMap map{.fixed_points = {{1, 0, "saddle", true}},
               .period_two = {{.first = {0, 1}, .second = {0, -1}, .type = "saddle"}}};
  for (int k = 0; k < 7; ++k) map.iterates.push_back({{0, 0}, {1.0, 0.1 * k}});
  const Panel panel = map_panel(map);
  std::set<int> orbits, made;
  for (const Curve& curve : panel.curves)
    (curve.x[0] == 0 && curve.y[0] == 0 ? orbits : made).insert(curve.style.colour);
  for (const Mark& mark : panel.marks) (mark.style.marker == 9 ? orbits : made).insert(mark.style.colour);
  EXPECT_EQ(made.size(), 1U);
  EXPECT_FALSE(orbits.contains(*made.begin()));
}

}  // namespace
}  // namespace hmax
