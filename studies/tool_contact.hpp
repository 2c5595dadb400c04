/// A tool that meets a body: found by a view volume, pressed by penalty forces.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/topology.hpp"
#include "results/json.hpp"

namespace hmax {

/// A convex volume of six planes: points x with n . x <= d of each row (n, d).
using ViewVolume = std::array<Eigen::Vector4d, 6>;

/// A box of square section, as a parallel view sees: from `from` along `ahead`.
/// @param ahead  its length is that of the box [m]
/// @param half   half of the side of the section [m]
ViewVolume view_along(const Eigen::Vector3d& from, const Eigen::Vector3d& ahead, double half);

/// The triangles of which a piece lies in the volume, by clipping each at its planes.
/// @param points  shape (3, points)
std::vector<Eigen::Index> triangles_in(const ViewVolume& volume, const Eigen::Matrix3Xd& points,
                                       const MeshTriangles& triangles);

/// What a view volume around the path of a tool finds of a surface.
struct ViewSearch {
  long triangles = 0;  ///< of the surface
  long found = 0;      ///< in the volume
  long touched = 0;    ///< by the ball of the tool where it ends
  long missed = 0;     ///< of them, not found
  double seconds = 0;  ///< CPU time of a search
};
HMAX_RECORD(ViewSearch, triangles, found, touched, missed, seconds);
/// Of the tool of the load `tool` on a mesh at rest, by a box as wide as its ball and as long as its way.
ViewSearch view_search(std::string_view mesh, std::string_view material);

/// A tool that is pressed in with a penalty of some stiffness.
struct PenaltyContact {
  double factor = 1;       ///< stiffness of the penalty over its default
  double penetration = 0;  ///< of the surface into the tool [m]
  double force = 0;        ///< of the tool on the body [N]
  double h_rest = 0;       ///< largest stable step of symplectic Euler without contact [s]
  double h_pressed = 0;    ///< and at the end of the way [s]
};
HMAX_RECORD(PenaltyContact, factor, penetration, force, h_rest, h_pressed);
/// Of finite elements of Green's strain, each penalty ten times as stiff as the one before.
/// @param depth  of the tool [m]
std::vector<PenaltyContact> penalty_contacts(std::string_view mesh, std::string_view material, double depth);

}  // namespace hmax
