/// Problems by name: the oscillators of the study, the test set and users' formulas.
#include "catalogue/models/problems.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/input/suggest.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/problem_file.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "catalogue/plugin/plugin_model.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "problems/formula_motion.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "problems/oscillator/liver_problems.hpp"
#include "problems/oscillator/oscillator_exact.hpp"
#include "problems/test_set/arenstorf.hpp"
#include "problems/test_set/brusselator.hpp"
#include "problems/test_set/dahlquist.hpp"
#include "problems/test_set/hires.hpp"
#include "problems/test_set/kepler.hpp"
#include "problems/test_set/lorenz.hpp"
#include "problems/test_set/oregonator.hpp"
#include "problems/test_set/pleiades.hpp"
#include "problems/test_set/prothero_robinson.hpp"
#include "problems/test_set/robertson.hpp"
#include "problems/test_set/spring_chain.hpp"
#include "problems/test_set/van_der_pol.hpp"

namespace hmax {

namespace {

template <class Names>
[[noreturn]] void unknown(std::string_view what, std::string_view wrong, const Names& names,
                          std::string_view where) {
  throw input_error("unknown {} '{}'{}; {}", what, wrong, where, suggestion(wrong, names));
}

void override_start(Problem& problem, const std::vector<double>& y0) {
  if (y0.empty()) return;
  if (y0.size() != problem.states.size())
    throw input_error("--y0 has {} numbers but {} has {} states ({}); give one number for each", y0.size(),
                      problem.id, problem.states.size(),
                      fmt::join(problem.shown.in_order(problem.states), ", "));
  for (const double value : y0)
    if (!std::isfinite(value))
      throw input_error("--y0 holds {}, which is not a finite number", to_text(value));
  problem.y0 = problem.shown.own_state(
      Eigen::Map<const Eigen::VectorXd>(y0.data(), static_cast<Eigen::Index>(y0.size())));
}

/// Puts the settings into parameters that have names.
template <class P, class Names>
void set_parameters(P& parameters, const Names& names, const ProblemSettings& settings, std::string_view id) {
  std::vector<std::string> known;
  for (const auto& [name, member] : names) known.emplace_back(name);
  for (const auto& [name, value] : settings.parameters) {
    const auto it = std::ranges::find(known, name);
    if (known.empty())
      throw input_error("{} has no parameters to set, so no '{}'; leave --set out", id, name);
    if (it == known.end()) unknown("parameter", name, known, fmt::format(" of {}", id));
    parameters.*(names[static_cast<std::size_t>(it - known.begin())].second) = value;
  }
}

Problem oscillator_problem(const LiverProblem& liver, const ProblemSettings& settings) {
  OscillatorParameters parameters = liver.parameters;

  std::string material = settings.material;
  if (material.empty() && liver.id == "liver_benchmark") material = "male_normal";
  if (!material.empty()) {
    std::vector<std::string> ids;
    for (const LiverMaterial& known : liver_materials()) ids.emplace_back(known.id);
    const std::string id = material.substr(0, material.find(':'));
    if (std::ranges::find(ids, id) == ids.end()) unknown("material", id, ids, "");
    parameters = with_material(parameters, material);
  }
  set_parameters(parameters, oscillator_parameter_names, settings, liver.id);
  Problem problem{.id = std::string(liver.id),
                  .material = material,
                  .note = std::string(liver.note),
                  .states = {"x", "v"},
                  .units = {"m", "m/s"},
                  .y0 = liver.y0,
                  .t_end = liver.t_end,
                  .system = Oscillator(parameters),
                  .extended = ExtendedSystem(BasicOscillator<long double>(parameters))};
  for (const auto& [name, member] : oscillator_parameter_names)
    problem.parameters.emplace_back(name, parameters.*member);
  if (parameters.k3 == 0) problem.idle.emplace_back("k3");
  if (parameters.P == 0) problem.idle.insert(problem.idle.end(), {"P", "w"});
  override_start(problem, settings.y0);
  problem.has_exact_solution = exact_solution(parameters, problem.y0).has_value();
  return problem;
}

/// The problems of the test set, in the order in which they are listed.
template <template <class Real> class... P>
struct Templates {};
using TestSet = Templates<Dahlquist, VanDerPol, Robertson, Hires, Pleiades, Oregonator, Kepler, Arenstorf,
                          Lorenz, Brusselator, ProtheroRobinson, SpringChain>;

template <template <class Real> class P>
Problem test_set_problem(const ProblemSettings& settings) {
  using Wide = P<long double>;
  if (!settings.material.empty())
    throw input_error("--material is for the liver oscillators; {} has parameters of its own", Wide::id);
  typename Wide::Parameters parameters;
  set_parameters(parameters, Wide::Parameters::names, settings, Wide::id);
  const Wide system(parameters);
  Problem problem{.id = std::string(Wide::id),
                  .note = fmt::format("{} [{}]", Wide::note, Wide::source),
                  .states = system.states(),
                  .y0 = system.y0().template cast<double>(),
                  .t_end = Wide::t_end,
                  .stiff = Wide::stiff,
                  .system = AnySystem(P<double>(parameters)),
                  .extended = ExtendedSystem(system)};
  for (const auto& [name, member] : Wide::Parameters::names)
    problem.parameters.emplace_back(name, parameters.*member);
  override_start(problem, settings.y0);
  if constexpr (requires { system.exact(0, system.y0()); }) {
    const typename Wide::State start = problem.y0.template cast<long double>();
    // A start without a closed form (an orbit that is no ellipse, a cubic spring) answers NaN at once.
    if (system.exact(0, start).allFinite()) {
      problem.has_exact_solution = true;
      problem.exact = [system, start](long double t) -> Eigen::Vector<long double, Eigen::Dynamic> {
        return system.exact(t, start);
      };
    }
  }
  return problem;
}

/// Calls visit(id, make) for each problem of the test set.
template <template <class Real> class... P, class Visit>
void each_of(Templates<P...>, const Visit& visit) {
  (visit(P<double>::id, test_set_problem<P>), ...);
}

/// The system of `problem`, which runs in the time that problem.shown has.
/// @tparam Matrix  of its derivatives
template <class Matrix>
void bind_formulas(Problem& problem, const FormulaSystem& system) {
  const auto [t0, direction] = std::pair(problem.shown.t0, problem.shown.direction);
  problem.system = AnySystem(FormulaMotion<Matrix>(system, t0, direction));
  problem.extended = ExtendedSystem(FormulaMotion<Matrix, true>(system, t0, direction));
}

/// Parameters that users change.
void set_parameters(FormulaDefinition& definition, const ProblemSettings& settings, const std::string& file) {
  std::vector<std::string> names;
  for (const auto& [name, value] : definition.parameters) names.push_back(name);
  for (const auto& [name, value] : settings.parameters) {
    const auto it =
        std::ranges::find(definition.parameters, name, [](const auto& entry) { return entry.first; });
    if (it == definition.parameters.end()) unknown("parameter", name, names, fmt::format(" of {}", file));
    it->second = value;
  }
}

/// @param file  for messages
Problem formula_problem(FormulaDefinition definition, const std::string& file,
                        const ProblemSettings& settings) {
  if (!settings.material.empty())
    throw input_error("--material is for the liver oscillators; {} has its own [parameters]", file);
  set_parameters(definition, settings, file);
  definition.t0 = settings.t0.value_or(definition.t0);
  definition.t_end = settings.t_end.value_or(definition.t_end);
  // An overriding start is put in before the formulas are tried out at it.
  if (settings.y0.size() == definition.y0.size()) definition.y0 = settings.y0;
  FormulaSystem system(std::move(definition));
  const FormulaDefinition& d = system.definition();
  Problem problem{.id = d.name,
                  .note = fmt::format("formulas of {}", file),
                  .parameters = d.parameters,
                  .shown = {.t0 = d.t0, .direction = d.t_end < d.t0 ? -1.0 : 1.0, .order = system.order()},
                  .y0 = system.y0(),
                  .t_end = std::abs(d.t_end - d.t0),
                  .system = Oscillator{}};
  for (const Eigen::Index state : system.order())
    problem.states.push_back(d.equations[static_cast<std::size_t>(state)].first);
  if (system.is_sparse())
    bind_formulas<FormulaSystem::SparseMatrix>(problem, std::move(system));
  else
    bind_formulas<Eigen::MatrixXd>(problem, std::move(system));
  override_start(problem, settings.y0);
  return problem;
}

}  // namespace

std::vector<std::string> problem_ids() {
  std::vector<std::string> ids;
  for (const LiverProblem& problem : liver_problems()) ids.emplace_back(problem.id);
  each_of(TestSet{}, [&](std::string_view id, auto) { ids.emplace_back(id); });
  return ids;
}

ProblemKind problem_kind(std::string_view id_or_file) {
  if (id_or_file.starts_with(plugin_prefix)) return ProblemKind::plugin;
  if (id_or_file.starts_with(matrices_prefix)) return ProblemKind::matrices;
  if (id_or_file.ends_with(".toml")) return ProblemKind::formulas;  // in whatever folder
  return id_or_file.find('@') != std::string_view::npos ? ProblemKind::body : ProblemKind::listed;
}

namespace {

Problem made(const std::string& id_or_file, const ProblemSettings& settings) {
  const ProblemKind kind = problem_kind(id_or_file);
  if (settings.t0 && kind != ProblemKind::formulas)
    throw input_error("--t-start is of a file of formulas, FILE.toml; {} starts at 0", id_or_file);
  switch (kind) {
    case ProblemKind::plugin:
      return make_plugin_problem(id_or_file, settings);
    case ProblemKind::matrices:
      return make_matrix_problem(id_or_file, settings);
    case ProblemKind::body:
      return make_tissue_problem(id_or_file, settings);
    case ProblemKind::formulas:
      return formula_problem(read_problem(id_or_file), id_or_file, settings);
    case ProblemKind::listed:
      break;
  }
  for (const LiverProblem& problem : liver_problems())
    if (problem.id == id_or_file) return oscillator_problem(problem, settings);
  std::optional<Problem> found;
  each_of(TestSet{}, [&](std::string_view id, auto make) {
    if (id == id_or_file) found = make(settings);
  });
  if (found) return *found;
  unknown("problem", id_or_file, problem_ids(),
          " (a file of formulas ends in .toml, tissue on a mesh is MODEL@MESH)");
}

}  // namespace

Problem make_problem(const std::string& id_or_file, const ProblemSettings& settings) {
  const auto make = [=] { return told_to_user([&] { return made(id_or_file, settings); }); };
  Problem problem = make();
  problem.again = make;
  return problem;
}

Problem make_problem(const FormulaDefinition& definition, const std::string& file,
                     const ProblemSettings& settings) {
  const auto make = [=] { return formula_problem(definition, file, settings); };
  Problem problem = told_to_user(make);
  problem.again = make;
  return problem;
}

}  // namespace hmax
