/// What an engine on many processes is asked of a model that a user names.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "catalogue/models/body_summary.hpp"
#include "limits/distributed/distributed_engine.hpp"

namespace hmax {

/// Matrices, or a body at rest.
struct DistributedProblem {
  DistributedStructure structure{};
  std::vector<std::pair<std::string, double>> parameters{};  ///< of a body, as Problem has them
  std::optional<BodySummary> body{};
  std::vector<std::string> remarks{};  ///< remarks_on_mesh (catalogue/models/mesh_choice.hpp)
};

/// Each process reads or makes the mesh of a body, which is small beside the matrices.
/// @param id  "fem_green@liver", or that of matrices
/// @throws InputError  as make_tissue_problem (catalogue/models/tissue_problem.hpp), for bodies that pieces
/// do not know, for other models than constant matrices of second order and bodies, and for parameters that
/// matrices do not have
DistributedProblem distributed_problem(const std::string& id, const ProblemSettings& settings);

}  // namespace hmax
