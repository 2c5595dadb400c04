#include "cli/bodies/body_words.hpp"

#include <fmt/format.h>

#include "catalogue/models/free_parts.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/mesh_choice.hpp"

namespace hmax {

using Json = nlohmann::ordered_json;

std::string body_in_words(const Problem& problem) {
  if (is_matrices_id(problem.id)) return problem.note;
  return problem.body ? fmt::format("{}\n{}", problem.note, in_words(summary_of(*problem.body))) : "";
}

Json body_json(const Problem& problem) {
  return problem.body ? body_json(summary_of(*problem.body)) : Json();
}

Json body_json(const BodySummary& body) {
  const auto span = [](const BodySummary::Span& of) { return of[0] == of[1] ? Json(of[0]) : Json(of); };
  return {{"E", span(body.young)},
          {"nu", span(body.poisson)},
          {"rho", span(body.density)},
          {"regions", body.regions},
          {"mass", body.mass},
          {"size", {body.size.x(), body.size.y(), body.size.z()}},
          {"points", body.points},
          {"held", body.held},
          {"gravity", {body.gravity.x(), body.gravity.y(), body.gravity.z()}},
          {"unusual", unusual_values(body)}};
}

Json matrices_json(const Problem& problem) {
  if (!is_matrices_id(problem.id)) return nullptr;
  const std::shared_ptr<const MatrixModel> model = matrices_of(problem);
  const MatrixFacts& facts = model->facts;
  const auto file = [](const std::string& name) { return name.empty() ? Json() : Json(name); };
  const auto rows = [](const std::vector<Eigen::Index>& numbers) {
    Json list = Json::array();
    for (const Eigen::Index i : numbers) list.push_back(i + 1);
    return list;
  };
  const std::optional<ModeCounts> counts = mode_counts(*model);
  return {{"stiffness", file(model->files.stiffness)},
          {"mass", file(model->files.mass)},
          {"damping", file(model->files.damping)},
          {"jacobian", file(model->files.jacobian)},
          {"rows", facts.rows},
          {"unknowns", model->size()},
          {"entries", model->is_first_order() ? model->J.nonZeros() : model->K.nonZeros()},
          {"symmetric", facts.symmetric_K && facts.symmetric_C},
          {"mass_sum", model->is_first_order() ? Json() : Json(facts.mass)},
          {"mass_couples", facts.coupled_mass},
          {"massless", facts.massless},
          {"multipliers", facts.multipliers},
          {"redundant_multipliers", rows(facts.redundant)},
          {"times", model->varying ? Json(model->varying->times()) : Json()},
          {"repeated", facts.repeated},
          {"rigid_modes", counts ? Json(counts->rigid) : Json()},
          {"negative_modes", counts ? Json(counts->negative) : Json()},
          {"decoupled_rows", rows(facts.constraints.decoupled)},
          {"penalty_rows", rows(facts.constraints.penalties)},
          {"dropped", facts.dropped}};
}

void remark_unusual(Console& console, const Problem& problem) {
  for (const std::string& sentence : matrix_remarks(problem)) console.remark(sentence);
  if (!problem.body) return;
  if (const MeshOrigin* origin = problem.body->origin().get())
    for (const std::string& sentence : remarks_on_points(origin->file)) console.remark(sentence);
  for (const std::string& sentence : unusual_values(summary_of(*problem.body))) console.remark(sentence);
  // Who holds nothing at all knows that.
  if (!problem.body->settings().supports.empty())
    if (const std::string free = free_parts_in_words(problem); !free.empty()) console.remark(free);
  if (!problem.material.empty() && problem.body->settings().model.is_of_springs())
    console.remark(
        fmt::format("the Poisson's ratio of {} does not act: springs have 1/4 whatever the material says",
                    problem.material));
}

}  // namespace hmax
