/// The motion of a linear mechanical system as the sum of its modes: exact, whatever its size and damping
/// ratio.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "analysis/spectrum/linear_model.hpp"
#include "problems/oscillator/oscillator_exact.hpp"

namespace hmax {

/// M q'' + C q' + K q = f with a constant f and damping that leaves the modes apart, from a given state:
///   q(t) = sum_i s_i a_i(t),   a_i'' + gamma_i a_i' + kappa_i a_i = s_i^T f,   a_i(0) = s_i^T M q(0),
/// with the shapes s_i of mechanical_modes(). The amplitudes are in closed form; what errs are the shapes, by
/// rounding.
class ModalMotion {
 public:
  /// @param part   must decouple
  /// @param force  f, shape (n) [N]
  /// @param y0     (q, v) at t = 0, shape (2 n)
  /// @throws std::invalid_argument  unless part.decouples()
  /// @cost   the eigenproblem of a dense symmetric matrix of n rows
  ModalMotion(const MechanicalPart& part, const Eigen::VectorXd& force, const Eigen::VectorXd& y0);

  /// (q, v) at t, shape (2 n). Costs two products with a dense matrix.
  /// q = S a(t), v = S a'(t) with the shapes as columns of S.
  /// @param t  [s]
  [[nodiscard]] Eigen::VectorXd at(double t) const;

 private:
  Eigen::MatrixXd shapes_;                 ///< S, shape (n, n), S^T M S = I [kg^-1/2]
  std::vector<ExactSolution> amplitudes_;  ///< a_i(t) and a_i'(t), in closed form
};

/// t [s] -> the states of a motion, which `make` computes when the first is asked for.
std::function<Eigen::Vector<long double, Eigen::Dynamic>(long double t)> states_of(
    std::function<ModalMotion()> make);

}  // namespace hmax
