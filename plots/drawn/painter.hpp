/// Surfaces in space as polygons of a page: what is farther away is painted first.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plots/drawn/colour_map.hpp"

namespace hmax {

using SpacePoint = std::array<double, 3>;
using TriangleCorners = std::array<std::int32_t, 3>;

/// Looks at bodies from far away: lines that are parallel stay so, and a length across the view is a length.
class Camera {
 public:
  /// @param towards  from the bodies to the viewer, any length; z is up, for a view from above or below y
  explicit Camera(const SpacePoint& towards);

  /// Across to the right, up, and towards the viewer.
  [[nodiscard]] SpacePoint seen(const SpacePoint& p) const;

 private:
  SpacePoint right_, up_, towards_;
};

/// Where a piece of the space that the camera sees stands on the page.
struct Placement {
  double scale = 1;                   ///< [pixel / m]
  double seen_x = 0, seen_y = 0;      ///< what stands in the middle, as the camera sees it [m]
  double middle_x = 0, middle_y = 0;  ///< of the page [pixel]

  [[nodiscard]] std::array<double, 2> at(const SpacePoint& seen) const {
    return {middle_x + scale * (seen[0] - seen_x), middle_y - scale * (seen[1] - seen_y)};
  }
};

/// A surface of triangles, counter-clockwise as seen from outside, with colours.
struct PaintedSurface {
  const std::vector<SpacePoint>& points;
  const std::vector<TriangleCorners>& triangles;
  const std::vector<double>& shares;  ///< place in the map, 0 to 1, of each point or each triangle; none or
                                      ///< NaN: grey
  const ColourMap& map;
  bool smooth = true;  ///< `shares` is of points
};

/// Collects faces, lines and dots, and writes them in the order of their depths.
class Painter {
 public:
  Painter(const Camera& camera, const Placement& placement) : camera_(camera), placement_(placement) {}

  /// The faces that look this way, lit from the upper left, each cut into pieces of about `size` pixels,
  /// each of one colour; the outline, and the edges between triangles where these are large enough to be
  /// told apart. Corners are rounded by the light where triangles meet at less than 50 degrees.
  void add_surface(const PaintedSurface& surface, double size);
  /// A ball with a shaft, of metal; before the surface that it touches, which is then cut finer there.
  void add_tool(const SpacePoint& centre, double radius, const SpacePoint& shaft);
  /// Dots on those points of a surface that a face looking this way has.
  void add_dots(const std::vector<SpacePoint>& points, const std::vector<TriangleCorners>& triangles,
                const std::vector<std::int32_t>& which);

  /// Elements of SVG for a group of class "body"; each picture needs `painter_style` once.
  [[nodiscard]] std::string svg() const;

 private:
  enum class Kind { face, edge, outline, dot };
  struct Item {
    double depth;
    Kind kind;
    std::array<std::array<float, 2>, 3> at;
    std::array<char, 8> colour;
  };
  struct Ball {
    SpacePoint seen;
    double radius;
  };
  struct Side {
    std::int32_t a, b;  ///< points, a < b
    bool front;         ///< of a triangle that looks this way
    auto operator<=>(const Side&) const = default;
  };
  [[nodiscard]] bool near_ball(const std::array<SpacePoint, 3>& seen) const;
  void add_face(const std::array<SpacePoint, 3>& seen, const OkLab& colour);
  void add_pieces(const PaintedSurface& surface, std::size_t t, const std::array<SpacePoint, 3>& x,
                  const std::array<SpacePoint, 3>& normals, int n);
  void add_sides(std::vector<Side> sides, const std::vector<SpacePoint>& seen, bool wired, double size);
  void add_line(const SpacePoint& from, const SpacePoint& to, Kind kind, double size);
  void add_round(const std::vector<std::vector<SpacePoint>>& rings, const SpacePoint& centre,
                 const SpacePoint& axis);

  const Camera& camera_;
  Placement placement_;
  std::vector<Item> items_;
  std::vector<Ball> balls_;
};

/// The rules of style that the elements of painters rely on.
extern const char* const painter_style;

/// The area on the page of the faces that look this way [pixel^2], those that others hide counted too.
double painted_area(const std::vector<SpacePoint>& points, const std::vector<TriangleCorners>& triangles,
                    const Camera& camera, double scale);

/// The faces that look this way as one path, of which the rim is the rim of the whole.
std::string shape_path(const std::vector<SpacePoint>& points, const std::vector<TriangleCorners>& triangles,
                       const Camera& camera, const Placement& placement);

}  // namespace hmax
