/// A step of a method on a linear model as a map of its motions, made by the code of the method.
#pragma once

#include <string>

#include "analysis/step_limits/step_map_limit.hpp"
#include "catalogue/methods/method.hpp"
#include "limits/point/operating_point.hpp"

namespace hmax {

/// How a simulator runs a method that solves one linear system a step.
struct StepChoices {
  JacobianUpdate jacobian{1};  ///< exact
  LinearSolve linear{.by = LinearSolve::By::direct};

  [[nodiscard]] bool is_truncated() const { return linear.by == LinearSolve::By::conjugate_gradients; }
  [[nodiscard]] bool is_frozen() const { return jacobian.every == JacobianUpdate::frozen; }
};

/// "linearly_implicit_euler, Jacobian frozen, direct": a method with its options, as stores and tables name
/// it.
std::string name_with(const Method& method, const StepChoices& options);
/// The id in such a name.
std::string id_in(const std::string& name);

/// Whether the options change what a step of the method makes: methods of hmax that solve linear equations
/// alone.
bool takes_step_options(const Method& method);

/// The steps of `method` on y' = J y, J of `model`.
/// @param jacobian  whose Jacobian the method has: `model` itself, or that of an older state
StepMapAt step_maps(const Method& method, const LinearModel& model, const LinearModel& jacobian,
                    const LinearSolve& linear);

/// The energy v^T M v + q^T K q as an inner product, where K is symmetric and positive definite as far as a
/// factorisation tells; empty where not.
LinearOperator energy_product(const LinearModel& model);

}  // namespace hmax
