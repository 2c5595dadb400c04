#include "problems/tissue/surface_place.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace hmax {
namespace {

using Eigen::Vector3d;

/// The distance of the origin from the segment between a and b.
double distance_to_segment(const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double length = along.squaredNorm();
  const double share = length > 0 ? std::clamp(-a.dot(along) / length, 0.0, 1.0) : 0.0;
  return (a + share * along).norm();
}

/// The same from a triangle.
double distance_to_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a);
  // The foot of the origin on the plane lies in the triangle where it is on the inner side of all three
  // sides.
  const Vector3d foot =
      normal.squaredNorm() > 0 ? Vector3d(a.dot(normal) / normal.squaredNorm() * normal) : a;
  const auto inner = [&](const Vector3d& from, const Vector3d& to) {
    return (to - from).cross(foot - from).dot(normal) >= 0;
  };
  if (normal.squaredNorm() > 0 && inner(a, b) && inner(b, c) && inner(c, a)) return foot.norm();
  return std::min({distance_to_segment(a, b), distance_to_segment(b, c), distance_to_segment(c, a)});
}

/// The solid angle under which the origin sees a triangle; negative where it looks at its outer side.
double solid_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace

SurfacePlace place_beside(const Eigen::Matrix3Xd& points, const MeshTriangles& outward, const Vector3d& x) {
  SurfacePlace place{.distance = std::numeric_limits<double>::infinity()};
  double angle = 0;
  for (const auto& corners : outward.colwise()) {
    const Vector3d a = points.col(corners[0]) - x, b = points.col(corners[1]) - x,
                   c = points.col(corners[2]) - x;
    place.distance = std::min(place.distance, distance_to_triangle(a, b, c));
    angle += solid_angle(a, b, c);
  }
  place.inside = angle > 2 * std::numbers::pi;
  return place;
}

}  // namespace hmax
