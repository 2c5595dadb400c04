/// Where runs begin that look for the growth of one mode, and how far from rest they are then.
#pragma once

#include "analysis/amplification/amplification.hpp"
#include "core/size_limits.hpp"
#include "limits/modes/structure_start.hpp"
#include "limits/point/operating_point.hpp"

namespace hmax {

/// Near the eigenvalue `wanted`, with a hundredth of everything else. The distance is that in the modes of
/// the model, where it has a full set of them, or in a norm like energy.
/// @param fastest  |lambda| of the fastest mode [1/s]
ModeStart start_from_mode(const Linearised& near, const Eigen::VectorXd& rest, Complex wanted,
                          double fastest);

/// From a displacement x of shape (dofs) that changes its sign in every step h, with the velocity 2 x / h
/// that this takes and a hundredth of its energy in everything else; the distance is in energy. Without
/// velocity strong damping would leave nearly all of it to creep.
ModeStart start_from_shape(const MechanicalPart& part, const Eigen::VectorXd& rest,
                           const Eigen::VectorXd& shape, double h);

/// The shape of a mode of a structure whose motion decouples, u^T M u = 1, shape (dofs).
Eigen::VectorXd shape_of_mode(const Linearised& near, const MechanicalMode& mode);

/// The oscillation of `near` that has an eigenvalue nearest to lambda.
MechanicalMode oscillation_of(const Linearised& near, Complex lambda);

}  // namespace hmax
