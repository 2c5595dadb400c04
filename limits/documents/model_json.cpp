#include "limits/documents/model_json.hpp"

#include <cmath>

#include <fmt/format.h>

#include "analysis/step_limits/non_normality.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/tool_report.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/size_limits.hpp"
#include "core/text/sentences.hpp"
#include "limits/documents/number_json.hpp"
#include "limits/kinks.hpp"
#include "limits/modes/fastest_mode.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

using Json = nlohmann::ordered_json;

Json body_json(const Problem& problem) {
  return problem.body ? body_json(summary_of(*problem.body)) : Json();
}

Json body_json(const BodySummary& body) {
  const auto span = [](const BodySummary::Span& of) { return of[0] == of[1] ? Json(of[0]) : Json(of); };
  return {{"E", span(body.young)},
          {"nu", span(body.poisson)},
          {"rho", span(body.density)},
          {"fibre_E", span(body.fibre_young)},
          {"regions", body.regions},
          {"mass", body.mass},
          {"size", {body.size.x(), body.size.y(), body.size.z()}},
          {"points", body.points},
          {"fixed", body.held},
          {"held", body.held},  // the old name
          {"held_by_springs", body.on_springs},
          {"gravity", {body.gravity.x(), body.gravity.y(), body.gravity.z()}},
          {"most_compression_pa", body.most_compression > 0 ? Json(body.most_compression) : Json()},
          {"weight_compression_pa", body.weight_compression},
          {"unusual", unusual_values(body)}};
}

Json suggested_support_json(const std::optional<SuggestedSupport>& suggested) {
  if (!suggested) return nullptr;
  return {{"axis", suggested->axis},
          {"sag", suggested->sag},
          {"axis_now", suggested->axis_now},
          {"sag_now", suggested->sag_now}};
}

Json matrices_json(const Problem& problem) {
  const MatrixModel* model = problem.matrices.get();
  if (!model) return nullptr;
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

Json fastest_mode_json(const Problem& problem, const Linearised& near) {
  const bool gains = problem.body->dofs() <= most_tried_gains;
  const FastestMode mode = fastest_mode_of(*problem.body, near, gains);
  const NamedElement owner = named_element(problem, mode.owner.element);
  const auto bound = [&](double kappa) {
    return Json{{"kappa", kappa}, {"pessimism", std::sqrt(kappa / mode.kappa)}};
  };
  return {{"kappa", mode.kappa},
          {"omega", std::sqrt(mode.kappa)},
          {"residual", mode.residual},
          {"bounds",
           {{"element", bound(mode.bounds.element)},
            {"nodal", bound(mode.bounds.nodal)},
            {"gershgorin", bound(mode.bounds.gershgorin)}}},
          {"element", owner.number},
          {"element_kind", owner.kind},
          {"points", owner.points},
          {"centre", {mode.centre.x(), mode.centre.y(), mode.centre.z()}},
          {"energy_share", mode.owner.share},
          {"elements_with_nine_tenths", mode.owner.elements},
          {"moving_points", mode.owner.moving_points},
          {"gain", gains ? Json{{"without_element", mode.without},
                                {"double_mass", mode.with_mass},
                                {"added_mass", mode.added_mass},
                                {"smoothed", mode.smoothed},
                                {"moved_point",
                                 mode.moved_point ? Json(point_number(problem, *mode.moved_point)) : Json()}}
                         : Json()}};
}

namespace {

void add_spectrum(Json& document, const Linearised& near) {
  Json eigenvalues = Json::array();
  for (const auto& lambda : near.modes.spectrum.lambda) eigenvalues.push_back({lambda.real(), lambda.imag()});
  document["eigenvalues"] = std::move(eigenvalues);
  if (near.modes.curve)
    document["status"] = near.modes.slow_end
                             ? "of the fastest mode; the slowest is not computed, because no limit needs it"
                             : "of the slowest and the fastest mode; all others lie between them";
  if (near.modes.range) document["status"] = "of the fastest modes; damping couples all of them";
  if (near.point.model.y.size() > most_measured_normality) return;
  const Eigen::MatrixXd J = jacobian_in_energy_coordinates(near.point.model);
  const NonNormality normal = non_normality(J);
  document["departure_from_normality"] = normal.departure;
  document["relative_departure"] = normal.relative_departure;
  document["numerical_abscissa"] = normal.numerical_abscissa;
  if (J.rows() <= most_kreiss_states) document["kreiss_constant"] = number_or_word(kreiss_constant(J).value);
}

}  // namespace

Json model_json(const Problem& problem, const Linearised& near, ModelFacts facts) {
  const OperatingPoint& point = near.point;
  Json document{{"problem", problem.id},
                {"material", problem.material},
                {"state", point.state},
                {"state_kind", name_of(point.kind)},
                {"at_equilibrium", point.at_equilibrium},
                {"linearity", name_of(point.linearity)}};
  // Of a body: whether the state is away from rest.
  if (problem.body) document["away_from_rest"] = point.model.y.norm() > 0;
  if (!point.status.empty()) document["state_status"] = point.status;
  if (point.at_kink) document["kink"] = true;
  if (!point.missing.empty()) document["untouched"] = point.missing;
  if (facts == ModelFacts::all) {
    add_spectrum(document, near);
    if (point.model.mechanical) document["damping"] = name_of(point.model.mechanical->damping);
    document["body"] = body_json(problem);
    if (problem.matrices) document["matrices"] = matrices_json(problem);
  }
  if (const auto tool = tool_report(problem, point.model.t, point.model.y)) document["tool"] = tool->json();
  if (problem.body && facts != ModelFacts::state) document["fastest_mode"] = fastest_mode_json(problem, near);
  return document;
}

bool has_limits_along(const Json& model) {
  return model.contains("along") && model["along"].contains("tolerances");
}

std::string status_of_state(const Json& model, const Problem& problem) {
  const bool along = has_limits_along(model);
  const std::string status =
      joined(model.value("state_status", ""), model.value("kink", false) ? at_a_kink : "");
  std::string missing = model.value("untouched", "");
  if (!missing.empty() && !along)
    missing += model.value("state_kind", "") == name_of(StateKind::rest) && status.empty()
                   ? "; leave out --at rest"
                   : "; add --along motion";
  if (missing.empty() && has_moving_load(problem) && !along)
    missing = fmt::format(
        "the load of {} changes with time, and the limits are those of one state; look at the others with --along motion",
        problem.id);
  return joined(status, missing);
}

}  // namespace hmax
