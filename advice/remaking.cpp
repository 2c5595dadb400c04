#include "advice/remaking.hpp"

#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_parameters.hpp"
#include "catalogue/models/tissue_problem.hpp"

namespace hmax {

Remaking remaking(const std::string& id, const ProblemSettings& settings) {
  Remaking make;
  make.with = [id, settings](const std::vector<std::pair<std::string, double>>& values) {
    ProblemSettings changed = settings;
    for (const auto& value : values) {
      std::erase_if(changed.parameters,
                    [&](const auto& parameter) { return parameter.first == value.first; });
      changed.parameters.push_back(value);
    }
    return make_problem(id, changed);
  };
  if (problem_kind(id) != ProblemKind::body) return make;
  const TissueId body(id);
  const auto on_mesh = [body, settings](const std::string& mesh) {
    return make_problem(tissue_id(body.model, mesh, body.load), settings);
  };
  if (const std::string coarser = coarser_mesh(body.mesh); !coarser.empty())
    make.coarser = [on_mesh, coarser] { return on_mesh(coarser); };
  if (!mended_mesh(body.mesh, 1).empty())
    make.mended = [on_mesh, mesh = body.mesh](int count) { return on_mesh(mended_mesh(mesh, count)); };
  return make;
}

}  // namespace hmax
