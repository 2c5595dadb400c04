/// The ends of the spectrum of a distributed structure, by SLEPc [hernandez2005slepc].
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "addons/petsc/petsc_calls.hpp"
#include "limits/distributed/distributed_engine.hpp"

namespace hmax::petsc {

/// Pseudo-random numbers from -1/2 to 1/2, the same for every number of ranks, shape (rows of K).
Vector fixed_vector(Mat K);

/// C += alpha M + beta K.
/// @param lumped  in place of M where it is diagonal
void add_rayleigh(Mat C, double alpha, double beta, Mat K, Mat M, Vec lumped);

/// alpha and beta of C = alpha M + beta K, with the matrices compared in full; nothing where C is no such
/// sum. C loses its rounding, or all there is of it.
/// @param lumped  in place of M where it is diagonal
std::optional<std::pair<double, double>> rayleigh_of(Mat C, Mat K, Mat M, Vec lumped,
                                                     const std::string& file);

/// Iteration for one end of the spectrum of K u = kappa M u, by the type that its mass allows.
Solver solver_for(Mat K, Mat M, EPSWhich which, PetscReal tolerance);

/// u / (u^T M u)^1/2
void normalise(Vec u, Mat M);

/// A negative Ritz value of K u = kappa M u, which the least eigenvalue is not above, after a few restarts:
/// what one that is far from zero takes.
/// @param kappa_max  beside which it is negative
/// @param M          null for I
std::optional<double> negative_end(Mat K, Mat M, std::int64_t unknowns, double kappa_max);

/// Finds the largest kappa of K u = kappa M u, and whether one is far below zero. Collective. Without M by
/// Krylov-Schur iteration; M is never factored: generalised Davidson iteration with its diagonal as a
/// preconditioner.
/// @param M            null for I
/// @param is_positive  whether K is known to have no negative eigenvalue
/// @return  u of kappa_max, u^T M u = 1; no object where K is zero
/// @throws std::runtime_error  where the iteration does not end
Vector find_ends(Mat K, Mat M, bool is_positive, StructureEnds& ends);

}  // namespace hmax::petsc
