/// What acts on a body from outside: supports that hold or move points, forces, and a tool that touches.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "problems/tissue/tet_mesh.hpp"

namespace hmax {

/// A factor over time [1] and its derivative [1/s]: how a support, a force or a tool comes and goes.
struct TimeProfile {
  enum class Kind {
    steady,  ///< 1
    ramp,    ///< from 0 at `start` to 1 after `rise`, twice differentiable: 10 u^3 - 15 u^4 + 6 u^5
    sine     ///< sin(omega (t - start))
  };
  Kind kind = Kind::steady;
  double start = 0;  ///< [s]
  double rise = 1;   ///< [s], of a ramp; positive
  double omega = 1;  ///< [rad/s], of a sine

  [[nodiscard]] double value(double t) const;
  [[nodiscard]] double rate(double t) const;
};

/// Points that the equations no longer contain: they stand at rest + travel * profile(t).
struct Support {
  std::vector<TetMesh::Index> points;
  Eigen::Vector3d travel = Eigen::Vector3d::Zero();  ///< [m]
  TimeProfile profile = {};
};

/// A dead load: a force that keeps its direction and size while the body moves.
struct PressingForce {
  std::vector<TetMesh::Index> points;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N], of all points together
  std::vector<double> shares = {};                  ///< of each point, e.g. its area; empty: equal shares
  TimeProfile profile = {};
};

/// The tip of a tool: a sphere whose centre stands at start + travel * profile(t) and pushes every point of
/// the body that enters it along its radius,
///   F = k d^(3/2) (1 + chi d') >= 0,   d = radius - |x - centre|,
/// where the last factor keeps the force continuous when contact begins and ends. A tool never pulls.
/// @source  [hunt1975coefficient]
struct SphereTool {
  std::vector<TetMesh::Index> points;                ///< that may touch it
  double radius = 0.01;                              ///< [m], positive
  Eigen::Vector3d start = Eigen::Vector3d::Zero();   ///< [m]
  Eigen::Vector3d travel = Eigen::Vector3d::Zero();  ///< [m]
  TimeProfile profile = {};
  double stiffness = 1000;  ///< k [N/m^1.5], of each point
  double damping = 0;       ///< chi [s/m]

  /// The tool at one moment.
  struct Pose {
    Eigen::Vector3d centre, velocity;
  };
  [[nodiscard]] Pose pose(double t) const;

  /// What one point at x [m] with velocity v [m/s] meets.
  struct Touch {
    Eigen::Vector3d force;               ///< [N]
    Eigen::Matrix3d stiffness, damping;  ///< -dF/dx, -dF/dv
    double energy;                       ///< 2/5 k d^(5/2) [J]
  };
  /// @returns false, and leaves `touch` alone, when the point is outside or the force would pull
  bool touch(const Pose& pose, const Eigen::Vector3d& x, const Eigen::Vector3d& v, Touch& touch) const;
};

/// Points of a mesh in a box, its sides included [m].
std::vector<TetMesh::Index> points_in_box(const TetMesh& mesh, const Eigen::Vector3d& low,
                                          const Eigen::Vector3d& high);

}  // namespace hmax
