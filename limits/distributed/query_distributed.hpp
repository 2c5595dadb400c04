/// Questions about the step limits of a structure on many processes.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "catalogue/models/body_summary.hpp"
#include "limits/distributed/distributed_engine.hpp"
#include "limits/query/query_limits.hpp"

namespace hmax {

/// @throws InputError  where none of the methods can be stepped, or one is a formula without code
void require_steps(const std::vector<Method>& methods);

/// As query_limits(), of the one structure that the model is of. Called by all processes together. The facts
/// of the model also tell of the engine: `engine`, `ranks`, `unknowns`, `entries`, `coupled_mass`,
/// `kappa_max`, `residual`, `solver`, `iterations`, `damping`, `gamma_max`, `alpha`, `beta`.
/// @param pair         pair_with_ends() of the model
/// @param body         at rest, where the structure is one
/// @param interrupted  asked at every step of runs; a stop leaves no rows
/// @throws InputError  on all processes
LimitAnswer query_distributed(DistributedEngine& engine, DistributedModel& model, const Problem& pair,
                              const std::optional<BodySummary>& body, const std::vector<Method>& methods,
                              bool verified, const std::function<bool()>& interrupted);

}  // namespace hmax
