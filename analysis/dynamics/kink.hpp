/// What motions do near an equilibrium where the slopes of a planar field jump.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace hmax {

/// The motions of a field that is piecewise linear around an equilibrium. If it has rays that motions follow,
/// straight to the equilibrium or straight away from it, also where they slide along a jump of the field,
/// their rates are what eigenvalues are of a linear field. Otherwise motions turn around it.
struct Kink {
  struct Ray {
    Eigen::Vector2d direction;  ///< in the units of the state, of length 1
    double rate;                ///< of growth [1/s]
  };
  std::vector<Ray> rays{};
  /// Of a turn [1/s, rad/s], where there are no rays: the mean growth, how far rounding and the finite number
  /// of directions may be off, and the mean angular frequency.
  double rate = 0, rate_error = 0, frequency = 0;
  double unit = 1;   ///< so much of the second component counts as one of the first, for `swing`
  double swing = 1;  ///< of a stable kink: how many times as far away as it began a motion comes at most
};

/// @param f     of states
/// @param y     where f is zero
/// @param r     shape (2), positive: so far from y f is piecewise linear and larger than its rounding
/// @param unit  Kink::unit, such that both components change each other alike
Kink kink_around(const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& f, const Eigen::Vector2d& y,
                 const Eigen::Vector2d& r, double unit);

}  // namespace hmax
