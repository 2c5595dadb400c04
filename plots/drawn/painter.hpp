/// Surfaces in space as triangles of a page: what is farther away is painted first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hmax {

using SpacePoint = std::array<double, 3>;
using TriangleCorners = std::array<std::int32_t, 3>;

/// Looks at bodies from far away: lines that are parallel stay so, and a length across the view is a length.
class Camera {
 public:
  /// @param towards  from the bodies to the viewer, any length; z is up, for a view from above or below y
  explicit Camera(const SpacePoint& towards);

  /// Across to the right, down the page, and towards the viewer [pixel].
  [[nodiscard]] SpacePoint seen(const SpacePoint& p) const;

  double scale = 1;     ///< [pixel / m]
  double x = 0, y = 0;  ///< where the origin stands on the page [pixel]

 private:
  SpacePoint right_, up_, towards_;
};

/// A surface of triangles, counter-clockwise as seen from outside.
struct Surface {
  std::vector<SpacePoint> points = {};
  std::vector<TriangleCorners> triangles = {};
  std::vector<double> shares = {};  ///< places in the colours, 0 to 1; none or NaN: grey
  bool smooth = true;               ///< `shares` is of points, not of triangles
};

/// The surface on the page, with the triangles that look this way.
Surface seen_by(const Camera& camera, const Surface& surface);

/// A surface on the page with at most that many triangles: points near one another are joined in their
/// middle.
Surface simplified(const Surface& seen, std::size_t most);

/// The triangles of a surface on the page as data of one path, of which the rim is the rim of the whole.
std::string shape_path(const Surface& seen);

/// Whether the triangles are large enough for their edges to be drawn.
bool edges_told_apart(const Surface& seen);

/// The triangles of a surface on the page as elements of SVG, far ones first, lit from the upper left; values
/// of points are gradients.
/// @param id  begins the ids of gradients
std::string painted(const Surface& seen, const std::string& id, bool edges);

}  // namespace hmax
