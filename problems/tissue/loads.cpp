#include "problems/tissue/loads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

namespace hmax {

double TimeProfile::value(double t) const {
  switch (kind) {
    case Kind::ramp: {
      const double u = std::clamp((t - start) / rise, 0.0, 1.0);
      return u * u * u * (10 - u * (15 - 6 * u));
    }
    case Kind::sine:
      return std::sin(omega * (t - start));
    case Kind::steady:
      break;
  }
  return 1;
}

double TimeProfile::rate(double t) const {
  switch (kind) {
    case Kind::ramp: {
      const double u = std::clamp((t - start) / rise, 0.0, 1.0);
      return 30 * u * u * (1 - u) * (1 - u) / rise;
    }
    case Kind::sine:
      return omega * std::cos(omega * (t - start));
    case Kind::steady:
      break;
  }
  return 0;
}

double TimeProfile::steady_from() const {
  switch (kind) {
    case Kind::ramp:
      return start + rise;
    case Kind::sine:
      return std::numeric_limits<double>::infinity();
    case Kind::steady:
      break;
  }
  return 0;
}

SphereTool::Pose SphereTool::pose(double t) const {
  return {start + profile.value(t) * travel, profile.rate(t) * travel};
}

bool SphereTool::touches(const Pose& pose, const Eigen::Vector3d& x, const Eigen::Vector3d& v,
                         Touch& touch) const {
  touch.normal = x - pose.centre;
  touch.distance = touch.normal.norm();
  touch.depth = radius - touch.distance;
  if (!(touch.depth > 0 && touch.distance > 0)) return false;
  touch.normal /= touch.distance;
  touch.velocity = v - pose.velocity;
  return 1 - damping * touch.normal.dot(touch.velocity) > 0;
}

Eigen::Vector3d SphereTool::pressure(const Touch& touch) const {
  const double rush = 1 - damping * touch.normal.dot(touch.velocity);
  return stiffness * touch.depth * std::sqrt(touch.depth) * rush * touch.normal;
}

Eigen::Matrix3d SphereTool::stiffness_of(const Touch& touch) const {
  const Eigen::Vector3d& n = touch.normal;
  const double root = std::sqrt(touch.depth), push = stiffness * touch.depth * root,
               along = n.dot(touch.velocity), rush = 1 - damping * along;
  // d falls by n.dx, d' = -n.w by (w - n (n.w)).dx / distance.
  const Eigen::Vector3d change =
      1.5 * stiffness * root * rush * n + push * damping / touch.distance * (touch.velocity - along * n);
  return n * change.transpose() -
         push * rush / touch.distance * (Eigen::Matrix3d::Identity() - n * n.transpose());
}

Eigen::Matrix3d SphereTool::damping_of(const Touch& touch) const {
  // d' falls by n.dv.
  return stiffness * touch.depth * std::sqrt(touch.depth) * damping * touch.normal * touch.normal.transpose();
}

double SphereTool::energy(const Touch& touch) const {
  return 0.4 * stiffness * touch.depth * touch.depth * std::sqrt(touch.depth);
}

std::vector<TetMesh::Index> points_in_box(const TetMesh& mesh, const Eigen::Vector3d& low,
                                          const Eigen::Vector3d& high) {
  std::vector<TetMesh::Index> inside;
  for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
    const auto x = mesh.points.col(i).array();
    if ((x >= low.array()).all() && (x <= high.array()).all())
      inside.push_back(static_cast<TetMesh::Index>(i));
  }
  return inside;
}

}  // namespace hmax
