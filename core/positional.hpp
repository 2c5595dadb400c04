/// What methods that move one point, or the points of one constraint, at a time exchange with a body.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace hmax {

/// Numbers of points, or of constraints, in groups that are taken one after the other. What one of a group
/// changes is nothing that another of it reads, so that they may be taken at once with the same bits.
using Colours = std::vector<std::vector<std::int32_t>>;

/// The force on one point, and its derivatives by the place and the velocity of that point alone.
struct PointForce {
  Eigen::Vector3d f = Eigen::Vector3d::Zero();  ///< F_i [N]
  Eigen::Matrix3d K = Eigen::Matrix3d::Zero();  ///< -dF_i/dq_i [N/m]
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();  ///< -dF_i/dv_i [N s/m]
};

/// C(q) = 0 with the energy C^2 / (2 alpha), at one q. What set() and add() do not write has no value.
struct CompliantConstraint {
  double value;                             ///< C
  double compliance;                        ///< alpha
  std::size_t points;                       ///< how many it moves, at most 4
  std::array<std::int32_t, 4> point;        ///< their numbers
  std::array<Eigen::Vector3d, 4> gradient;  ///< dC/dq_i of each

  /// No points yet.
  void set(double its_value, double its_compliance) {
    value = its_value;
    compliance = its_compliance;
    points = 0;
  }
  /// One more point; held ones, of a negative number, do not count.
  void add(std::int32_t number, const Eigen::Vector3d& slope) {
    if (number < 0) return;
    point[points] = number;
    gradient[points++] = slope;
  }
};

}  // namespace hmax
