#include "problems/tissue/loads.hpp"

#include <algorithm>
#include <cmath>

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

SphereTool::Pose SphereTool::pose(double t) const {
  return {start + profile.value(t) * travel, profile.rate(t) * travel};
}

bool SphereTool::touch(const Pose& pose, const Eigen::Vector3d& x, const Eigen::Vector3d& v,
                       Touch& touch) const {
  const Eigen::Vector3d arm = x - pose.centre;
  const double distance = arm.norm(), depth = radius - distance;
  if (!(depth > 0 && distance > 0)) return false;
  const Eigen::Vector3d n = arm / distance, w = v - pose.velocity;
  const double along = n.dot(w), rush = 1 - damping * along;
  if (!(rush > 0)) return false;
  const double root = std::sqrt(depth), push = stiffness * depth * root;
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - n * n.transpose();
  touch.force = push * rush * n;
  // d falls by n.dx, d' = -n.w by (w - n (n.w)).dx / distance and by n.dv.
  touch.stiffness =
      n * (1.5 * stiffness * root * rush * n + push * damping / distance * (w - along * n)).transpose() -
      push * rush / distance * across;
  touch.damping = push * damping * n * n.transpose();
  touch.energy = 0.4 * push * depth;
  return true;
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
