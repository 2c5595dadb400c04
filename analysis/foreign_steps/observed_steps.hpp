/// Whether runs of an engine itself grow.
#pragma once

#include <cstdint>
#include <functional>

#include <Eigen/Core>

#include "analysis/foreign_steps/foreign_stepper.hpp"

namespace hmax {

struct GrowthRun {
  std::int64_t steps = 2000;
  double amplitude = 1e-6;  ///< of the disturbance, in units of scales
  double bound = 0.1;       ///< the run ends at a distance beyond it
  double most =
      1e4;  ///< from the beginning to the end of a run: more is growth, though it has come to an end
  bool follow = false;  ///< the state moves: the distance is that of a run without the disturbance
  std::function<void()> watch = {};
};

/// Runs the engine from the state in `slot` with a small random disturbance. The distances from the
/// undisturbed run are compared: the largest of the last quarter with the largest of the second one. Motions
/// of constant amplitude keep it, free motion at constant velocity doubles it.
/// @return  whether it grew by more than a factor of 4, to the bound faster than in proportion to time, or
/// out of the range of
///          numbers
bool run_grows(ForeignStepper& engine, const StateCoordinates& coordinates, const Eigen::VectorXd& scale,
               int slot, double h, const GrowthRun& run);

/// ln of the factor between the distances of two neighbours at the end and at the beginning of a run;
/// infinity where it diverged.
double growth_of_run(ForeignStepper& engine, const StateCoordinates& coordinates,
                     const Eigen::VectorXd& scale, int slot, double h, const GrowthRun& run);

}  // namespace hmax
