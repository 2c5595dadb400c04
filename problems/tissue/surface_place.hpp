/// Where a point stands beside the surface of a body.
#pragma once

#include <Eigen/Core>

#include "problems/mesh/topology.hpp"

namespace hmax {

struct SurfacePlace {
  double distance = 0;  ///< from the nearest triangle [m]; infinity without triangles
  bool inside = false;  ///< in the body and not in a hollow of it
};

/// The point x beside a closed surface. It is inside where the triangles, seen from it, wind around it: their
/// solid angles sum to 4 pi, and to nothing outside. One operation per triangle.
/// @param points   shape (3, points)
/// @param outward  corners counter-clockwise as seen from outside
/// @source [vanoosterom1983solid] for the solid angle of a triangle
SurfacePlace place_beside(const Eigen::Matrix3Xd& points, const MeshTriangles& outward,
                          const Eigen::Vector3d& x);

}  // namespace hmax
