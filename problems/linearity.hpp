/// How the right-hand side of a system depends on its state.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace hmax {

/// What is known of f(t, y) from the structure of the system, for every state and time.
enum class Linearity {
  linear,        ///< f = A y + b(t): one constant Jacobian
  time_varying,  ///< f = A(t) y + b(t): the Jacobian depends on time alone
  nonlinear,     ///< the Jacobian depends on the state
  unknown        ///< the system does not say
};

/// "linear", "time_varying", "nonlinear", "unknown".
constexpr std::string_view name_of(Linearity linearity) {
  constexpr std::array<std::string_view, 4> names{"linear", "time_varying", "nonlinear", "unknown"};
  return names[static_cast<std::size_t>(linearity)];
}

/// Whether the Jacobian is a function of time alone, f = A(t) y + b(t).
constexpr bool is_affine(Linearity linearity) {
  return linearity == Linearity::linear || linearity == Linearity::time_varying;
}

}  // namespace hmax
