#include "bench/catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/bind_explicit_rk.hpp"
#include "bench/suggest.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

std::string suggestion(std::string_view wrong, const std::vector<std::string>& names) {
  const std::string near = did_you_mean(wrong, names);
  return near.empty() ? std::string{} : fmt::format("; did you mean '{}'?", near);
}

/// The line of one explicit Runge-Kutta method: everything else is in its struct.
template <class T>
Method explicit_rk(std::size_t index) {
  Method method{.id = std::string(T::id),
                .aliases = {},
                .family = "explicit_runge_kutta",
                .order = T::order,
                .error_order = T::error_order,
                .stages = static_cast<int>(T::tableau.stages),
                .engine = "hmax",
                .source = std::string(T::source),
                .bind = {}};
  for (const std::string_view alias : tableaux::aliases_of<T>()) method.aliases.emplace_back(alias);
  method.bind = [index](const Problem& problem) {
    return std::visit([&](const auto& system) { return bind_explicit_rk(index, system, problem.y0); },
                      problem.system);
  };
  return method;
}

std::vector<Method> all_methods() {
  std::vector<Method> all;
  [&]<class... T>(std::type_identity<std::tuple<T...>>) {
    (all.push_back(explicit_rk<T>(all.size())), ...);
  }(std::type_identity<tableaux::All>{});
  return all;
}

}  // namespace

std::string_view to_string(Controllers control) {
  switch (control) {
    case Controllers::i:
      return "i";
    case Controllers::pi:
      return "pi";
    case Controllers::deadband:
      return "deadband";
    case Controllers::matlab:
      return "matlab";
  }
  return "unknown";
}

Controllers controllers_from(std::string_view word) {
  for (const Controllers control :
       {Controllers::i, Controllers::pi, Controllers::deadband, Controllers::matlab})
    if (word == to_string(control)) return control;
  throw InputError(fmt::format("unknown control '{}'{}; the controls are i, pi, deadband and matlab", word,
                               suggestion(word, {"i", "pi", "deadband", "matlab"})));
}

const std::vector<Method>& methods() {
  static const std::vector<Method> all = all_methods();
  return all;
}

const Method& find_method(std::string_view id_or_alias) {
  std::vector<std::string> names;
  for (const Method& method : methods()) {
    if (method.id == id_or_alias || std::ranges::find(method.aliases, id_or_alias) != method.aliases.end())
      return method;
    names.push_back(method.id);
    names.insert(names.end(), method.aliases.begin(), method.aliases.end());
  }
  throw InputError(fmt::format("unknown method '{}'{}; `hmax list methods` shows all of them", id_or_alias,
                               suggestion(id_or_alias, names)));
}

Method make_method(const RuntimeTableau& tableau) {
  for (const Method& method : methods())
    if (method.id == tableau.name || std::ranges::find(method.aliases, tableau.name) != method.aliases.end())
      throw InputError(fmt::format(
          "the tableau is called '{}' like a method of hmax; give it a `name` of its own", tableau.name));
  Method method{.id = tableau.name,
                .aliases = {},
                .family = "explicit_runge_kutta",
                .order = tableau.computed_order,
                .error_order = error_order_of(tableau),
                .stages = static_cast<int>(tableau.stages()),
                .engine = "hmax",
                .source = "the user's tableau",
                .bind = {}};
  method.bind = [tableau](const Problem& problem) {
    return std::visit([&](const auto& system) { return bind_explicit_rk(tableau, system, problem.y0); },
                      problem.system);
  };
  return method;
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
  std::visit(
      [&](const auto& system) {
        typename std::remove_cvref_t<decltype(system)>::State y = problem.y0, dydt = problem.y0;
        system.rhs(0, y, dydt);
        for (Eigen::Index i = 0; i < dydt.size(); ++i)
          if (!std::isfinite(dydt[i]))
            throw InputError(
                fmt::format("the derivative of {} in {} is {} at t = 0 and y = ({}); change the initial "
                            "state or the parameters",
                            problem.states[static_cast<std::size_t>(i)], problem.id, to_text(dydt[i]),
                            describe(problem.y0)));
      },
      problem.system);
}

std::string describe(const std::vector<std::pair<std::string, double>>& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters)
    text += (text.empty() ? "" : " ") + name + "=" + to_text(value);
  return text;
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
