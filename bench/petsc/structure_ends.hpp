/// The ends of the spectrum of a distributed structure, by SLEPc [hernandez2005slepc].
#pragma once

#include <string>
#include <utility>

#include "bench/distributed/distributed_engine.hpp"
#include "bench/petsc/petsc_calls.hpp"

namespace hmax::petsc {

/// Pseudo-random numbers from -1/2 to 1/2, the same for every number of ranks, shape (rows of K).
Vector fixed_vector(Mat K);

/// alpha and beta of C = alpha M + beta K, with the matrices compared in full; C is used up.
/// @param lumped  in place of M where it is diagonal
/// @throws std::runtime_error  where C is no such sum
std::pair<double, double> rayleigh_of(Mat C, Mat K, Mat M, Vec lumped, const std::string& file);

/// Finds the largest kappa of K u = kappa M u, and whether one is far below zero. Collective. Without M by Krylov-Schur
/// iteration; M is never factored: generalised Davidson iteration with its diagonal as a preconditioner.
/// @param M  null for I
/// @return  u of kappa_max, u^T M u = 1; no object where K is zero
/// @throws std::runtime_error  where the iteration does not end
Vector find_ends(Mat K, Mat M, StructureEnds& ends);

}  // namespace hmax::petsc
