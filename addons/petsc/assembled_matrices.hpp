/// Matrices whose rows each rank makes by itself.
#pragma once

#include "addons/petsc/petsc_calls.hpp"
#include "limits/distributed/distributed_engine.hpp"

namespace hmax::petsc {

/// K, C without an object where there is none, and the masses.
struct Assembled {
  Matrix K, C;
  Vector mass;
};

/// Collective; each rank makes its rows, some at a time, and no other.
/// @throws std::exception  as the pieces
Assembled assembled(const StructurePieces& pieces);

}  // namespace hmax::petsc
