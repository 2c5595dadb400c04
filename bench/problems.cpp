/// Problems by name: the oscillators of the study and users' formulas.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/catalogue.hpp"
#include "bench/problem_file.hpp"
#include "bench/suggest.hpp"
#include "problems/formula_system.hpp"
#include "problems/liver_materials.hpp"
#include "problems/liver_problems.hpp"
#include "problems/oscillator_exact.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

template <class Names>
[[noreturn]] void unknown(std::string_view what, std::string_view wrong, const Names& names,
                          std::string_view where) {
  throw InputError(fmt::format("unknown {} '{}'{}; {}", what, wrong, where, suggestion(wrong, names)));
}

void override_start(Problem& problem, const std::vector<double>& y0) {
  if (y0.empty()) return;
  if (y0.size() != problem.states.size())
    throw InputError(fmt::format("--y0 has {} numbers but {} has {} states ({}); give one number for each",
                                 y0.size(), problem.id, problem.states.size(),
                                 fmt::join(problem.states, ", ")));
  for (const double value : y0)
    if (!std::isfinite(value))
      throw InputError(fmt::format("--y0 holds {}, which is not a finite number", to_text(value)));
  problem.y0 = Eigen::Map<const Eigen::VectorXd>(y0.data(), static_cast<Eigen::Index>(y0.size()));
}

Problem oscillator_problem(const LiverProblem& liver, const ProblemSettings& settings) {
  OscillatorParameters parameters = liver.parameters;
  std::vector<std::string> names;
  for (const auto& [name, member] : oscillator_parameter_names) names.emplace_back(name);

  std::string material = settings.material;
  if (material.empty() && liver.id == "liver_benchmark") material = "male_normal";
  if (!material.empty()) {
    std::vector<std::string> ids;
    for (const LiverMaterial& known : liver_materials()) ids.emplace_back(known.id);
    const std::string id = material.substr(0, material.find(':'));
    if (std::ranges::find(ids, id) == ids.end()) unknown("material", id, ids, "");
    parameters = with_material(parameters, material);
  }
  for (const auto& [name, value] : settings.parameters) {
    const auto it =
        std::ranges::find(oscillator_parameter_names, name, [](const auto& entry) { return entry.first; });
    if (it == oscillator_parameter_names.end())
      unknown("parameter", name, names, fmt::format(" of {}", liver.id));
    parameters.*(it->second) = value;
  }
  Problem problem{.id = std::string(liver.id),
                  .material = material,
                  .note = std::string(liver.note),
                  .parameters = {},
                  .states = {"x", "v"},
                  .y0 = liver.y0,
                  .t_end = liver.t_end,
                  .system = Oscillator(parameters),
                  .extended = ExtendedSystem(BasicOscillator<long double>(parameters))};
  for (const auto& [name, member] : oscillator_parameter_names)
    problem.parameters.emplace_back(name, parameters.*member);
  override_start(problem, settings.y0);
  problem.has_exact_solution = exact_solution(parameters, problem.y0).has_value();
  return problem;
}

Problem formula_problem(const std::string& file, const ProblemSettings& settings) {
  FormulaDefinition definition = read_problem(file);
  if (!settings.material.empty())
    throw InputError(
        fmt::format("--material is for the liver oscillators; {} has its own [parameters]", file));
  std::vector<std::string> names;
  for (const auto& [name, value] : definition.parameters) names.push_back(name);
  for (const auto& [name, value] : settings.parameters) {
    const auto it =
        std::ranges::find(definition.parameters, name, [](const auto& entry) { return entry.first; });
    if (it == definition.parameters.end()) unknown("parameter", name, names, fmt::format(" of {}", file));
    it->second = value;
  }
  // An overriding start is put in before the formulas are tried out at it.
  if (settings.y0.size() == definition.y0.size()) definition.y0 = settings.y0;
  FormulaSystem system(std::move(definition));
  const FormulaDefinition& d = system.definition();
  Problem problem{.id = d.name,
                  .material = "",
                  .note = fmt::format("formulas of {}", file),
                  .parameters = d.parameters,
                  .states = {},
                  .y0 = system.y0(),
                  .t_end = d.t_end,
                  .system = Oscillator{}};
  for (const auto& [state, formula] : d.equations) problem.states.push_back(state);
  problem.system = AnySystem(system);
  problem.extended = ExtendedSystem(std::move(system));
  override_start(problem, settings.y0);
  return problem;
}

}  // namespace

std::vector<std::string> problem_ids() {
  std::vector<std::string> ids;
  for (const LiverProblem& problem : liver_problems()) ids.emplace_back(problem.id);
  return ids;
}

Problem make_problem(const std::string& id_or_file, const ProblemSettings& settings) {
  try {
    if (id_or_file.ends_with(".toml")) return formula_problem(id_or_file, settings);
    for (const LiverProblem& problem : liver_problems())
      if (problem.id == id_or_file) return oscillator_problem(problem, settings);
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
  unknown("problem", id_or_file, problem_ids(), " (a file of formulas ends in .toml)");
}

}  // namespace hmax
