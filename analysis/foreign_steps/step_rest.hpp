/// Where steps of one size are at rest.
#pragma once

#include <Eigen/Core>

#include "analysis/foreign_steps/foreign_stepper.hpp"
#include "analysis/foreign_steps/step_pattern.hpp"

namespace hmax {

struct StepRest {
  Eigen::VectorXd y;
  double left = 0;   ///< how far a step moves it, in units of scales; infinity where it cannot be done
  double error = 0;  ///< about how far it is from rest
};

/// The largest of |S(y) - y| in units of scales; infinity where the step cannot be done.
double distance_of_step(ForeignStepper& engine, const StateCoordinates& coordinates,
                        const Eigen::VectorXd& scale, int slot, const Eigen::VectorXd& y, double h);

/// y = S(y) by Newton's method, (I - J) x = S(y) - y, of least norm where motions are free; where that
/// ends at a state that a step moves by more than `near_rest`, from where the engine's own steps bring the
/// first one: constraints that large steps make softer rest far away from those of small ones.
/// @param tolerance  of what a step moves, in units of scales
StepRest rest_of_step(ForeignStepper& engine, const StateCoordinates& coordinates,
                      const Eigen::VectorXd& scale, int slot, const Eigen::VectorXd& y, double h,
                      StepPattern& pattern, double tolerance, double near_rest);

}  // namespace hmax
