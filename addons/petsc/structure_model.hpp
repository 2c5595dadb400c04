/// A distributed structure: read, checked, and its products with vectors.
#pragma once

#include <memory>

#include "limits/distributed/distributed_engine.hpp"

namespace hmax::petsc {

/// Collective. Lumped masses scale K in place. A mass that couples unknowns is divided by with conjugate
/// gradients, preconditioned by its diagonal, to 1e-14.
/// @throws std::runtime_error  as DistributedEngine::read
std::unique_ptr<DistributedModel> read_model(DistributedStructure structure);

}  // namespace hmax::petsc
