/// What methods that move one point, or the points of one constraint, at a time ask of a body.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <span>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/positional.hpp"
#include "integrators/system.hpp"

namespace hmax {

/// A body of points with three displacements each, q of shape (3 points): `mass` has three equal numbers for
/// each. Its forces are elastic, loads that depend on time alone, and -(alpha M + C) v with alpha =
/// mass_damping().
template <class S>
concept PositionalSystem = SecondOrderSystem<S> && std::same_as<typename S::Dofs, Eigen::VectorXd> &&
    requires(const S& system, double t, const Eigen::VectorXd& q, Eigen::VectorXd& out) {
  { system.mass_damping() } -> std::convertible_to<double>;  // alpha [1/s]
  // out = the loads [N] at t, shape (dofs)
  system.loads(t, out);
};

/// A body that tells the force on each of its points.
template <class S>
concept PointwiseSystem = PositionalSystem<S> &&
    requires(const S& system, double t, const Eigen::VectorXd& q, std::int32_t point, PointForce& at) {
  // the order in which points are moved: points of one colour do not act on each other
  { system.point_colours() } -> std::convertible_to<const Colours&>;
  // the rows of `point` of force(t, q, v), and the diagonal blocks of stiffness() and damping()
  system.point_force(t, q, q, point, at);
};

/// A body with a constant estimate of its stiffness that is the same for all axes.
template <class S>
concept WeightedSystem = PositionalSystem<S> && requires(const S& system) {
  // beta of its damping besides alpha M, beta K [s]
  { system.stiffness_damping() } -> std::convertible_to<double>;
  // W, shape (points, points) [N/m], the same one as long as the body is
  { system.weights() } -> std::convertible_to<std::shared_ptr<const Eigen::SparseMatrix<double>>>;
};

/// A body whose elastic energy is that of compliant constraints. Its damping besides alpha M is beta times
/// the stiffness of the constraints, J^T compliance^-1 J.
template <class S>
concept ConstrainedSystem = PositionalSystem<S> &&
    requires(const S& system, const Eigen::VectorXd& q, std::span<const std::int32_t> constraints,
             std::span<CompliantConstraint> at) {
  // constraints of one colour have no point in common
  { system.constraint_colours() } -> std::convertible_to<const Colours&>;
  { system.stiffness_damping() } -> std::convertible_to<double>;  // beta [s]
  // at[i] = constraint number constraints[i]
  system.constraints(q, constraints, at);
};

/// q + (h v + h^2 M^-1 loads) / (1 + alpha h): where a step of implicit Euler to t ends without elastic
/// forces.
/// @param work  shape (dofs)
template <PositionalSystem S>
void without_elasticity(const S& system, double t, double h, const Eigen::VectorXd& q,
                        const Eigen::VectorXd& v, Eigen::VectorXd& work, Eigen::VectorXd& out) {
  system.loads(t, work);
  out.array() = q.array() + (h * v.array() + h * h * work.array() / system.mass().array()) /
                                (1 + system.mass_damping() * h);
}

}  // namespace hmax
