#include "cli/stability/distributed_rows.hpp"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "analysis/amplification/amplification.hpp"
#include "bench/distributed/limits_from_ends.hpp"
#include "bench/limits/predict.hpp"
#include "bench/models/matrix_problem.hpp"
#include "bench/rows/limit_rows.hpp"
#include "bench/step_maps/predict_by_steps.hpp"
#include "cli/stability/limit_json.hpp"
#include "cli/stability/limit_words.hpp"
#include "results/errors.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

/// alpha and beta, whether by their options or by --set.
DistributedStructure structure_of(const ProblemChoice& choice) {
  if (choice.own.matrices.empty())
    throw InputError("--engine petsc takes models of --matrices alone; name stiffness and mass, or leave out --engine");
  double alpha = 0, beta = 0;
  for (const auto& [name, value] : choice.settings().parameters) {
    if (name != "alpha" && name != "beta")
      throw InputError(fmt::format("unknown parameter '{}' of matrices; they have alpha and beta", name));
    if (!std::isfinite(value)) throw InputError(fmt::format("{} is {} but must be finite; give a number", name, value));
    (name == "alpha" ? alpha : beta) = value;
  }
  return distributed_structure(matrix_files(choice.id()), alpha, beta);
}

LimitRow row_of(const Method& method, const Linearised& near) {
  Prediction prediction = predict(method, near);
  if (needs_step_map(method, prediction)) {
    prediction.note += "; --engine petsc does not compute limits from steps";
    prediction.bound = Bound::unknown;
  }
  LimitRow row = limit_row(prediction);
  row.details = details_json(prediction).dump();
  return row;
}

Json model_json(const Problem& pair, const Linearised& near, const StructureEnds& ends, const DistributedEngine& engine) {
  Json eigenvalues = Json::array();
  for (const Complex lambda : near.modes.spectrum.lambda) eigenvalues.push_back({lambda.real(), lambda.imag()});
  return {{"problem", pair.id},
          {"state", near.point.state},
          {"state_kind", name_of(near.point.kind)},
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
          {"alpha", ends.alpha},
          {"beta", ends.beta}};
}

std::string words_of(const StructureEnds& ends, const DistributedEngine& engine) {
  return fmt::format("{} unknowns on {} {}, {} entries of stiffness, {}; {}\nfastest mode {:.6g} rad/s, residual {:.1g} ({}, {} restarts)\n",
                     ends.unknowns, engine.ranks(), engine.ranks() == 1 ? "process" : "processes", ends.entries,
                     ends.coupled_mass ? "a mass that couples unknowns" : "a mass for each unknown", engine.version(),
                     std::sqrt(std::max(ends.kappa_max, 0.0)), ends.residual, ends.solver, ends.iterations);
}

}  // namespace

void print_distributed_limits(DistributedEngine& engine, const ProblemChoice& choice, const MethodsChoice& methods,
                              Console& console) {
  const DistributedStructure structure = structure_of(choice);
  // Before minutes are spent on eigenvalues: whatever they are, the methods are the same.
  StructureEnds any;
  any.kappa_max = 1;
  const std::vector<Method> chosen = methods.methods({pair_with_ends(choice.id(), any)});
  const StructureEnds ends = engine.ends(structure);
  const Problem pair = pair_with_ends(choice.id(), ends);
  const Linearised near = linearised(pair, ends);
  std::vector<LimitRow> rows;
  for (const Method& method : chosen) {
    rows.push_back(row_of(method, near));
    rows.back().point.problem = pair.id;
  }
  if (console.json) {
    Json list = Json::array();
    for (const LimitRow& row : rows) list.push_back(to_json(row, {}, pair.parameters));
    console.print_json({{"rows", std::move(list)}, {"models", {model_json(pair, near, ends, engine)}}});
  } else {
    console.print(limit_table(rows, {}, console) + fmt::format("\n{}: {}\n", pair.id, near.point.state) +
                  words_of(ends, engine) + words_of_notes(rows));
  }
  console.flush();
}

}  // namespace hmax
