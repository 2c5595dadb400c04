#include "catalogue/methods/catalogue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/input/suggest.hpp"
#include "catalogue/methods/families.hpp"
#include "catalogue/methods/measured_amplification.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

/// What steps at fixed size and brings no formula shows by its steps how it amplifies.
void measure_amplification(Method& method) {
  if (method.fixed_step && !method.amplification && !method.unsuited)
    method.amplification = shared(measured_amplification(method));
}

std::vector<Method> all_methods() {
  std::vector<Method> all;
  for (const Family& family : all_families) {
    const std::size_t before = all.size();
    family.add(all);
    for (std::size_t i = before; i < all.size(); ++i) all[i].family = family.id;
  }
  for (Method& method : all) measure_amplification(method);
  return all;
}

/// The parameter that all methods of fixed steps have: a step of h is so many of h / substeps.
constexpr const char* substeps = "substeps";

/// The method with steps in equal parts.
Method in_parts(Method method, double parts) {
  if (!(parts >= 1 && parts <= 1e6) || parts != std::floor(parts))
    throw input_error(
        "{0} of {1} is {2} but must be a whole number from 1 to 1000000; write for instance {1}:{0}=4",
        substeps, method.id, to_text(parts));
  const auto part = [parts](RunSpec spec) {
    spec.h /= parts;
    spec.max_steps = static_cast<std::int64_t>(std::min(1e18, static_cast<double>(spec.max_steps) * parts));
    return spec;
  };
  method.part = std::make_shared<const Method>(method);
  method.parts = parts;
  method.bind = [part, parts, whole = method.bind](const Problem& problem) {
    Runner runner = whole(problem);
    runner.run = [part, parts, run = runner.run](const RunSpec& spec, const Sink& sink) {
      if (!sink || spec.every > 0) return run(part(spec), sink);
      // Whole steps are seen, and the end.
      std::int64_t seen = 0;
      return run(part(spec), [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
        if (seen++ % static_cast<std::int64_t>(parts) == 0 || t >= spec.t_end) sink(t, y);
      });
    };
    runner.repeat = [ part, repeat = runner.repeat ](const RunSpec& spec, std::int64_t runs) -> const auto& {
      return repeat(part(spec), runs);
    };
    if (runner.end_state_extended)
      runner.end_state_extended = [parts, end = runner.end_state_extended](double h, double t_end) {
        return end(h / parts, t_end);
      };
    return runner;
  };
  method.error_order = 0;  // adaptive runs choose their steps themselves
  method.amplification.reset();
  if (!method.needs_second_order) measure_amplification(method);
  return method;
}

/// The parameters of a method of the catalogue, with substeps, and the values of "beta=0.25,gamma=0.5".
Parameters parameters_of(const Method& method, std::string_view text) {
  Parameters parameters = method.parameters;
  std::vector<std::string> names;
  for (const auto& [name, value] : parameters) names.push_back(name);
  if (method.fixed_step && std::ranges::find(names, substeps) == names.end()) {
    names.emplace_back(substeps);
    parameters.emplace_back(substeps, 1);
  }
  if (names.empty()) throw input_error("{0} has no parameters, so write it without ':{1}'", method.id, text);
  std::set<std::string_view> given;
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), item.size() + 1));
    const std::string_view name = item.substr(0, item.find('='));
    const auto it = std::ranges::find(parameters, name, [](const auto& entry) { return entry.first; });
    if (it == parameters.end())
      throw input_error("{} has no parameter '{}'; {}", method.id, name, suggestion(name, names));
    const std::optional<double> value =
        name.size() < item.size() ? to_number(item.substr(name.size() + 1)) : std::nullopt;
    if (!value || !std::isfinite(*value))
      throw input_error("'{0}' gives {1} of {2} no finite number; write for instance {2}:{1}={3}", item, name,
                        method.id, to_text(it->second));
    if (!given.insert(name).second)
      throw input_error("{} of {} is given twice; leave one of them out", name, method.id);
    it->second = *value;
  }
  return parameters;
}

/// ":beta=0.25,gamma=0.5"; empty of none.
std::string suffix_of(const Parameters& parameters) {
  std::string suffix;
  for (const auto& [name, value] : parameters)
    suffix += fmt::format("{}{}={}", suffix.empty() ? ":" : ",", name, to_text(value));
  return suffix;
}

/// A method of the catalogue with these values of its own parameters, and of substeps behind them.
Method made_with(const Method& method, const Parameters& parameters) {
  const auto own = static_cast<std::ptrdiff_t>(method.parameters.size());
  Method made = method;
  if (method.with) {
    made = method.with(Parameters(parameters.begin(), parameters.begin() + own));
    made.family = method.family;
    made.with = method.with;
  }
  made.parameters.assign(parameters.begin(), parameters.begin() + own);
  if (std::ssize(parameters) > own && parameters.back().second != 1) {
    made = in_parts(std::move(made), parameters.back().second);
    made.parameters = parameters;
  }
  made.id = method.id + suffix_of(made.parameters);
  return made;
}

}  // namespace

std::string_view to_string(Controllers control) {
  return controller_names.at(static_cast<std::size_t>(control));
}

Controllers controllers_from(std::string_view word) {
  const auto at = std::ranges::find(controller_names, word);
  if (at == controller_names.end())
    throw input_error("unknown control '{}'; {}", word, suggestion(word, controller_names));
  return static_cast<Controllers>(at - controller_names.begin());
}

std::string to_string(JacobianUpdate update) {
  switch (update.every) {
    case JacobianUpdate::automatic:
      return "auto";
    case JacobianUpdate::frozen:
      return "frozen";
    case 1:
      return "exact";
    default:
      return fmt::format("every:{}", update.every);
  }
}

JacobianUpdate jacobian_update_from(std::string_view word) {
  for (const int every : {JacobianUpdate::automatic, JacobianUpdate::frozen, 1})
    if (word == to_string(JacobianUpdate{every})) return {every};
  constexpr std::string_view prefix = "every:";
  if (word.starts_with(prefix)) {
    const std::optional<double> every = to_number(word.substr(prefix.size()));
    if (every && *every >= 1 && *every <= 1e9 && *every == std::floor(*every))
      return {static_cast<int>(*every)};
    throw input_error(
        "'{}' does not say every how many steps the Jacobian is taken; write every:K "
        "with a whole number K of at least 1, for instance every:10",
        word);
  }
  constexpr std::array<std::string_view, 4> policies{"auto", "exact", "every:K", "frozen"};
  throw input_error("unknown Jacobian policy '{}'; {}", word, suggestion(word, policies));
}

std::string to_string(LinearSolve choice) {
  if (choice.by == LinearSolve::By::automatic) return "auto";
  if (choice.by == LinearSolve::By::direct) return "direct";
  std::string text = "cg:" + to_text(choice.tolerance);
  if (choice.iterations > 0) text += fmt::format(",{}", choice.iterations);
  return text;
}

LinearSolve linear_solve_from(std::string_view word) {
  using By = LinearSolve::By;
  if (word == "auto") return {};
  if (word == "direct") return {.by = By::direct};
  LinearSolve choice{.by = By::conjugate_gradients};
  if (word == "cg") return choice;
  constexpr std::string_view prefix = "cg:";
  if (!word.starts_with(prefix)) {
    constexpr std::array<std::string_view, 3> known{"auto", "direct", "cg"};
    throw input_error("unknown linear solver '{}'; {}", word, suggestion(word, known));
  }
  const std::string_view rest = word.substr(prefix.size());
  const std::size_t comma = rest.find(',');
  const std::optional<double> tolerance = to_number(rest.substr(0, comma));
  const std::optional<double> most =
      comma == std::string_view::npos ? std::optional(0.0) : to_number(rest.substr(comma + 1));
  const bool counts =
      most && *most == std::floor(*most) && *most <= 1e9 && (comma == std::string_view::npos || *most >= 1);
  if (!tolerance || !(*tolerance > 0 && *tolerance < 1) || !counts)
    throw input_error(
        "'{}' does not say how far conjugate gradients go; write cg:TOLERANCE with a number above "
        "0 and below 1, or cg:TOLERANCE,ITERATIONS, for instance cg:1e-6 or cg:1e-3,20",
        word);
  choice.tolerance = *tolerance;
  choice.iterations = static_cast<int>(*most);
  return choice;
}

const std::vector<Method>& methods() {
  static const std::vector<Method> all = all_methods();
  return all;
}

Method find_method(std::string_view name) {
  const std::string_view id = name.substr(0, name.find(':'));
  std::vector<std::string> names;
  for (const Method& method : methods()) {
    if (method.id == id || std::ranges::find(method.aliases, id) != method.aliases.end())
      return id.size() == name.size() ? method
                                      : made_with(method, parameters_of(method, name.substr(id.size() + 1)));
    names.push_back(method.id);
    names.insert(names.end(), method.aliases.begin(), method.aliases.end());
  }
  if (const std::string why = why_left_out(id); !why.empty()) throw InputError(why);
  for (const Family& family : all_families)
    if (const ForeignLibrary& library = family.library;
        !library.name.empty() && id.starts_with(library.prefix) &&
        std::ranges::find(methods(), family.id, &Method::family) == methods().end())
      throw input_error(
          "{} is a method of {}, which this build lacks; install the Debian package {}, then "
          "configure and build again",
          id, library.name, library.package);
  throw input_error("unknown method '{}'; {}", id,
                    suggestion(id, names, "`hmax list methods` shows all of them"));
}

Method with_values(const Method& method, const Parameters& changed) {
  Parameters parameters = method.parameters;
  for (const auto& [name, value] : changed)
    if (const auto at = std::ranges::find(parameters, name, &Parameters::value_type::first);
        at != parameters.end())
      at->second = value;
    else
      parameters.emplace_back(name, value);
  return find_method(method.id.substr(0, method.id.find(':')) + suffix_of(parameters));
}

const Family* family_of(const Method& method) {
  const auto* const found = std::ranges::find(all_families, method.family, &Family::id);
  return found == all_families.end() ? nullptr : found;
}

std::vector<std::string> method_families() {
  std::vector<std::string> families;
  for (const Method& method : methods())
    if (std::ranges::find(families, method.family) == families.end()) families.push_back(method.family);
  return families;
}

}  // namespace hmax
