/// Pictures of bodies in space, with a value in colour, as SVG: no display and no other program is needed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "plots/drawn/painter.hpp"
#include "plots/figure.hpp"

namespace hmax {

/// The tip of a tool, a ball on a shaft.
struct BodyTool {
  SpacePoint centre;          ///< [m]
  double radius;              ///< [m]
  SpacePoint shaft{0, 0, 1};  ///< where the shaft leads to, any length
};

/// A force, as an arrow that ends at a point, or leaves it.
struct BodyArrow {
  SpacePoint point;      ///< [m]
  SpacePoint direction;  ///< any length
  bool leaves = false;
};

/// One body, or one state of it.
struct BodyView {
  std::string title = {};
  std::vector<std::string> notes = {};          ///< small lines under the title
  std::vector<SpacePoint> points = {};          ///< [m]
  std::vector<TriangleCorners> triangles = {};  ///< of the surface, counter-clockwise as seen from outside
  std::vector<double> values = {};              ///< of each point, or of each triangle; none: plain grey
  std::vector<SpacePoint> rest = {};    ///< of the points; the shape at rest is shown behind, or empty
  std::vector<std::int32_t> held = {};  ///< points marked with a dot
  std::string held_as = "fixed";        ///< what the dots mean, for the legend
  std::vector<BodyTool> tools = {};
  std::vector<BodyArrow> arrows = {};
};

/// What the colours mean.
struct BodyColours {
  std::string quantity = {};        ///< with its unit, "displacement [mm]"
  std::optional<Range> range = {};  ///< of all views alike; from the values that are seen when absent
  bool low_is_bad = false;          ///< the strong colours stand for small values
};

/// Bodies side by side, on one scale of lengths and one of colours.
struct BodyPicture {
  std::string title = {};
  std::string caption = {};  ///< what the numbers depend on; broken into lines
  BodyColours colours = {};
  SpacePoint towards{0.45, -1, 0.5};  ///< from the bodies to the viewer; z is up
  int columns = 1;
  std::vector<BodyView> views = {};
  bool coarse = false;  ///< a tenth of the triangles at most
};

/// The text of the SVG, 900 pixels wide. Surfaces of many triangles are drawn with fewer, which the caption
/// then says. The same picture gives the same bytes.
/// @throws InputError  when there is no view, or the values fit neither points nor triangles
std::string bodies_svg(const BodyPicture& picture);

}  // namespace hmax
