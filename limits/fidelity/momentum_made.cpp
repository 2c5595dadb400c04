#include "limits/fidelity/momentum_made.hpp"

#include <Eigen/Geometry>

#include "catalogue/models/tissue_problem.hpp"
#include "limits/by_steps/one_step_map.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// The same tissue without all that acts on it from outside.
Problem let_go(const Problem& problem) {
  return with_settings(problem, [](TissueSettings& settings) {
    settings.gravity.setZero();
    settings.forces.clear();
    settings.supports.clear();
    settings.elastic_supports.clear();
    settings.alpha = settings.beta = 0;
  });
}

}  // namespace

MomentumMade momentum_made(const Method& method, const Problem& problem, const Eigen::VectorXd& q, double h) {
  const Problem free = let_go(problem);
  const TissueBody& body = *free.body;
  const Eigen::Index n = body.dofs();
  Eigen::VectorXd y = Eigen::VectorXd::Zero(2 * n);
  const Eigen::Matrix3Xd moved = problem.body->positions(0, q) - body.mesh().points;
  for (std::size_t i = 0; i < body.free_points().size(); ++i)
    y.segment<3>(3 * static_cast<Eigen::Index>(i)) = moved.col(body.free_points()[i]);
  const Eigen::VectorXd next = one_step_map(method, free, h)(y);
  if (!next.allFinite()) return {};
  const Eigen::VectorXd mass = body.mass()(Eigen::seqN(0, n / 3, 3));
  const Eigen::Matrix3Xd v = next.tail(n).reshaped(3, n / 3),
                         x = body.positions(0, next.head(n))(Eigen::all, body.free_points());
  const Eigen::Vector3d centre = x * mass / mass.sum();
  Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = linear;
  double linear_size = 0, angular_size = 0;
  for (Eigen::Index i = 0; i < v.cols(); ++i) {
    const Eigen::Vector3d p = mass[i] * v.col(i), turn = (x.col(i) - centre).cross(p);
    linear += p;
    angular += turn;
    linear_size += p.norm();
    angular_size += turn.norm();
  }
  return {linear.norm() / linear_size, angular.norm() / angular_size};
}

}  // namespace hmax
