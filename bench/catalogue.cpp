#include "bench/catalogue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/families.hpp"
#include "bench/formulas.hpp"
#include "bench/measured_amplification.hpp"
#include "bench/suggest.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

/// Whose methods a build has only where their library is.
struct ForeignEngine {
  std::string_view prefix, library, package;
  bool present;
};
#if HMAX_HAVE_SUNDIALS
constexpr bool have_sundials = true;
#else
constexpr bool have_sundials = false;
#endif
#if HMAX_HAVE_BOOST
constexpr bool have_boost = true;
#else
constexpr bool have_boost = false;
#endif
constexpr ForeignEngine foreign_engines[]{{"cvode_", "SUNDIALS", "libsundials-dev", have_sundials},
                                          {"arkode_", "SUNDIALS", "libsundials-dev", have_sundials},
                                          {"odeint_", "Boost.Odeint", "libboost-dev", have_boost}};

std::vector<Method> all_methods() {
  std::vector<Method> all;
  add_explicit_rk(all);
  add_adams(all);
  add_diagonally_implicit(all);
  add_radau(all);
  add_stabilised(all);
  add_imex(all);
  add_structural(all);
  add_rosenbrock(all);
  add_sundials(all);
  add_odeint(all);
  // What steps at fixed size and brings no formula shows by its steps how it amplifies.
  for (Method& method : all)
    if (method.fixed_step && !method.amplification)
      method.amplification = shared(measured_amplification(method));
  return all;
}

/// The method with the parameters of "beta=0.25,gamma=0.5".
Method with_parameters(const Method& method, std::string_view text) {
  std::vector<std::string> names;
  for (const auto& [name, value] : method.parameters) names.push_back(name);
  if (names.empty())
    throw InputError(fmt::format("{0} has no parameters, so write it without ':{1}'", method.id, text));
  Parameters parameters = method.parameters;
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), item.size() + 1));
    const std::string_view name = item.substr(0, item.find('='));
    const auto it = std::ranges::find(parameters, name, [](const auto& entry) { return entry.first; });
    if (it == parameters.end())
      throw InputError(fmt::format("{} has no parameter '{}'; {}", method.id, name, suggestion(name, names)));
    const std::optional<double> value =
        name.size() < item.size() ? to_number(item.substr(name.size() + 1)) : std::nullopt;
    if (!value || !std::isfinite(*value))
      throw InputError(fmt::format("'{0}' gives {1} of {2} no finite number; write for instance {2}:{1}={3}",
                                   item, name, method.id, to_text(it->second)));
    it->second = *value;
  }
  Method made = method.with(parameters);
  made.parameters = parameters;
  made.with = method.with;
  std::string suffix;
  for (const auto& [name, value] : parameters)
    suffix += fmt::format("{}{}={}", suffix.empty() ? ":" : ",", name, to_text(value));
  made.id = method.id + suffix;
  return made;
}

}  // namespace

std::string_view to_string(Controllers control) {
  return controller_names.at(static_cast<std::size_t>(control));
}

Controllers controllers_from(std::string_view word) {
  const auto at = std::ranges::find(controller_names, word);
  if (at == controller_names.end())
    throw InputError(fmt::format("unknown control '{}'; {}", word, suggestion(word, controller_names)));
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
    throw InputError(
        fmt::format("'{}' does not say every how many steps the Jacobian is taken; write every:K "
                    "with a whole number K of at least 1, for instance every:10",
                    word));
  }
  constexpr std::array<std::string_view, 4> policies{"auto", "exact", "every:K", "frozen"};
  throw InputError(fmt::format("unknown Jacobian policy '{}'; {}", word, suggestion(word, policies)));
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
    throw InputError(fmt::format("unknown linear solver '{}'; {}", word, suggestion(word, known)));
  }
  const std::string_view rest = word.substr(prefix.size());
  const std::size_t comma = rest.find(',');
  const std::optional<double> tolerance = to_number(rest.substr(0, comma));
  const std::optional<double> most =
      comma == std::string_view::npos ? std::optional(0.0) : to_number(rest.substr(comma + 1));
  const bool counts =
      most && *most == std::floor(*most) && *most <= 1e9 && (comma == std::string_view::npos || *most >= 1);
  if (!tolerance || !(*tolerance > 0 && *tolerance < 1) || !counts)
    throw InputError(fmt::format(
        "'{}' does not say how far conjugate gradients go; write cg:TOLERANCE with a number above "
        "0 and below 1, or cg:TOLERANCE,ITERATIONS, for instance cg:1e-6 or cg:1e-3,20",
        word));
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
      return id.size() == name.size() ? method : with_parameters(method, name.substr(id.size() + 1));
    names.push_back(method.id);
    names.insert(names.end(), method.aliases.begin(), method.aliases.end());
  }
  if (const std::string why = why_left_out(id); !why.empty()) throw InputError(why);
  for (const auto& [prefix, library, package, present] : foreign_engines)
    if (id.starts_with(prefix) && !present)
      throw InputError(
          fmt::format("{} is a method of {}, which this build lacks; install the Debian package {}, then "
                      "configure and build again",
                      id, library, package));
  throw InputError(fmt::format("unknown method '{}'; {}", id,
                               suggestion(id, names, "`hmax list methods` shows all of them")));
}

std::vector<std::string> method_families() {
  std::vector<std::string> families;
  for (const Method& method : methods())
    if (std::ranges::find(families, method.family) == families.end()) families.push_back(method.family);
  return families;
}

bool suits(const Method& method, const Problem& problem) {
  return (!method.needs_second_order || is_second_order(problem)) &&
         (!method.needs_split || has_split(problem));
}

std::vector<Method> choose_methods(const std::vector<std::string>& names,
                                   const std::vector<Problem>& problems) {
  const std::vector<std::string> families = method_families();
  std::vector<Method> chosen;
  for (const std::string& name : with_their_parameters(names)) {
    if (name != "all" && std::ranges::find(families, name) == families.end()) {
      chosen.push_back(find_method(name));
      continue;
    }
    for (const Method& method : methods())
      if ((name == "all" || method.family == name) &&
          std::ranges::all_of(problems, [&](const Problem& problem) { return suits(method, problem); }))
        chosen.push_back(method);
  }
  return chosen;
}

std::string control_of(const Method& method, const RunSpec& spec) {
  if (!spec.adaptive) return "none";
  return method.own_control ? "own" : std::string(to_string(spec.control));
}

bool is_second_order(const Problem& problem) {
  const auto* any = std::get_if<AnySystem>(&problem.system);
  return any == nullptr || any->dofs() > 0;
}

bool has_split(const Problem& problem) {
  const auto* any = std::get_if<AnySystem>(&problem.system);
  return any == nullptr || any->has_split();
}

bool is_undamped(const Problem& problem) {
  if (!is_second_order(problem)) return false;
  return std::visit(
      [&](const auto& system) {
        using State = typename std::remove_cvref_t<decltype(system)>::State;
        const Eigen::Index n = problem.y0.size() / 2;
        State y = problem.y0, still = problem.y0, moving = problem.y0;
        const double size = std::max(0.1, problem.y0.cwiseAbs().maxCoeff());
        for (const double place : {0.0, 0.31, -0.17})
          for (const double speed : {0.7, -1.3, 2.1}) {
            for (Eigen::Index i = 0; i < n; ++i) {
              y[i] = problem.y0[i] + place * size;
              y[n + i] = 0;
            }
            system.rhs(0, y, still);
            // Not all velocities alike: relative ones count too.
            for (Eigen::Index i = 0; i < n; ++i)
              y[n + i] = size * speed * (1 + 0.1 * static_cast<double>(i % 7));
            system.rhs(0, y, moving);
            for (Eigen::Index i = n; i < 2 * n; ++i)
              if (moving[i] != still[i]) return false;
          }
        return true;
      },
      problem.system);
}

int order_on(const Method& method, const Problem& problem) {
  return method.order_undamped > 0 && is_undamped(problem) ? method.order_undamped : method.order;
}

void check(const RunSpec& spec, const Method& method, const Problem& problem) {
  auto positive = [](double value, std::string_view what, std::string_view remedy) {
    if (!(value > 0) || !std::isfinite(value))
      throw InputError(
          fmt::format("{} is {} but must be a positive finite number; {}", what, to_text(value), remedy));
  };
  if (spec.t_end < 0)
    throw InputError(
        fmt::format("the end time {} lies before the start t = 0; give --t-end a positive number of "
                    "seconds",
                    to_text(spec.t_end)));
  positive(spec.t_end, "the end time", "give --t-end in seconds, for instance 100");
  if (spec.adaptive) {
    positive(spec.rtol, "the relative tolerance", "give --rtol, for instance 1e-6");
    positive(spec.atol, "the absolute tolerance", "give --atol, for instance 1e-6");
    if (spec.rtol < 1e-16)
      throw InputError(
          fmt::format("the relative tolerance {} is below the rounding of double; give --rtol at "
                      "least 1e-15",
                      to_text(spec.rtol)));
    if (!method.adaptive())
      throw InputError(
          fmt::format("{} has no error estimate and runs only at fixed steps; give --h instead of "
                      "--rtol, or choose a method whose error_order in `hmax list methods` is not 0",
                      method.id));
  } else {
    if (!method.fixed_step)
      throw InputError(
          fmt::format("{} chooses its steps itself; give --rtol and --atol instead of --h", method.id));
    positive(spec.h, "the step", "give --h in seconds, for instance 0.01");
    if (spec.h > spec.t_end)
      throw InputError(
          fmt::format("the step of {} s is longer than the whole run of {} s; take a smaller step",
                      to_text(spec.h), to_text(spec.t_end)));
    if (spec.t_end / spec.h > static_cast<double>(spec.max_steps))
      throw InputError(
          fmt::format("a step of {} s to t = {} s would take {:.3g} steps, more than the limit of {}; "
                      "take a larger step or raise --max-steps",
                      to_text(spec.h), to_text(spec.t_end), spec.t_end / spec.h, spec.max_steps));
  }
  if (spec.every < 0 || !std::isfinite(spec.every))
    throw InputError(
        fmt::format("the output interval is {} but must be a positive number of seconds; correct --every",
                    to_text(spec.every)));
  if (spec.every > 0 && spec.t_end / spec.every > static_cast<double>(spec.max_steps))
    throw InputError(
        fmt::format("an output interval of {} s to t = {} s would make {:.3g} points, more than the limit "
                    "of {}; take a larger interval or raise --max-steps",
                    to_text(spec.every), to_text(spec.t_end), spec.t_end / spec.every, spec.max_steps));
  if (method.needs_second_order && !is_second_order(problem))
    throw InputError(fmt::format(
        "{} steps positions and velocities, which {} does not have; choose another method, or a problem like "
        "liver_forced or kepler",
        method.id, problem.id));
  if (method.needs_split && !has_split(problem))
    throw InputError(
        fmt::format("{} needs a problem that declares a stiff part, which {} does not; choose another "
                    "method, or a problem like liver_forced or spring_chain",
                    method.id, problem.id));
  std::visit(
      [&](const auto& system) {
        typename std::remove_cvref_t<decltype(system)>::State y = problem.y0, dydt = problem.y0;
        system.rhs(0, y, dydt);
        for (Eigen::Index i = 0; i < dydt.size(); ++i)
          if (!std::isfinite(dydt[i])) {
            if (problem.states.empty())
              throw InputError(fmt::format(
                  "the forces on {} are not finite at the start; change its parameters", problem.id));
            throw InputError(
                fmt::format("the derivative of {} in {} is {} at t = 0 and y = ({}); change the initial "
                            "state or the parameters",
                            problem.states[static_cast<std::size_t>(i)], problem.id, to_text(dydt[i]),
                            describe(problem.y0)));
          }
      },
      problem.system);
}

std::string describe(const std::vector<std::pair<std::string, double>>& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters)
    text += (text.empty() ? "" : " ") + name + "=" + to_text(value);
  return text;
}

std::string describe_acting(const Problem& problem) {
  Parameters acting;
  for (const auto& parameter : problem.parameters)
    if (std::ranges::find(problem.idle, parameter.first) == problem.idle.end()) acting.push_back(parameter);
  return acting.empty() ? "no parameters" : describe(acting);
}

std::string describe(const Eigen::VectorXd& y) {
  std::string text;
  for (const double value : y) {
    if (!text.empty()) text += ',';
    text += to_text(value);
  }
  return text;
}

}  // namespace hmax
