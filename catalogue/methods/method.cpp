#include "catalogue/methods/method.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "analysis/amplification/amplification.hpp"
#include "catalogue/methods/unsuited.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "core/size_limits.hpp"
#include "integrators/structural/structural.hpp"

namespace hmax {

namespace {

/// The system of a problem whose mass couples unknowns; null of others.
const AnySystem* with_coupled_mass(const Problem& problem) {
  const auto* any = std::get_if<AnySystem>(&problem.system);
  return any != nullptr && any->dofs() > 0 && !any->mass_matrix().is_diagonal() ? any : nullptr;
}

/// Whether the method solves for the diagonal of the damping alone, and the masses are not lumped.
bool lacks_lumped_masses(const Method& method, const Problem& problem) {
  if (!method.amplification || !method.amplification->motion || method.amplification->motion->lumped.empty())
    return false;
  const AnySystem* const any = with_coupled_mass(problem);
  if (any == nullptr) return false;
  const Eigen::VectorXd q = problem.y0.head(any->dofs()), v = problem.y0.tail(any->dofs());
  AnySystem::DofMatrix C;
  any->damping(0, q, v, C);
  return std::visit([](const auto& held) { return held.norm() > 0; }, C);
}

}  // namespace

std::optional<double> Method::parameter(std::string_view name) const {
  const auto found = std::ranges::find(parameters, name, &Parameters::value_type::first);
  return found == parameters.end() ? std::nullopt : std::optional(found->second);
}

std::string why_unsuited(const Method& method, const Problem& problem) {
  if (method.needs_second_order && !is_second_order(problem))
    return fmt::format("steps positions and velocities, which {} does not have", problem.id);
  if (lacks_lumped_masses(method, problem)) return std::string(needs_lumped_masses);
  if (method.needs_split && !has_split(problem))
    return fmt::format("needs a problem that declares a stiff part, which {} does not", problem.id);
  return method.unsuited ? method.unsuited(problem) : std::string();
}

bool suits(const Method& method, const Problem& problem) { return why_unsuited(method, problem).empty(); }

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

Eigen::VectorXd rhs_of(const Problem& problem, double t, const Eigen::VectorXd& y) {
  return std::visit(
      [&]<class Sys>(const Sys& system) -> Eigen::VectorXd {
        // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): mostly of another type
        typename Sys::State state(y), dydt(y);
        system.rhs(t, state, dydt);
        return dydt;
      },
      problem.system);
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

bool depends_on_past(const Method& method, const Problem& problem) {
  if (method.steps_back > 0 || method.keeps_start) return true;
  switch (method.carried_acceleration) {
    case CarriedAcceleration::none:
      return false;
    case CarriedAcceleration::damped_only:
      return !is_undamped(problem);
    case CarriedAcceleration::always:
      break;
  }
  return true;
}

int order_on(const Method& method, const Problem& problem) {
  return method.order_undamped > 0 && is_undamped(problem) ? method.order_undamped : method.order;
}

namespace {

void expect_positive(double value, std::string_view what, std::string_view remedy) {
  if (!(value > 0) || !std::isfinite(value))
    throw input_error("{} is {} but must be a positive finite number; {}", what, to_text(value), remedy);
}

void check_tolerances(const RunSpec& spec, const Method& method) {
  expect_positive(spec.rtol, "the relative tolerance", "give --rtol, for instance 1e-6");
  expect_positive(spec.atol, "the absolute tolerance", "give --atol, for instance 1e-6");
  if (spec.rtol < 1e-16)
    throw input_error(
        "the relative tolerance {} is below the rounding of double; give --rtol at "
        "least 1e-15",
        to_text(spec.rtol));
  if (!method.adaptive())
    throw input_error(
        "{} has no error estimate and runs only at fixed steps; give --h instead of "
        "--rtol, or choose a method whose error_order in `hmax list methods` is not 0",
        method.id);
}

void check_step(const RunSpec& spec, const Method& method) {
  if (!method.fixed_step)
    throw input_error("{} chooses its steps itself; give --rtol and --atol instead of --h", method.id);
  expect_positive(spec.h, "the step", "give --h in seconds, for instance 0.01");
  if (spec.h > spec.t_end)
    throw input_error("the step of {} s is longer than the whole run of {} s; take a smaller step",
                      to_text(spec.h), to_text(spec.t_end));
  if (spec.t_end / spec.h > static_cast<double>(spec.max_steps))
    throw input_error(
        "a step of {} s to t = {} s would take {:.3g} steps, more than the limit of {}; "
        "take a larger step or raise --max-steps",
        to_text(spec.h), to_text(spec.t_end), spec.t_end / spec.h, spec.max_steps);
}

void check_output_interval(const RunSpec& spec) {
  if (spec.every < 0 || !std::isfinite(spec.every))
    throw input_error("the output interval is {} but must be a positive number of seconds; correct --every",
                      to_text(spec.every));
  if (spec.every > 0 && spec.t_end / spec.every > static_cast<double>(spec.max_steps))
    throw input_error(
        "an output interval of {} s to t = {} s would make {:.3g} points, more than the limit "
        "of {}; take a larger interval or raise --max-steps",
        to_text(spec.every), to_text(spec.t_end), spec.t_end / spec.every, spec.max_steps);
}

/// Throws unless the problem has the structure that the method needs.
void check_structure(const Method& method, const Problem& problem) {
  if (const std::string why = why_unsuited(method, problem); !why.empty()) {
    const bool is_told = why.find(';') != std::string::npos;  // what to do
    throw input_error("{} {}{}", method.id, why,
                      is_told ? ""
                              : fmt::format("; choose another method, or a problem like liver_forced or {}",
                                            method.needs_split ? "spring_chain" : "kepler"));
  }
  if (const AnySystem* const any = with_coupled_mass(problem);
      any != nullptr && method.dense_equations && any->dofs() > most_coupled_masses)
    throw input_error(
        "{} takes M^-1 K as one matrix, which is full, and the mass couples {} unknowns, more than {}; take "
        "another implicit method, or lump the mass matrix",
        method.id, any->dofs(), most_coupled_masses);
}

/// Throws unless the right-hand side is finite at the start.
void check_start(const Problem& problem) {
  const Eigen::VectorXd dydt = rhs_of(problem, 0, problem.y0);
  for (Eigen::Index i = 0; i < dydt.size(); ++i)
    if (!std::isfinite(dydt[i])) {
      if (problem.states.empty())
        throw input_error("the forces on {} are not finite at the start; change its parameters", problem.id);
      throw input_error(
          "the derivative of {} in {} is {} at t = {} and y = ({}); change the initial state or the parameters",
          problem.states[static_cast<std::size_t>(i)], problem.id, to_text(dydt[i]),
          to_text(problem.shown.time(0)), describe(problem.shown.state(problem.y0)));
    }
}

}  // namespace

void check(const RunSpec& spec, const Method& method, const Problem& problem) {
  if (spec.t_end < 0)
    throw input_error(
        "the end time {} lies before the start t = 0; give --t-end a positive number of "
        "seconds",
        to_text(spec.t_end));
  expect_positive(spec.t_end, "the end time", "give --t-end in seconds, for instance 100");
  if (spec.adaptive)
    check_tolerances(spec, method);
  else
    check_step(spec, method);
  check_output_interval(spec);
  check_structure(method, problem);
  check_start(problem);
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

bool is_too_slow(const Method& method, Eigen::Index states) {
  return method.dense_equations && states > most_dense_equations;
}

}  // namespace hmax
