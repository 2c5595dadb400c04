/// Bodies on meshes for an engine that has their matrices in pieces.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "catalogue/methods/method.hpp"
#include "catalogue/models/body_summary.hpp"
#include "limits/distributed/distributed_engine.hpp"

namespace hmax {

/// A body at rest and what an engine is asked of it.
struct BodyInPieces {
  DistributedStructure structure;
  std::vector<std::pair<std::string, double>> parameters;  ///< as Problem has them
  BodySummary summary;
  std::vector<std::string> remarks;  ///< remarks_on_points (catalogue/models/mesh_choice.hpp)
};

/// Each process reads or makes the mesh, which is small beside the matrices.
/// @param id  "fem_green@liver"
/// @throws InputError  as make_tissue_problem (catalogue/models/tissue_problem.hpp), and for bodies that
/// pieces do not know
BodyInPieces body_in_pieces(const std::string& id, const ProblemSettings& settings);

}  // namespace hmax
