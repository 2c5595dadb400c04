/// How the right-hand side of a system depends on its state.
#pragma once

namespace hmax {

/// What is known of f(t, y) from the structure of the system, for every state and time.
enum class Linearity {
  linear,        ///< f = A y + b(t): one constant Jacobian
  time_varying,  ///< f = A(t) y + b(t): the Jacobian depends on time alone
  nonlinear,     ///< the Jacobian depends on the state
  unknown        ///< the system does not say
};

}  // namespace hmax
