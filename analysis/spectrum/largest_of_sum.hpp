/// The one question that limits of structures with general damping ask of their matrices.
#pragma once

#include <functional>

#include <Eigen/Core>

namespace hmax {

/// The largest eigenvalue of a c + b k, c and k the damping and the stiffness in coordinates where the mass
/// is one, and what damps and stiffens its vector x, |x| = 1: gamma = x^T c x [1/s], kappa = x^T k x [1/s^2].
struct LargestOfSum {
  double value = 0, residual = 0;
  double gamma = 0, kappa = 0;
  bool converged = false;
  Eigen::VectorXd vector = {};  ///< x, shape (n); empty where other processes have parts of it
};

/// Finds it to `tolerance` of what a c + b k is at most, by any iteration.
using FindLargestOfSum = std::function<LargestOfSum(double a, double b, double tolerance)>;

}  // namespace hmax
