/// The ends of the spectrum of a distributed structure, by SLEPc [hernandez2005slepc].
#pragma once

#include "bench/distributed/distributed_engine.hpp"

namespace hmax::petsc {

/// Collective. Lumped masses scale K, whose largest eigenvalue is found by Krylov-Schur iteration; where M couples
/// unknowns it is never factored: generalised Davidson iteration with the diagonal of M as a preconditioner.
/// @throws std::runtime_error  as DistributedEngine::ends
StructureEnds ends_of(const DistributedStructure& structure);

}  // namespace hmax::petsc
