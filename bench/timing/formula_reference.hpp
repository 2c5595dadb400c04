/// A reference for users' formulas: another engine at a tight tolerance.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "problems/any_system.hpp"

namespace hmax {

/// Units in which the numbers of a state are near one.
struct StateUnits {
  double positions = 1;  ///< of mechanical systems
  double others = 1;     ///< of their velocities, of other systems of every number
};

/// States on a grid of [0, valid_until], computed once at a tight tolerance and once at a looser one; between
/// two grid points the engine integrates on from the left one. The largest difference of the two computations
/// is the bound; the grid ends where they part, as at a pole. Of formulas absolute tolerances are shares of
/// the size of the motion so far.
class FormulaReference {
 public:
  /// @param y0     shape (dim)
  /// @param watch  called at every grid point; may throw to end it
  FormulaReference(const AnySystem& system, const Eigen::VectorXd& y0, double t_end,
                   const std::function<void()>& watch = {});

  /// Shape (dim); NaN outside [0, valid_until()]. Several microseconds.
  [[nodiscard]] Eigen::VectorXd at(double t) const;
  /// t_end, or the last grid point that was reached.
  [[nodiscard]] double valid_until() const;
  /// Bound of the error of at() in the maximum norm.
  [[nodiscard]] double error_bound() const { return error_bound_; }
  /// Which engine was used.
  [[nodiscard]] static std::string name();

 private:
  AnySystem system_;
  double interval_;
  std::vector<Eigen::VectorXd> grid_;
  std::vector<StateUnits> units_;  ///< of each interval
  double error_bound_ = 0;
};

}  // namespace hmax
