/// Limits of matrices, and of bodies at rest, that lie in pieces on many processes: hmax stability predict
/// --engine petsc.
#pragma once

#include <array>
#include <string_view>

#include "cli/shared/choices.hpp"
#include "cli/stability/stability.hpp"
#include "limits/distributed/distributed_engine.hpp"

namespace hmax {

/// What computes eigenvalues: hmax itself, or PETSc with SLEPc.
inline constexpr std::array<std::string_view, 2> engine_names{"hmax", "petsc"};

/// Predicts, verifies where that is asked for, and prints; called by all ranks.
/// @throws InputError  for models other than symmetric matrices and bodies, and where none of the methods can
/// be verified
void print_distributed_limits(DistributedEngine& engine, const ProblemChoice& problem,
                              const MethodsChoice& methods, bool verified, Console& console);

}  // namespace hmax
