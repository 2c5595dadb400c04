#include "cli/operating_point.hpp"

#include <array>
#include <cmath>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "problems/tissue/body.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {
constexpr std::array<std::string_view, 2> words{"equilibrium", "rest"};
}  // namespace

void OperatingPointChoice::add_to(CLI::App& command) {
  command
      .add_option("--at", at,
                  "State of a body on a mesh: equilibrium, under its load, by default; rest, without "
                  "displacement, needs no static solution")
      ->type_name("rest|equilibrium");
}

OperatingPoint OperatingPointChoice::of(const Problem& problem) const {
  if (at.empty()) return OperatingPoint::equilibrium;
  if (parse_choice("--at", at, words) == words[0]) return OperatingPoint::equilibrium;
  if (!problem.body)
    throw InputError(
        fmt::format("--at rest applies to bodies on a mesh, and {} is none; remove it", problem.id));
  return OperatingPoint::rest;
}

void announce_equilibrium(Console& console, const Problem& problem, OperatingPoint at) {
  if (!problem.body || at == OperatingPoint::rest || problem.body->dofs() <= most_cheaply_factored ||
      !problem.body->is_autonomous() || is_at_rest(*problem.body))
    return;
  const auto dofs = static_cast<double>(problem.body->dofs());
  console.remark(fmt::format(
      "the static equilibrium of {} degrees of freedom takes about {:.0f} s and {:.1f} GB; --at rest needs neither",
      problem.body->dofs(), std::ceil(1e-4 * dofs * std::cbrt(dofs / 1e5)), 8e-6 * dofs));
}

EquilibriumWatcher shown_in(Progress& progress) {
  return [&progress](double residual) {
    progress.update(0, fmt::format("static equilibrium, residual {:.1e}", residual));
  };
}

}  // namespace hmax
