/// The derivative of one step of an engine, by central differences at increments that its precision allows.
#pragma once

#include <functional>
#include <optional>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "analysis/foreign_steps/foreign_stepper.hpp"
#include "analysis/foreign_steps/step_pattern.hpp"

namespace hmax {

/// Of u -> u', coordinates in units of scales, about a state y that goes to y' in a step of size h. What is
/// hidden in the engine is as in the slot.
class StepDerivative {
 public:
  /// @param engine  with its state of y in `slot`
  /// @param scale   shape (coordinates.size()), positive
  StepDerivative(ForeignStepper& engine, const StateCoordinates& coordinates, const Eigen::VectorXd& scale,
                 int slot, const Eigen::VectorXd& y, double h);

  /// False where a step from y leaves the range of numbers, or cannot be done.
  [[nodiscard]] bool is_finite() const { return next_.allFinite(); }
  [[nodiscard]] const Eigen::VectorXd& next() const { return next_; }  ///< y'
  [[nodiscard]] double increment() const { return increment_; }        ///< in units of scales
  /// Estimate of the spectral norm of the error of matrix(): the difference of differences at two increments
  /// in random directions, not less than rounding.
  [[nodiscard]] double error() const { return error_; }

  /// The error of differences in the direction v, relative to |v|: what other increments make of it. At least
  /// error().
  [[nodiscard]] double error_along(const Eigen::VectorXd& v) const;

  /// Whether the changes of two disturbances together are the sum of their changes, beyond error() and to a
  /// twentieth: no matrix tells what such a step does, as one with bounded impulses, however small the
  /// disturbances are.
  [[nodiscard]] bool is_linear() const;

  /// J v. @param v  shape (coordinates.size()), @param factor  of the increment
  [[nodiscard]] Eigen::VectorXd product(const Eigen::VectorXd& v, double factor = 1) const;
  /// J, shape (coordinates.size(), coordinates.size()); two steps a column. The pattern is learned from it.
  /// @param watch  called with the share that is done; may throw
  [[nodiscard]] Eigen::MatrixXd matrix(StepPattern& pattern,
                                       const std::function<void(double share)>& watch = {}) const;
  /// J by a pattern that pays, two steps a group, if it makes of a random direction what a difference does,
  /// to ten times error(), which then is at least what is left. Nothing where it does not: the pattern is
  /// refused.
  [[nodiscard]] std::optional<Eigen::SparseMatrix<double>> grouped_matrix(
      StepPattern& pattern, const std::function<void(double share)>& watch = {});
  /// J without the entries that another increment does not confirm to a third.
  [[nodiscard]] Eigen::MatrixXd confirmed_matrix(StepPattern& pattern,
                                                 const std::function<void(double share)>& watch = {});

 private:
  [[nodiscard]] Eigen::MatrixXd matrix_at(double increment,
                                          const std::function<void(double share)>& watch) const;
  [[nodiscard]] Eigen::SparseMatrix<double> grouped_at(double increment, const StepPattern& pattern,
                                                       const std::function<void(double share)>& watch) const;
  [[nodiscard]] Eigen::VectorXd difference(const Eigen::VectorXd& v, double increment) const;
  [[nodiscard]] double least_increment() const;
  void choose_increment();

  ForeignStepper* engine_;
  const StateCoordinates* coordinates_;
  Eigen::VectorXd scale_, y_, next_;
  int slot_;
  double h_, increment_ = 1e-5, error_ = 0;
};

/// Scales of a state as sizes of its numbers: at least a hundredth of the largest one; 1 where all are zero
/// but for rounding.
Eigen::VectorXd scales_of(const Eigen::VectorXd& y);

/// Factors of scales that balance a Jacobian: rows and columns of D^-1 (J - I) D have like norms, so that
/// positions and velocities are measured in one unit. [parlett1969balancing]
/// @param J  without noise: how large its small entries are matters
/// @return  shape (n), at most 1
Eigen::VectorXd balancing_factors(const Eigen::MatrixXd& J);
/// The same of a map of which only products are known, from random vectors of signs. [chen2000balancing]
Eigen::VectorXd balancing_factors(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& J,
                                  Eigen::Index n);

}  // namespace hmax
