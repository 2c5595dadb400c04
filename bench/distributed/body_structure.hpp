/// Bodies on meshes for an engine that has their matrices in pieces.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/catalogue/method.hpp"
#include "bench/distributed/distributed_engine.hpp"
#include "bench/models/body_summary.hpp"

namespace hmax {

/// A body at rest and what an engine is asked of it.
struct BodyInPieces {
  DistributedStructure structure;
  std::vector<std::pair<std::string, double>> parameters;  ///< as Problem has them
  BodySummary summary;
  std::vector<std::string> remarks;  ///< remarks_on_points (bench/models/mesh_choice.hpp)
};

/// Each process reads or makes the mesh, which is small beside the matrices.
/// @param id  "fem_green@liver"
/// @throws InputError  as make_tissue_problem (bench/models/tissue_problem.hpp), and for bodies that pieces
/// do not know
BodyInPieces body_in_pieces(const std::string& id, const ProblemSettings& settings);

}  // namespace hmax
