/// Whether the Jacobian of a problem is the same in every state and at every time: the one place that
/// decides.
#pragma once

#include <string_view>

#include "analysis/spectrum/linear_model.hpp"
#include "catalogue/methods/method.hpp"
#include "problems/linearity.hpp"

namespace hmax {

/// "linear", "time_varying", "nonlinear", "unknown".
std::string_view name_of(Linearity linearity);

/// From the structure of the problem: its matrices, the parameters of an oscillator, the model and the
/// contact of a body, or what the system says of itself. Unknown for right-hand sides that are only called:
/// plugins, Python.
Linearity linearity_of(const Problem& problem);

/// Whether the Jacobian is a function of time alone, f = A(t) y + b(t).
constexpr bool is_affine(Linearity linearity) {
  return linearity == Linearity::linear || linearity == Linearity::time_varying;
}

/// Whether the Jacobians of two states of one system differ by more than they are known to. Each entry is
/// compared by itself: no unit of a state or of time makes a change small.
bool jacobian_differs(const LinearModel& A, const LinearModel& B);

/// Whether the Jacobian is seen to depend on the state beside `here`, in both directions at distances of 1e-6
/// to 1e3 times the size of the state. True proves that the model is not linear; false proves nothing.
/// @param model_at  the linear model at another state, at the time of `here`
bool depends_on_state(const LinearModel& here,
                      const std::function<LinearModel(const Eigen::VectorXd& y)>& model_at);

}  // namespace hmax
