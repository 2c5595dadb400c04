/// Systems whose Jacobian is that of another state: what a method steps that keeps an old one.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "analysis/spectrum/linear_model.hpp"
#include "problems/any_system.hpp"

namespace hmax {

/// f(t, y), written into dydt of shape (n).
using RightHandSide = std::function<void(double t, const Eigen::VectorXd& y, Eigen::VectorXd& dydt)>;

/// y' = f(t, y) with the constant Jacobian of a linear model: with its sparse mass, stiffness and damping
/// where it has these, so that equations are solved as those of bodies, else with its whole Jacobian.
/// @param stiff  the stiff part, whose Jacobian is J_stiff of the model; empty where there is none
AnySystem with_jacobian_of(const LinearModel& model, const RightHandSide& rhs, bool autonomous,
                           const RightHandSide& stiff = {});

/// J (y - y*) of a linear model, for motions y about zero.
RightHandSide linear_part(const LinearModel& model);
/// The same of its stiff part; empty where it has none.
RightHandSide linear_stiff_part(const LinearModel& model);

}  // namespace hmax
