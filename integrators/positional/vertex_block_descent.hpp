/// Vertex block descent: implicit Euler by moving one point after the other.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "core/parallel_for.hpp"
#include "integrators/positional/move_point.hpp"
#include "integrators/positional/positional_system.hpp"
#include "integrators/stats.hpp"

namespace hmax {

/// An iteration moves each point i once, colour by colour, by one step of Newton's method for its own three
/// equations with all others where they are,
///   H_i dq_i = F_i(t, q, (q - q_0) / h) - m_i (q_i - q_0i - h v_0i) / h^2,
///   H_i = m_i / h^2 + K_ii + C_ii / h:
/// block Gauss-Seidel on the equations of implicit Euler. It begins where the body would be without elastic
/// forces. With 0 < rho < 1 iterations are extrapolated by Chebyshev's weights, of which rho is the guess of
/// the spectral radius of the iteration,
///   q_(k+1) <- w (q_(k+1) - q_(k-1)) + q_(k-1),
///   w_1 = 1,   w_2 = 2 / (2 - rho^2),   w_(k+1) = 4 / (4 - rho^2 w_k).
/// Where H_i is not positive definite its eigenvalues are taken by their amounts.
/// @source [chen2024vertex], [wang2015chebyshev] for the weights
class VertexBlockDescent {
 public:
  explicit VertexBlockDescent(double rho = 0) : rho_(rho) {}

  /// w_k. @param before  w_(k - 1); not read of k = 1 and 2
  static double weight_of(double rho, int k, double before) {
    return k == 1 ? 1 : k == 2 ? 2 / (2 - rho * rho) : 4 / (4 - rho * rho * before);
  }

  template <PointwiseSystem Sys>
  void init(const Sys& system) {
    for (Eigen::VectorXd* each : {&start_, &inertial_, &velocity_, &before_, &last_})
      each->setZero(system.dofs());
  }

  template <PointwiseSystem Sys>
  void begin(const Sys& system, double t, double h, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
             Eigen::VectorXd& guess) {
    start_ = q;
    inertial_ = q + h * v;
    without_elasticity(system, t, h, start_, v, velocity_, guess);
    iteration_ = 0;
  }

  template <PointwiseSystem Sys>
  void improve(const Sys& system, double t, double h, Eigen::VectorXd& q, ImplicitWork&) {
    if (rho_ > 0) last_ = q;
    velocity_ = (q - start_) / h;
    for (const std::vector<std::int32_t>& colour : system.point_colours())
      parallel_rows(colour.size(), entries_of_a_point * colour.size(),
                    [&](std::size_t begin, std::size_t end) {
                      for (std::size_t i = begin; i < end; ++i) move_point(system, t, h, colour[i], q);
                    });
    if (rho_ > 0) extrapolate(q);
  }

 private:
  /// The work of a point in entries of a matrix product, for parallel_rows().
  static constexpr std::size_t entries_of_a_point = 300;

  template <PointwiseSystem Sys>
  void move_point(const Sys& system, double t, double h, std::int32_t point, Eigen::VectorXd& q) {
    const Eigen::Index first = 3 * static_cast<Eigen::Index>(point);
    PointForce at;
    system.point_force(t, q, velocity_, point, at);
    const Eigen::Vector3d away = q.segment<3>(first) - inertial_.segment<3>(first);
    Eigen::Vector3d move;
    move_of_point(system.mass()[first], h, at.f.data(), at.K.data(), at.C.data(), away.data(), move.data());
    q.segment<3>(first) += move;
    velocity_.segment<3>(first) += move / h;
  }

  void extrapolate(Eigen::VectorXd& q) {
    ++iteration_;
    weight_ = weight_of(rho_, iteration_, weight_);
    if (iteration_ > 1) q = weight_ * (q - before_) + before_;
    before_.swap(last_);
  }

  double rho_, weight_ = 1;
  int iteration_ = 0;
  /// Positions at the start, and those of inertia alone; velocities of the iterate; iterates k - 1 and k.
  Eigen::VectorXd start_, inertial_, velocity_, before_, last_;
};

}  // namespace hmax
