#include "limits/distributed/query_distributed.hpp"

#include <algorithm>

#include "core/input_error.hpp"
#include "limits/by_steps/predict_by_steps.hpp"
#include "limits/distributed/distributed_runs.hpp"
#include "limits/distributed/limits_from_ends.hpp"
#include "limits/documents/limit_json.hpp"
#include "limits/documents/model_json.hpp"
#include "limits/predict.hpp"
#include "limits/rows/limit_rows.hpp"

namespace hmax {
namespace {

using Json = nlohmann::ordered_json;

Prediction predicted(const Method& method, const Linearised& near) {
  Prediction prediction = predict(method, near);
  if (needs_step_map(method, prediction)) {
    prediction.note += "; --engine petsc does not compute limits from steps";
    prediction.bound = Bound::unknown;
  }
  return prediction;
}

Json facts_of(const Problem& pair, const Linearised& near, const StructureEnds& ends,
              const std::optional<BodySummary>& body, const DistributedEngine& engine) {
  Json eigenvalues = Json::array();
  for (const Complex lambda : near.modes.spectrum.lambda)
    eigenvalues.push_back({lambda.real(), lambda.imag()});
  return {{"problem", pair.id},
          {"state", near.point.state},
          {"state_kind", name_of(near.point.kind)},
          {"body", body ? body_json(*body) : Json()},
          {"eigenvalues", std::move(eigenvalues)},
          {"engine", engine.version()},
          {"ranks", engine.ranks()},
          {"unknowns", ends.unknowns},
          {"entries", ends.entries},
          {"coupled_mass", ends.coupled_mass},
          {"kappa_max", ends.kappa_max},
          {"residual", ends.residual},
          {"solver", ends.solver},
          {"iterations", ends.iterations},
          {"damping", ends.general_damping ? "general" : "proportional"},
          {"gamma_max", ends.general_damping ? Json(ends.gamma_max) : Json()},
          {"alpha", ends.alpha},
          {"beta", ends.beta}};
}

}  // namespace

void require_steps(const std::vector<Method>& methods) {
  const auto is_stepped = [](const Method& method) { return why_not_stepped(method).empty(); };
  const auto formula = std::ranges::find_if(methods, [](const Method& method) { return !method.bind; });
  if (formula == methods.end() && std::ranges::any_of(methods, is_stepped)) return;
  throw input_error("{}; leave out --verify, or name other methods of `hmax list methods`",
                    why_not_stepped(formula == methods.end() ? methods.front() : *formula));
}

LimitAnswer query_distributed(DistributedEngine& engine, DistributedModel& model, const Problem& pair,
                              const std::optional<BodySummary>& body, const std::vector<Method>& methods,
                              bool verified, const std::function<bool()>& interrupted) {
  LimitAnswer answer;
  try {
    engine.together([&] {
      const Linearised near = linearised(pair, model, body ? StateKind::rest : StateKind::matrices);
      ModelLimits limits;
      limits.point.key.problem = pair.id;
      limits.point.key.material = pair.material;
      limits.point.document = facts_of(pair, near, model.ends(), body, engine).dump();
      for (const Method& method : methods) {
        Prediction prediction = predicted(method, near);
        if (verified) verify(prediction, method, near, model, interrupted);
        LimitRow row = limit_row(prediction, verified);
        row.details = details_json(prediction).dump();
        row.point = limits.point.key;
        limits.rows.push_back(std::move(row));
      }
      answer.models.push_back(std::move(limits));
    });
  } catch (const RunsInterrupted&) {
    answer.stopped = true;
  }
  return answer;
}

}  // namespace hmax
