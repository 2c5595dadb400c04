/// What linearly implicit methods stand of a Jacobian that is not that of the model any more: the usual state
/// of affairs in real-time simulators, which factor once and step on.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "analysis/amplification/amplification.hpp"
#include "integrators/implicit/rosenbrock_tableau.hpp"

namespace hmax {

/// A Rosenbrock method in its original variables.
struct LinearlyImplicitMethod {
  std::vector<double> alpha, gamma;  ///< row-major, shape (s, s), gamma lower triangular
  std::vector<double> b;             ///< shape (s)
};

template <std::size_t S>
LinearlyImplicitMethod linearly_implicit(const RosenbrockTableau<S>& tableau) {
  const RosenbrockForm<S> form = original(tableau);
  LinearlyImplicitMethod method;
  for (std::size_t i = 0; i < S; ++i) {
    method.b.push_back(static_cast<double>(form.b[i]));
    for (std::size_t j = 0; j < S; ++j) {
      method.alpha.push_back(static_cast<double>(form.alpha[i][j]));
      method.gamma.push_back(static_cast<double>(form.gamma[i][j]));
    }
  }
  return method;
}

/// The map of one step on y' = A y with A0 in place of the Jacobian [hairer1996solving, IV.7]:
///   (I - gamma_ii h A0) K_i = h A (I + sum_j alpha_ij K_j) + h A0 sum_j gamma_ij K_j,
///   S = I + sum_i b_i K_i.
/// Shape (n, n); a step is stable when the spectral radius of S is at most one. K_i is the linear map from
/// y to the i-th stage.
/// @param hA, hA0  h A and h A0, shape (n, n)
Eigen::MatrixXd step_matrix(const LinearlyImplicitMethod& method, const Eigen::MatrixXd& hA,
                            const Eigen::MatrixXd& hA0);

/// Where a stretch of ratios k / k0 or lambda / lambda0 around 1 ends, in which every step is stable; 1
/// itself where all of that side is not.
struct ToleratedRatios {
  double least = 0, most = 0;  ///< most: infinity where a factor of 1e6 is tolerated
};

/// Of decay: y' = lambda y, lambda < 0, with lambda0 as Jacobian. From the conditions of R(z, z0), so proved.
/// With z0 = -h and z = ratio z0 every h > 0 is a step; a ratio is tolerated when none of them is
/// unstable.
ToleratedRatios tolerated_decay(const Amplification& amplification);

/// The largest omega0 h, omega0^2 = k0 / m, up to which every step is stable on an undamped spring of
/// stiffness k whose Jacobian says k0: the first exit found by strides of one part in two hundred from 1e-2
/// to 1e6. Infinity where there is none, 0 where the smallest is unstable.
/// In (x, v / omega0) the model is h A = (0, omega0 h; -ratio omega0 h, 0), the Jacobian the same with
/// ratio 1. A real 2 x 2 map S is stable when |det S| <= 1 and |tr S| <= 1 + det S.
/// @param ratio  k / k0 > 0
double frozen_spring_exit(const LinearlyImplicitMethod& method, double ratio);

/// Of an undamped spring, by those strides.
ToleratedRatios tolerated_stiffness(const LinearlyImplicitMethod& method);
/// The same of one step and every shorter one.
/// @param omega0_h  of that step, > 0
ToleratedRatios tolerated_stiffness(const LinearlyImplicitMethod& method, double omega0_h);

/// The largest omega0 h up to which the map over `steps` steps is stable while the stiffness rises from k0,
/// whose Jacobian is used throughout, in equal parts towards ratio k0, where the Jacobian would be taken
/// anew:
///   k_j = k0 (1 + (ratio - 1) j / steps),  j = 0 .. steps - 1.
/// A stiffness that rises and falls back period after period makes the model itself resonate at some steps: a
/// period is unstable when it amplifies by more than the exact flow does at the worst of them.
double stiffening_exit(const LinearlyImplicitMethod& method, double ratio, int steps);

}  // namespace hmax
