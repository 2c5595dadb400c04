/// The amplification of one-step methods, R(z), from the coefficients that they step with.
#pragma once

#include <cstddef>
#include <span>

#include "analysis/amplification/amplification.hpp"
#include "integrators/explicit/tableau.hpp"
#include "integrators/implicit/imex_tableaux.hpp"
#include "integrators/implicit/rosenbrock_tableau.hpp"

namespace hmax {

/// R(z) = 1 + z b^T (I - z A)^-1 1 [hairer1996solving, IV.3] of an explicit or diagonally implicit tableau.
/// Solved stage by stage: R = N(z) / D(z) with D = prod_i (1 - a_ii z) over the stages that b uses, directly
/// or not, so a polynomial for explicit tableaux. An A-stable R needs deg N <= deg D.
/// @param a      row-major, shape (s, s), lower triangular
/// @param b      shape (s)
/// @param order  of b: so many coefficients of R are those of exp z, which rounding of the tableau hides
Amplification runge_kutta_amplification(std::span<const long double> a, std::span<const long double> b,
                                        int order);

/// The same of a full matrix of at most four stages, R = det(I - z A + z 1 b^T) / det(I - z A).
/// Both determinants are polynomials in z, by the recurrence of Faddeev and LeVerrier.
Amplification full_runge_kutta_amplification(std::span<const long double> a, std::span<const long double> b,
                                             int order);

/// R(z, z0) of a Rosenbrock method in its original variables, whose Jacobian says z0 where f says z; with the
/// exact Jacobian z0 = z:
///   (1 - gamma z0) k_i = z (1 + sum_j alpha_ij k_j) + z0 sum_j gamma_ij k_j,    R = 1 + sum_i b_i k_i.
/// in_z is R(z, z), with the exact Jacobian; with another one of_eigenmode takes z0 = h mode.frozen.
/// [hairer1996solving, IV.7]
/// @param alpha, gamma  row-major, shape (s, s)
Amplification rosenbrock_amplification(std::span<const long double> alpha, std::span<const long double> gamma,
                                       std::span<const long double> b, int order);

/// From a tableau for the transformed stages, which original() turns back into alpha, gamma and b.
template <std::size_t S>
Amplification rosenbrock_amplification(const RosenbrockTableau<S>& tableau, int order) {
  const RosenbrockForm<S> form = original(tableau);
  return rosenbrock_amplification(detail::flattened(form.alpha), detail::flattened(form.gamma), form.b,
                                  order);
}

/// R(z_nonstiff, z_stiff) of an additive pair.
/// in_z and R are those of the implicit half (z_E = 0).
/// The amplification of an implicit-explicit (additive) Runge-Kutta pair on y' = (lambda_E + lambda_I) y:
///   Y_i = 1 + sum_{j < i} (z_E aE_ij + z_I aI_ij) Y_j + z_I aI_ii Y_i,
///   R = 1 + sum_i (z_E bE_i + z_I bI_i) Y_i.
/// @param a_nonstiff  row-major, shape (s, s), strictly lower triangular
/// @param a_stiff     row-major, shape (s, s), lower triangular
Amplification additive_amplification(std::span<const long double> a_nonstiff,
                                     std::span<const long double> b_nonstiff,
                                     std::span<const long double> a_stiff,
                                     std::span<const long double> b_stiff, int order);

/// From the pair of tableaux that the stepper uses.
template <std::size_t S>
Amplification additive_amplification(const AdditiveTableau<S>& tableau, int order) {
  return additive_amplification(detail::flattened(tableau.nonstiff.a), tableau.nonstiff.b,
                                detail::flattened(tableau.stiff.a), tableau.stiff.b, order);
}

}  // namespace hmax
