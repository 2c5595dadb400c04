/// Problems of any kind linearised near their equilibrium, at rest, or anywhere.
#pragma once

#include "catalogue/methods/method.hpp"
#include "limits/point/operating_point.hpp"

namespace hmax {

/// Whether nothing loads a body at rest: its forces are nothing beside those that rounding of its points
/// makes.
bool is_at_rest(const TissueBody& body);

/// Whether factors of the matrices of a body take seconds: beyond most_cheaply_factored degrees of freedom.
/// False of other problems.
bool factors_take_seconds(const Problem& problem);

/// A problem near its equilibrium, found by Newton's method from its initial state with time standing still
/// at 0, or for a body at equilibrium_time() (catalogue/models/equilibria/body_balance.hpp); near the initial
/// state itself where there is none, which `status` then says. Above most_cheaply_factored degrees of freedom
/// the equations of a body are solved by conjugate gradients.
/// @param at  rest: a body without displacement, whatever loads it
/// @throws InputError  as linearise()
Linearised linearised(const Problem& problem, AskedState at = AskedState::equilibrium,
                      const EquilibriumWatcher& watcher = {});
/// The same without its modes.
OperatingPoint operating_point(const Problem& problem, AskedState at = AskedState::equilibrium,
                               const EquilibriumWatcher& watcher = {});
LinearModel linear_model(const Problem& problem, double t, const Eigen::VectorXd& y);
/// Near a state of its own.
Linearised linearised(const Problem& problem, double t, const Eigen::VectorXd& y);
OperatingPoint operating_point(const Problem& problem, double t, const Eigen::VectorXd& y);
/// Makes radius_bound and model_at of `point` those of `problem`. Two threads need a point and a problem each
/// where the system has a workspace, as plugins do.
/// @param problem  that of the point, or one that was made as it was
void ask(OperatingPoint& point, const Problem& problem);
/// How much of a direction is small enough for the model to be linear.
struct SmallDisplacement {
  double size = 0;
  bool is_linear = true;  ///< no more than a thousandth of the Jacobian changes
};
/// Of `direction`, shape (dim): the Jacobian changes by less than `most` of itself. About rest at zero
/// nothing is lost by that; elsewhere, and of bodies, it is a thousandth of the first size or more.
SmallDisplacement small_displacement(const Problem& problem, const Linearised& near,
                                     const Eigen::VectorXd& direction, double most);
/// entry_rounding() of a symmetric stiffness; 0 of other models.
double rounding_of_stiffness(const LinearModel& model);
/// All modes, or of large structures those that limits need.
/// @throws InputError  where rates leave the range of numbers, or all modes are asked for and are too many
/// Negative stiffnesses within the rounding of few digits count as zero.
/// @param is_body  of the point of the model
ModeSet mode_set(const LinearModel& model, bool is_body = true);

}  // namespace hmax
