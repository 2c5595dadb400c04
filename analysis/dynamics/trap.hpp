/// Where a motion in the plane is known to end: neighbourhoods that it does not leave, and far away.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "analysis/dynamics/kink.hpp"
#include "core/instructions/device_code.hpp"

namespace hmax {

/// A neighbourhood of a stable equilibrium that the linear flow does not leave: the ellipse u^T P u < r^2 of
/// u = (y - y*) / size, with J^T P + P J = -1 in these units and r so small that |u| < 1e-3 inside.
/// u^T P u is a Lyapunov function of the linear flow u' = A u, A = size^-1 J size: its derivative is u^T
/// (A^T P + P A) u = -|u|^2 < 0. `size` has to be so small that nonlinear terms stay below slack() inside. A
/// motion inside is counted as arrived.
class Trap {
 public:
  /// @param J     at the equilibrium, all eigenvalues with negative real parts
  /// @param size  the scale of both components, positive
  /// @throws std::invalid_argument when J is not stable
  Trap(const Eigen::Vector2d& equilibrium, const Eigen::Matrix2d& J, const Eigen::Vector2d& size);
  /// At a stable kink: the ellipse x^2 + (v / unit)^2 < r^2 from which motions stay in |u| < 1e-3, though
  /// they swing out of the ellipse.
  Trap(const Eigen::Vector2d& equilibrium, const Kink& kink, const Eigen::Vector2d& size);

  /// What the linear flow stands of other terms [1/s]: it stays in the trap where u' = A u + N(u) with
  /// |N(u)| <= 4 slack |u|. At a kink u = (x, v / unit), and the mean rate of motions stands it.
  [[nodiscard]] double slack() const { return slack_; }

  /// Whether y lies inside; costs one product with a 2 x 2 matrix. False for a y that is not finite.
  [[nodiscard]] HMAX_DEVICE bool holds(const Eigen::Vector2d& y) const {
    const double x = y[0] - equilibrium_[0], v = y[1] - equilibrium_[1];
    // Far away without a division: inside |u| < 1e-3.
    if (!(std::abs(x) < 1.001e-3 * size_[0] && std::abs(v) < 1.001e-3 * size_[1])) return false;
    const double u = x / size_[0], w = v / size_[1];
    return u * (P_[0][0] * u + P_[0][1] * w) + w * (P_[1][0] * u + P_[1][1] * w) < bound_;
  }

 private:
  // Plain numbers, which compilers of devices lay out as the others do.
  double equilibrium_[2], size_[2];
  double P_[2][2];  ///< symmetric and positive definite
  double bound_;    ///< r^2
  double slack_;
};

/// Where starts end that are no place of rest.
enum Fate { undecided = -1, unbounded = -2 };

/// The trap of a place of rest.
struct NumberedTrap {
  int number;
  Trap trap;
};

/// When a motion has found its fate; unbounded a million sizes of the window away. The traps lie elsewhere.
struct FateRule {
  const NumberedTrap* traps;
  int count;
  double lower[2], size[2];  ///< of the window

  /// A number of a trap, or a Fate: undecided while the motion has to go on.
  [[nodiscard]] HMAX_DEVICE int of(const Eigen::Vector2d& y) const {
    int fate = undecided;
    for (int i = 0; i < count; ++i)
      if (traps[i].trap.holds(y)) fate = traps[i].number;
    for (int i = 0; i < 2; ++i)
      if (!(std::abs(y[i] - lower[i]) < 1e6 * size[i])) fate = unbounded;
    return fate;
  }
};

}  // namespace hmax
