/// A reference for any system, stiff or not: extrapolation in long double. No method of the catalogue is
/// built like it, and it shares no code with them.
#pragma once

#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "problems/any_system.hpp"

namespace hmax {

/// What is extrapolated to step size zero.
enum class ExtrapolatedRule {
  explicit_midpoint,  ///< errors in powers of h^2; for problems that are not stiff [hairer1993solving, II.9]
  implicit_euler      ///< errors in powers of h; for stiff ones, needs the Jacobian [hairer1996solving, IV.9]
};

/// The states at the engine's own steps on [0, valid_until()], computed at a tight tolerance; between two of
/// them the engine integrates on from the left one, where nothing is stiff by short explicit steps, which
/// cost far less. Every component is controlled relative to its own size, so that one of 1e-13 beside one of
/// 1 is as good. A second computation at a looser tolerance runs to a few hundred of the same times; four
/// times the largest difference is the bound.
/// @source  [hairer1993solving, II.9], [hairer1996solving, IV.9]; checked by
///          tests/bench/timing/extrapolation_reference_test.cpp and against the published end points of the
///          test set
class ExtrapolationReference {
 public:
  using System = BasicAnySystem<long double>;
  using State = System::State;

  /// @param y0     shape (dim)
  /// @param t_end  end of the interval [s], not negative
  /// @param watch  called after every step; may throw to end it
  /// @throws std::invalid_argument  when implicit_euler is asked for a system without a Jacobian
  ExtrapolationReference(const System& system, const State& y0, double t_end, ExtrapolatedRule rule,
                         const std::function<void()>& watch = {});

  /// Shape (dim); NaN outside [0, valid_until()]. Costs about one step of the engine; thread-safe.
  [[nodiscard]] State extended_at(long double t) const;
  [[nodiscard]] Eigen::VectorXd at(double t) const { return extended_at(t).cast<double>(); }

  /// t_end, or an earlier time where the engine gave up: the solution blows up, or would take too many steps.
  [[nodiscard]] double valid_until() const { return valid_until_; }
  /// Bound of |at(t) - y(t)| in the maximum norm.
  [[nodiscard]] double error_bound() const { return error_bound_; }
  /// Bound of |extended_at(t) - y(t)|, without the rounding to double.
  [[nodiscard]] double extended_error_bound() const { return extended_error_bound_; }
  /// The same relative to each component's own size at valid_until(), shape (dim).
  [[nodiscard]] const Eigen::VectorXd& relative_error_at_end() const { return relative_error_at_end_; }
  [[nodiscard]] std::size_t steps() const { return points_.size() - 1; }
  [[nodiscard]] std::string name() const;

 private:
  struct Point {
    Point(long double time, State state) : t(time), y(std::move(state)) {}
    long double t;
    State y;
    mutable std::once_flag is_divided;
    mutable std::vector<State> between;  ///< see divided()
  };

  /// The states at equal parts of the way from a point to the next, as far as explicit steps reach them.
  const std::vector<State>& divided(const Point& left, long double part) const;

  System system_;
  ExtrapolatedRule rule_;
  std::deque<Point> points_;
  double valid_until_ = 0, error_bound_ = 0, extended_error_bound_ = 0;
  Eigen::VectorXd relative_error_at_end_;
};

}  // namespace hmax
