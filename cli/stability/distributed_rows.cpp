#include "cli/stability/distributed_rows.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/amplification/amplification.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/stability/limit_answer.hpp"
#include "cli/stability/limit_words.hpp"
#include "core/errors.hpp"
#include "limits/by_steps/predict_by_steps.hpp"
#include "limits/distributed/body_structure.hpp"
#include "limits/distributed/distributed_runs.hpp"
#include "limits/distributed/limits_from_ends.hpp"
#include "limits/documents/limit_json.hpp"
#include "limits/documents/model_json.hpp"
#include "limits/predict.hpp"
#include "limits/rows/limit_rows.hpp"
#include "problems/matrices/exchanged.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

/// What the engine is asked of, and of a body what it is.
struct Asked {
  DistributedStructure structure;
  std::vector<std::pair<std::string, double>> parameters;
  std::optional<BodySummary> body;
  std::vector<std::string> remarks;
};

/// alpha and beta of matrices, whether by their options or by --set; the whole of a body.
Asked asked_of(const ProblemChoice& choice) {
  const std::string id = choice.id();
  if (is_tissue_id(id)) {
    BodyInPieces body = body_in_pieces(id, choice.settings());
    return {.structure = std::move(body.structure),
            .parameters = std::move(body.parameters),
            .body = body.summary,
            .remarks = std::move(body.remarks)};
  }
  if (!is_matrices_id(id))
    throw InputError(
        "--engine petsc takes models of --matrices and --mesh alone; name one, or leave out --engine");
  double alpha = 0, beta = 0;
  for (const auto& [name, value] : choice.settings().parameters) {
    if (name != "alpha" && name != "beta")
      throw InputError(fmt::format("unknown parameter '{}' of matrices; they have alpha and beta", name));
    if (!std::isfinite(value))
      throw InputError(fmt::format("{} is {} but must be finite; give a number", name, value));
    (name == "alpha" ? alpha : beta) = value;
  }
  return {.structure = distributed_structure(matrix_files(id), alpha, beta),
          .parameters = {},
          .body = {},
          .remarks = {}};
}

/// @throws InputError  where none of the methods can be stepped, or one is a formula without code
void require_steps(const std::vector<Method>& methods) {
  const auto is_stepped = [](const Method& method) { return why_not_stepped(method).empty(); };
  const auto formula = std::ranges::find_if(methods, [](const Method& method) { return !method.bind; });
  if (formula == methods.end() && std::ranges::any_of(methods, is_stepped)) return;
  throw InputError(fmt::format("{}; leave out --verify, or name other methods of `hmax list methods`",
                               why_not_stepped(formula == methods.end() ? methods.front() : *formula)));
}

Prediction predicted(const Method& method, const Linearised& near) {
  Prediction prediction = predict(method, near);
  if (needs_step_map(method, prediction)) {
    prediction.note += "; --engine petsc does not compute limits from steps";
    prediction.bound = Bound::unknown;
  }
  return prediction;
}

LimitRow row_of(const Prediction& prediction, bool verified) {
  LimitRow row = limit_row(prediction);
  row.details = details_json(prediction).dump();
  if (verified && row.verdict.empty()) row.verdict = "not_run";
  return row;
}

/// Of all ranks together.
void verify_all(std::vector<Prediction>& rows, const std::vector<Method>& methods, const Linearised& near,
                DistributedEngine& engine, DistributedModel& model) {
  try {
    engine.together([&] {
      for (std::size_t i = 0; i < rows.size(); ++i)
        verify(rows[i], methods[i], near, model, [] { return interrupt_flag().load(); });
    });
  } catch (const RunsInterrupted&) {
    throw Interrupted{};
  }
}

Json model_json(const Problem& pair, const Linearised& near, const StructureEnds& ends,
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

std::string words_of(const StructureEnds& ends, const DistributedEngine& engine) {
  return fmt::format(
      "{} unknowns on {} {}, {} entries of stiffness, {}; {}\nfastest mode {:.6g} rad/s, residual {:.1g} ({}, {} restarts)\n",
      ends.unknowns, engine.ranks(), engine.ranks() == 1 ? "process" : "processes", ends.entries,
      ends.coupled_mass ? "a mass that couples unknowns" : "a mass for each unknown", engine.version(),
      std::sqrt(std::max(ends.kappa_max, 0.0)), ends.residual, ends.solver, ends.iterations);
}

}  // namespace

void print_distributed_limits(DistributedEngine& engine, const ProblemChoice& choice,
                              const MethodsChoice& methods, bool verified, Console& console) {
  Asked asked;
  engine.together([&] { asked = asked_of(choice); });
  for (const std::string& sentence : asked.remarks) console.remark(sentence);
  if (asked.body)
    for (const std::string& sentence : unusual_values(*asked.body)) console.remark(sentence);
  // Before minutes are spent on eigenvalues: whatever they are, the methods are the same.
  StructureEnds any;
  any.kappa_max = 1;
  const std::vector<Method> chosen = methods.methods({pair_with_ends(choice.id(), any)}, console);
  if (verified) require_steps(chosen);
  const std::unique_ptr<DistributedModel> model = engine.read(std::move(asked.structure));
  const StructureEnds& ends = model->ends();
  if (ends.look_exchanged) console.remark(exchanged_matrices);
  Problem pair = pair_with_ends(choice.id(), ends);
  if (asked.body) pair.parameters = asked.parameters;
  pair.material = choice.material;
  Linearised near;
  std::vector<Prediction> predictions;
  engine.together([&] {
    near = linearised(pair, *model, asked.body ? StateKind::rest : StateKind::matrices);
    for (const Method& method : chosen) predictions.push_back(predicted(method, near));
  });
  if (verified) verify_all(predictions, chosen, near, engine, *model);
  std::vector<LimitRow> rows;
  for (const Prediction& prediction : predictions) {
    rows.push_back(row_of(prediction, verified));
    rows.back().point.problem = pair.id;
    rows.back().point.material = pair.material;
  }
  if (verified) judge_runs(rows, console);
  if (console.json) {
    Json list = Json::array();
    for (const LimitRow& row : rows) list.push_back(to_json(row, {}, pair.parameters));
    console.print_json(
        {{"rows", std::move(list)}, {"models", {model_json(pair, near, ends, asked.body, engine)}}});
  } else {
    console.print(limit_table(rows, {.verified = verified, .from_start = false, .path = {}}, console) +
                  fmt::format("\n{}: {}\n", pair.id, near.point.state) +
                  (asked.body ? in_words(*asked.body) + "\n" : "") + words_of(ends, engine) +
                  words_of_notes(rows));
  }
  console.flush();
}

}  // namespace hmax
