/// What acts on a body from outside: supports that hold or move points, forces, and a tool that touches.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/kernels/tool_contact.hpp"

namespace hmax {

/// A smooth curve through measured values: cubic between them, with a continuous derivative, without
/// overshoot [fritsch1984method]. Before the first and after the last of them it is constant.
class SampledCurve {
 public:
  /// @param t  [s], increasing, two at least
  /// @param v  as many
  /// @throws std::invalid_argument  where they are not, or a number is not finite
  SampledCurve(std::vector<double> t, std::vector<double> v);

  [[nodiscard]] double value(double t) const;
  [[nodiscard]] double rate(double t) const;
  [[nodiscard]] double t_begin() const { return t_.front(); }
  [[nodiscard]] double t_end() const { return t_.back(); }

 private:
  [[nodiscard]] std::size_t interval_of(double t) const;
  std::vector<double> t_, v_, slope_;
};

/// A factor over time [1] and its derivative [1/s]: how a support, a force or a tool comes and goes.
struct TimeProfile {
  enum class Kind {
    steady,  ///< 1
    ramp,    ///< from 0 at `start` to 1 after `rise`, twice differentiable: 10 u^3 - 15 u^4 + 6 u^5; from
             ///< `fall` on as smoothly back to 0
    sine,    ///< sin(omega (t - start))
    samples  ///< a curve through measured values
  };
  Kind kind = Kind::steady;
  double start = 0;                                       ///< [s]
  double rise = 1;                                        ///< [s], of a ramp; positive
  double omega = 1;                                       ///< [rad/s], of a sine
  std::shared_ptr<const SampledCurve> curve = {};         ///< of samples
  double fall = std::numeric_limits<double>::infinity();  ///< [s], of a ramp; infinity: it stays at 1

  [[nodiscard]] double value(double t) const;
  [[nodiscard]] double rate(double t) const;
  /// From when on the factor stays the same [s]; infinity: never.
  [[nodiscard]] double steady_from() const;
  /// Appends the times where the factor begins and ceases to change [s]: its derivatives jump there.
  void add_breakpoints(std::vector<double>& times) const;
};

/// Points that the equations no longer contain: they stand at rest + travel * profile(t). What supports of
/// the same points add up to, one after the other, is the motion of these points.
struct Support {
  std::vector<TetMesh::Index> points;
  Eigen::Vector3d travel = Eigen::Vector3d::Zero();  ///< [m]
  TimeProfile profile = {};
};

/// Points that springs hold at their places at rest, with -k u in every direction, as an elastic foundation
/// does. They stay unknowns.
struct ElasticSupport {
  std::vector<TetMesh::Index> points;
  std::vector<double> stiffness;  ///< k of each [N/m], zero or more
};

/// @throws std::invalid_argument  where a point has no stiffness, or one that is negative or not finite
void check_stiffness(const ElasticSupport& support);

/// The surface around points on a foundation of modulus s: k = s A, with A a third of each triangle of the
/// surface whose corners are all among the points, so that the sum is s times their area on any mesh
/// (Winkler's foundation). Points without area are left out.
/// @param points  of the mesh, in any order
/// @param modulus  [Pa/m]
/// @returns no points where no triangle has all its corners among them
ElasticSupport on_foundation(const TetMesh& mesh, const std::vector<TetMesh::Index>& points, double modulus);

/// A dead load: a force that keeps its direction and size while the body moves.
struct PressingForce {
  std::vector<TetMesh::Index> points;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N], of all points together
  std::vector<double> shares = {};                  ///< of each point, e.g. its area; empty: equal shares
  TimeProfile profile = {};
};

/// The tip of a tool: a sphere whose centre stands at start + travel * profile(t) and presses on every piece
/// of the surface that enters it, along its radius, with
///   p = k d^(3/2) (1 + chi d') >= 0,   d = radius - |x - centre|,
/// where the last factor keeps the pressure continuous when contact begins and ends. A tool never pulls.
/// @source  [hunt1975coefficient] for the law of a contact, here that of each piece of its surface
struct SphereTool {
  double radius = 0.01;                              ///< [m], positive
  Eigen::Vector3d start = Eigen::Vector3d::Zero();   ///< [m]
  Eigen::Vector3d travel = Eigen::Vector3d::Zero();  ///< [m]
  TimeProfile profile = {};
  double stiffness = 1e8;  ///< k [Pa/m^1.5]
  double damping = 0;      ///< chi [s/m]

  [[nodiscard]] SpherePose<double> pose(double t) const;
  [[nodiscard]] SphereLaw<double> law() const { return {radius, stiffness, damping}; }
};

/// Points of a mesh within `share` of its extent along a unit vector from its far end.
std::vector<TetMesh::Index> points_of_end(const TetMesh& mesh, const Eigen::Vector3d& towards, double share);

/// Points of a mesh in a box, its sides included [m].
std::vector<TetMesh::Index> points_in_box(const TetMesh& mesh, const Eigen::Vector3d& low,
                                          const Eigen::Vector3d& high);

}  // namespace hmax
