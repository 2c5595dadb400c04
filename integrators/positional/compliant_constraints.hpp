/// Extended position-based dynamics: implicit Euler by meeting one compliant constraint after the other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/parallel_for.hpp"
#include "integrators/positional/meet_constraint.hpp"
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
  /// The share that an iteration has to meet so that `all` of them meet `stiffness`.
  static double share_of(double stiffness, double all) { return 1 - std::pow(1 - stiffness, 1 / all); }

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
    const MeetingRule rule = meeting_rule(share_, h, system.stiffness_damping());
    for (const std::vector<std::int32_t>& colour : system.constraint_colours()) {
      const auto meet_some = [&](std::size_t begin, std::size_t end) {
        std::array<CompliantConstraint, at_once> at;
        for (std::size_t first = begin; first < end; first += at_once) {
          const auto some = std::span(colour).subspan(first, std::min(at_once, end - first));
          system.constraints(q, some, std::span(at).first(some.size()));
          for (std::size_t i = 0; i < some.size(); ++i)
            meet_constraint(rule, at[i].value, at[i].compliance,
                            Points{at[i], start_.data(), w_.data(), q.data()}, static_cast<int>(at[i].points),
                            lambda_[some[i]]);
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

  /// The points of a constraint, for meet_constraint().
  struct Points {
    const CompliantConstraint& at;
    const double *before, *w;
    double* all;
    [[nodiscard]] std::ptrdiff_t place(int i) const {
      return 3 * std::ptrdiff_t{at.point[static_cast<std::size_t>(i)]};
    }
    [[nodiscard]] static bool moves(int) { return true; }
    [[nodiscard]] const double* gradient(int i) const {
      return at.gradient[static_cast<std::size_t>(i)].data();
    }
    [[nodiscard]] double weight(int i) const { return w[place(i)]; }
    [[nodiscard]] double& q(int i, int axis) const { return all[place(i) + axis]; }
    [[nodiscard]] double start(int i, int axis) const { return before[place(i) + axis]; }
  };

  bool reset_;
  std::optional<double> share_;
  Eigen::VectorXd lambda_;            ///< of each constraint, times h^2
  Eigen::VectorXd start_, work_, w_;  ///< w_ [1/kg]; shape (dofs)
};

}  // namespace hmax
