/// Whether Jacobians of a system are seen to differ, where nothing says that they do not.
#pragma once

#include <functional>

#include "analysis/spectrum/linear_model.hpp"

namespace hmax {

/// Whether the Jacobians of two states of one system differ by more than they are known to. Each entry is
/// compared by itself: no unit of a state or of time makes a change small.
bool jacobian_differs(const LinearModel& A, const LinearModel& B);

/// Whether the Jacobian is seen to depend on the state beside `here`, in both directions at distances of 1e-6
/// to 1e3 times the size of the state. True proves that the model is not linear; false proves nothing.
/// @param model_at  the linear model at another state, at the time of `here`
bool depends_on_state(const LinearModel& here,
                      const std::function<LinearModel(const Eigen::VectorXd& y)>& model_at);

}  // namespace hmax
