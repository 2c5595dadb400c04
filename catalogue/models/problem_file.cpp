#include "catalogue/models/problem_file.hpp"

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "catalogue/input/suggest.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

const Json& table(const TomlDocument& document, const std::string& key) {
  static const Json none = Json::object();
  return document.root.contains(key) ? document.root.at(key) : none;
}

double number(const TomlDocument& document, const std::string& place, const Json& value) {
  if (!value.is_number())
    document.fail(place, "this must be a number, for instance 1.5 (a decimal point, no quotes)");
  const double x = value.get<double>();
  if (!std::isfinite(x)) document.fail(place, "this number is not finite; give it a finite value");
  return x;
}

/// The names of states under a key of [problem]; none where it is missing.
std::vector<std::string> names(const TomlDocument& document, const Json& problem, const std::string& key) {
  if (!problem.contains(key)) return {};
  std::vector<std::string> found;
  const Json& list = problem.at(key);
  for (const Json& name : list) {
    if (!list.is_array() || !name.is_string()) break;
    found.push_back(name.get<std::string>());
  }
  if (!list.is_array() || found.empty() || found.size() != list.size())
    document.fail("/problem/" + key, "{} must be a list of states in quotes, such as {} = [\"x\", \"y\"]",
                  key, key);
  return found;
}

/// The initial value of each state.
void read_initial(const TomlDocument& document, FormulaDefinition& definition) {
  const Json& initial = table(document, "initial");
  std::vector<std::string> states;
  for (const auto& [state, formula] : definition.equations) states.push_back(state);
  const std::set<std::string> known(states.begin(), states.end());
  std::map<std::string, const Json*> given;  // a table of Json is searched from its beginning
  for (const auto& [name, value] : initial.items()) {
    given[name] = &value;
    if (!known.contains(name))
      document.fail("/initial/" + name, "'{}' has no equation; {}", name,
                    suggestion(name, states, "remove it or add it to [equations]"));
  }
  for (const std::string& state : states) {
    const auto value = given.find(state);
    if (value == given.end())
      document.fail("/initial", "the initial value of '{}' is missing; add it to [initial]", state);
    definition.y0.push_back(number(document, "/initial/" + state, *value->second));
  }
}

}  // namespace

FormulaDefinition problem_from(const TomlDocument& document) {
  constexpr std::array<std::string_view, 4> tables{"problem", "equations", "parameters", "initial"};
  constexpr std::array<std::string_view, 5> settings{"name", "t0", "t_end", "positions", "velocities"};
  reject_unknown_keys(document, "", tables);
  reject_unknown_keys(document, "/problem", settings);
  for (const std::string_view name : {"equations", "parameters", "initial"})
    if (document.root.contains(name) && !document.root.at(std::string(name)).is_object())
      document.fail(fmt::format("/{}", name), "'{}' must be a table: write [{}]", name, name);

  FormulaDefinition definition;
  definition.name = std::filesystem::path(document.name).stem().string();
  const Json& problem = table(document, "problem");
  if (problem.contains("name")) {
    if (!problem.at("name").is_string()) document.fail("/problem/name", "the name must be text in quotes");
    definition.name = problem.at("name").get<std::string>();
  }
  if (problem.contains("t0")) definition.t0 = number(document, "/problem/t0", problem.at("t0"));
  definition.t_end += definition.t0;
  if (problem.contains("t_end")) {
    definition.t_end = number(document, "/problem/t_end", problem.at("t_end"));
    if (!(definition.t_end > definition.t0))
      document.fail(
          "/problem/t_end",
          "t_end is {} but must lie after the start, t0 = {}; give a later time, or the earlier one to "
          "`hmax run --t-end`, which goes backwards",
          to_text(definition.t_end), to_text(definition.t0));
  }
  definition.positions = names(document, problem, "positions");
  definition.velocities = names(document, problem, "velocities");

  const Json& equations = table(document, "equations");
  if (equations.empty())
    document.fail("/equations",
                  "there are no equations; write [equations] with one line for each state, such as "
                  "x = \"v\"");
  for (const auto& [state, formula] : equations.items()) {
    if (!formula.is_string())
      document.fail("/equations/" + state,
                    "the derivative of {} must be a formula in quotes, such as {} = \"-x\"", state, state);
    definition.equations.emplace_back(state, formula.get<std::string>());
  }
  for (const auto& [name, value] : table(document, "parameters").items())
    definition.parameters.emplace_back(name, number(document, "/parameters/" + name, value));

  read_initial(document, definition);
  return definition;
}

FormulaDefinition read_problem(const std::filesystem::path& path) { return problem_from(read_toml(path)); }

}  // namespace hmax
