/// Methods as simulators run them.
#pragma once

#include <string>
#include <vector>

#include "catalogue/methods/method.hpp"

namespace hmax {

/// A method with the choices that a simulator makes besides the step.
struct Candidate {
  Method method;
  JacobianUpdate jacobian{};   ///< read by methods that linearise
  LinearSolve linear_solve{};  ///< of the equations of bodies

  /// A run at fixed steps.
  [[nodiscard]] RunSpec spec(double h, double t_end) const;
  /// What is chosen besides the method and its step: "Jacobian frozen, direct"; empty where there is nothing.
  [[nodiscard]] std::string options() const;
  /// "rk4", "linearly_implicit_euler, Jacobian frozen, direct"
  [[nodiscard]] std::string words() const;
};

/// Ids of the methods that are tried where nobody names some: one or more of each family that simulators use.
std::vector<std::string> simulator_methods();

/// Why a method is not tried: "chooses its steps itself, and frames need fixed steps"; empty where it is.
std::string why_no_candidate(const Method& method, const Problem& problem);

/// Every method with every choice that it has on this problem: of those that solve one linear system a step,
/// the Jacobian exact, of every tenth step and frozen, and on bodies conjugate gradients of at most 20
/// iterations beside a factorisation. Methods of why_no_candidate()
/// are left out.
std::vector<Candidate> candidates(const std::vector<Method>& methods, const Problem& problem);

}  // namespace hmax
