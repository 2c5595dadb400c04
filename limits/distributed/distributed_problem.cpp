#include "limits/distributed/distributed_problem.hpp"

#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_choice.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/input_error.hpp"
#include "limits/distributed/limits_from_ends.hpp"
#include "problems/tissue/body_pieces.hpp"

namespace hmax {
namespace {

StructurePieces pieces_of(const std::shared_ptr<const BodyPieces>& body) {
  constexpr int axes = 3;
  const auto point = [](std::int64_t row) { return static_cast<BodyPieces::Index>(row / axes); };
  StructurePieces pieces{.unknowns = body->dofs(), .together = axes, .has_damping = body->has_dampers()};
  pieces.rows = [body, point](std::int64_t begin, std::int64_t end) {
    const BodyPieces::Piece piece = body->piece(point(begin), point(end));
    StructurePieces::Rows rows{.stiffness = matrix_rows(piece.stiffness), .damping = {}, .mass = {}};
    if (body->has_dampers()) rows.damping = matrix_rows(piece.damping);
    rows.mass.assign(piece.mass.begin(), piece.mass.end());
    return rows;
  };
  pieces.lengths = [body, point](std::int64_t begin, std::int64_t end) {
    const BodyPieces::Neighbours counts = body->neighbours(point(begin), point(end));
    StructurePieces::Lengths lengths;
    for (std::size_t i = 0; i < counts.inside.size(); ++i) {
      lengths.inside.insert(lengths.inside.end(), axes, axes * counts.inside[i]);
      lengths.outside.insert(lengths.outside.end(), axes, axes * counts.outside[i]);
    }
    return lengths;
  };
  return pieces;
}

DistributedProblem body_in_pieces(const std::string& name, const ProblemSettings& settings) {
  const TissueId id(name);
  const TissueParameters parameters = tissue_parameters(id, settings);
  LoadedMesh loaded =
      load_mesh_to_renumber(id.mesh, settings.unit, element_nodes(id));  // BodyPieces does that
  TissueSettings made = tissue_settings(id, parameters, loaded);
  if (!made.tools.empty())
    throw InputError(
        "--engine petsc does not take --load tool: it has no contact; leave out --load, or --engine");
  std::vector<std::string> remarks = remarks_on_mesh(loaded.origin->file);
  loaded.origin = nullptr;
  DistributedProblem body{.parameters = named_values(parameters),
                          .body = summary_of(loaded.mesh, made),
                          .remarks = std::move(remarks)};
  const auto pieces =
      told_to_user([&] { return std::make_shared<const BodyPieces>(loaded.mesh, std::move(made)); });
  body.structure.alpha = pieces->alpha();
  body.structure.beta = pieces->beta();
  body.structure.pieces = pieces_of(pieces);
  return body;
}

}  // namespace

DistributedProblem distributed_problem(const std::string& id, const ProblemSettings& settings) {
  const ProblemKind kind = problem_kind(id);
  if (kind == ProblemKind::body) return body_in_pieces(id, settings);
  if (kind != ProblemKind::matrices)
    throw InputError(
        "--engine petsc takes models of --matrices and --mesh alone; name one, or leave out --engine");
  // alpha and beta, whether by their options or by --set.
  double alpha = 0, beta = 0;
  for (const auto& [name, value] : settings.parameters) {
    if (name != "alpha" && name != "beta")
      throw input_error("unknown parameter '{}' of matrices; they have alpha and beta", name);
    if (!std::isfinite(value)) throw input_error("{} is {} but must be finite; give a number", name, value);
    (name == "alpha" ? alpha : beta) = value;
  }
  return {.structure = distributed_structure(matrix_files(id), alpha, beta)};
}

}  // namespace hmax
