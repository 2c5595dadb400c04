/// Extended position-based dynamics: implicit Euler by meeting one compliant constraint after the other.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/parallel_for.hpp"
#include "integrators/positional/positional_system.hpp"
#include "integrators/stats.hpp"

namespace hmax {

/// An iteration meets each constraint c once, colour by colour, with its multiplier lambda_c,
///   d_lambda = (-C - a lambda - g dC.(q - q_0)) / ((1 + g) sum_i w_i |dC/dq_i|^2 + a),
///   lambda += d_lambda,   q_i += w_i dC/dq_i d_lambda,
///   a = compliance / h^2,   g = beta / h,   w_i = 1 / (m_i (1 + alpha h)),
/// from where the body would be without elastic forces, with lambda = 0: Gauss-Seidel on the equations of
/// implicit Euler in terms of the multipliers. The gradients are those of the iterate: where they turn within
/// a step, q - q_guess is not the sum of w_i dC/dq_i lambda at its end, and the state it converges to is not
/// that of implicit Euler, the nearer the shorter the step. Multipliers that are reset make the body stiffer
/// with every iteration: each adds the force of a step once more.
/// Position-based dynamics is older and has no compliance: a constraint is met to a share, whatever the
/// material, and the body is the stiffer the more iterations there are and the shorter the step.
/// @source [macklin2016xpbd]; [macklin2021constraint] for the constraints of a stable neo-Hookean solid;
///         [muller2007position] for constraints without compliance
class CompliantConstraints {
 public:
  /// @param reset  multipliers begin at 0 in every iteration
  explicit CompliantConstraints(bool reset = false) : reset_(reset) {}
  /// Without compliance and damping.
  /// @param share  of a constraint that an iteration meets, above 0 and at most 1
  static CompliantConstraints stiff(double share) {
    CompliantConstraints made;
    made.share_ = share;
    return made;
  }

  template <ConstrainedSystem Sys>
  void init(const Sys& system) {
    std::size_t count = 0;
    for (const std::vector<std::int32_t>& colour : system.constraint_colours()) count += colour.size();
    lambda_.setZero(static_cast<Eigen::Index>(count));
    for (Eigen::VectorXd* each : {&start_, &work_, &w_}) each->setZero(system.dofs());
  }

  template <ConstrainedSystem Sys>
  void begin(const Sys& system, double t, double h, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
             Eigen::VectorXd& guess) {
    start_ = q;
    without_elasticity(system, t, h, start_, v, work_, guess);
    lambda_.setZero();
    w_ = (system.mass() * (1 + system.mass_damping() * h)).cwiseInverse();
  }

  template <ConstrainedSystem Sys>
  void improve(const Sys& system, double, double h, Eigen::VectorXd& q, ImplicitWork&) {
    if (reset_) lambda_.setZero();
    const double viscous = share_ ? 0 : system.stiffness_damping() / h;
    for (const std::vector<std::int32_t>& colour : system.constraint_colours()) {
      const auto meet_some = [&](std::size_t begin, std::size_t end) {
        std::array<CompliantConstraint, at_once> at;
        for (std::size_t first = begin; first < end; first += at_once) {
          const auto some = std::span(colour).subspan(first, std::min(at_once, end - first));
          system.constraints(q, some, std::span(at).first(some.size()));
          for (std::size_t i = 0; i < some.size(); ++i) meet(at[i], h, viscous, lambda_[some[i]], q);
        }
      };
      parallel_rows(colour.size(), entries_of_a_constraint * colour.size(), meet_some);
    }
  }

 private:
  /// Constraints that are evaluated before they are met.
  static constexpr std::size_t at_once = 16;
  /// The work of one in entries of a matrix product, for parallel_rows().
  static constexpr std::size_t entries_of_a_constraint = 40;

  /// @param viscous  g
  void meet(const CompliantConstraint& at, double h, double viscous, double& lambda,
            Eigen::VectorXd& q) const {
    const double compliance = share_ ? 0 : at.compliance / (h * h);
    double sum = 0, change = 0;  // sum of w |dC|^2, and dC.(q - q_0)
    for (std::size_t i = 0; i < at.points; ++i) {
      const Eigen::Index first = 3 * static_cast<Eigen::Index>(at.point[i]);
      sum += at.gradient[i].squaredNorm() * w_[first];
      if (viscous > 0) change += at.gradient[i].dot(q.segment<3>(first) - start_.segment<3>(first));
    }
    const double divisor = (1 + viscous) * sum + compliance;
    if (!(divisor > 0)) return;  // nothing that it moves
    const double step = share_.value_or(1) * (-at.value - compliance * lambda - viscous * change) / divisor;
    lambda += step;
    for (std::size_t i = 0; i < at.points; ++i) {
      const Eigen::Index first = 3 * static_cast<Eigen::Index>(at.point[i]);
      q.segment<3>(first) += step * w_[first] * at.gradient[i];
    }
  }

  bool reset_;
  std::optional<double> share_;
  Eigen::VectorXd lambda_;            ///< of each constraint, times h^2
  Eigen::VectorXd start_, work_, w_;  ///< w_ [1/kg]; shape (dofs)
};

}  // namespace hmax
