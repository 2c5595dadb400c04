/// The held end of a mesh, and where loads act on the free one.
#pragma once

#include <cmath>
#include <utility>

#include <Eigen/Core>

#include "problems/mesh/topology.hpp"
#include "problems/tissue/loads.hpp"

namespace hmax {

/// One end of a mesh along an axis, to which loads are opposite.
struct HeldEnd {
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();  ///< unit vector that points from the free end to it

  explicit HeldEnd(double axis) { towards[static_cast<int>(std::abs(axis)) - 1] = axis > 0 ? -1 : 1; }
  explicit HeldEnd(Eigen::Vector3d direction) : towards(std::move(direction)) {}

  /// The middle one of the points that are farthest from it.
  [[nodiscard]] TetMesh::Index opposite(const TetMesh& mesh) const;
};

/// A force towards the held end on the patch of the surface around the free one.
PressingForce pressing_force(double force, const TetMesh& mesh, const HeldEnd& end);

/// Where a tool that moves along `way` meets the body squarely and does not slide off: the foremost point, in
/// the nearer half of the body, around which the surface within a radius faces the tool. Where there is none,
/// the foremost of all.
TetMesh::Index faced_point(const TetMesh& mesh, const MeshSurface& surface, const HeldEnd& way,
                           double radius);

}  // namespace hmax
