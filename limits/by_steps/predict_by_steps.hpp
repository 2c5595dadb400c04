/// Limits from the map of one step: of methods that no mode alone tells of, and of methods as simulators run
/// them.
#pragma once

#include <functional>
#include <optional>

#include "limits/by_steps/step_map.hpp"
#include "limits/point/prediction.hpp"

namespace hmax {

/// What is asked of the steps of one method.
struct StepQuestion {
  std::optional<StepChoices> options;  ///< nothing: the method as it is
  bool verified = false;               ///< also integrate on both sides, with the same options
  std::function<void()> watch = {};    ///< called before each step size; may throw
};

/// Whether a row has no limit because its method treats parts of the model in different ways that have no
/// common modes; then the map of a step has one.
bool needs_step_map(const Method& method, const Prediction& row);

/// The largest stable step near `near`: the first step size at which the map of a step on the linear model
/// has a spectral radius above 1, or of truncated iterations an orbit that grows. A frozen Jacobian is that
/// of the initial state of the problem. One that is exact or taken every K steps is that of the state itself
/// but for terms of second order: with direct solutions the limit is that of the modes.
/// @param method  with options: takes_step_options(); else one that is bound to code
/// @param problem that of `near`
Prediction predict_by_steps(const Method& method, const Problem& problem, const Linearised& near,
                            const StepQuestion& question);

/// How many times stiffer a mechanical model may become before steps of h grow that keep the Jacobian of the
/// initial state: K alone is multiplied, damping and Jacobian stay. In strides of a quarter, then to 2 %.
/// @param near  where the model is, with the problem of predict_by_steps()
/// @returns 0 where steps of h grow already, infinity where 64 times is tolerated, NaN for what is not
/// mechanical
double tolerated_stiffening(const Method& method, const Problem& problem, const Linearised& near,
                            const StepChoices& options, double h, const std::function<void()>& watch = {});

}  // namespace hmax
