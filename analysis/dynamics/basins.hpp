/// Basins of attraction: which place of rest a start leads to.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/phase_plane.hpp"

namespace hmax {

/// A neighbourhood of a stable equilibrium that the linear flow does not leave: the ellipse u^T P u < r^2 of
/// u = (y - y*) / size, with J^T P + P J = -1 in these units and r so small that |u| < 1e-3 inside.
/// u^T P u is a Lyapunov function of the linear flow u' = A u, A = size^-1 J size: its derivative is u^T
/// (A^T P + P A) u = -|u|^2 < 0. Nonlinear terms are small against this for |u| < 1e-3, which is assumed,
/// not checked. A motion inside is counted as arrived.
class Trap {
 public:
  /// @param J     at the equilibrium, all eigenvalues with negative real parts
  /// @param size  the scale of both components, positive
  /// @throws std::invalid_argument when J is not stable
  Trap(const Eigen::Vector2d& equilibrium, const Eigen::Matrix2d& J, const Eigen::Vector2d& size);

  /// Whether y lies inside; costs one product with a 2 x 2 matrix. False for a y that is not finite.
  [[nodiscard]] bool holds(const Eigen::Vector2d& y) const {
    const Eigen::Vector2d from = y - equilibrium_;
    // Far away without a division: inside |u| < 1e-3.
    if (!(from.cwiseAbs().array() < 1.001e-3 * size_.array()).all()) return false;
    const Eigen::Vector2d u = from.cwiseQuotient(size_);
    return u.dot(P_ * u) < bound_;
  }

 private:
  Eigen::Vector2d equilibrium_, size_;
  Eigen::Matrix2d P_;  ///< symmetric and positive definite
  double bound_;       ///< r^2
};

/// Where starts end that are no place of rest.
enum Fate { undecided = -1, unbounded = -2 };

/// The fates of starts at the centres of columns x rows cells of a window.
/// Cells of one fate together are the picture of a basin; their border is resolved to one cell.
struct Basins {
  int columns, rows;
  Window window;
  std::vector<int>
      fate;  ///< [row * columns + column], rows upwards: the number of a place of rest, or a Fate

  /// The part of the cells that have this fate.
  [[nodiscard]] double share(int of) const;
};

/// The fates of several starts, written to as many numbers. One such function is called by one thread at a
/// time.
using FatesOf = std::function<void(std::span<const Eigen::Vector2d> starts, std::span<int> fates)>;

/// Asks for the fate of each of the columns x rows centres once, a row in one call, from below. Rows are
/// shared by all cores.
/// @param fates_of  one for each thread: at least as many as jobs(), or as there are rows
/// @param going     called with the share that is begun before each row, by one thread at a time; no row is
///                  begun after it answers false, and the cells that are left are undecided
/// @throws std::invalid_argument when the window is empty or there are no cells
Basins basins(const std::vector<FatesOf>& fates_of, const Window& window, int columns, int rows,
              const std::function<bool(double)>& going = {});

}  // namespace hmax
