#include "cli/stability/operating_point.hpp"

#include <array>
#include <atomic>
#include <cmath>

#include <fmt/format.h>

#include "analysis/statics/static_solution.hpp"
#include "catalogue/models/model.hpp"
#include "cli/shared/options.hpp"
#include "cli/stability/row_progress.hpp"
#include "core/errors.hpp"
#include "core/size_limits.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {
constexpr std::array<std::string_view, 2> words{"equilibrium", "rest"};
}  // namespace

void OperatingPointChoice::add_to(CLI::App& command) {
  add_text(command, "--at", at,
           "Operating point of a body on a mesh: equilibrium under its load, or rest, without "
           "displacement; equilibrium by default",
           "rest|equilibrium");
}

AskedState OperatingPointChoice::of(const Problem& problem) const {
  if (at.empty()) return AskedState::equilibrium;
  if (parse_choice("--at", at, words) == words[0]) return AskedState::equilibrium;
  require_body(problem, "and --at rest is for bodies only; remove it");
  return AskedState::rest;
}

void announce_equilibrium(Console& console, const Problem& problem, AskedState at) {
  if (!factors_take_seconds(problem) || at == AskedState::rest || has_moving_load(problem) ||
      is_at_rest(*problem.body))
    return;
  // Measured on balls in their weight of 29,000 to 275,000 degrees of freedom, within a factor of 2: Newton's
  // steps by conjugate gradients, and up to most_factored_often a factor of K that tells whether the
  // equilibrium is stable.
  const auto dofs = static_cast<double>(problem.body->dofs());
  const double factored = dofs <= most_factored_often ? dofs : 0;
  const double seconds = 7.5e-5 * dofs * std::cbrt(dofs / 1e5) + 2.8e-9 * factored * factored;
  const double gigabytes = 3e-6 * dofs + 6.7e-7 * std::pow(factored, 4.0 / 3);
  console.note(fmt::format(
      "the static equilibrium of {} degrees of freedom takes about {:.0f} s and {:.1f} GB; --at rest needs neither",
      problem.body->dofs(), std::ceil(seconds), gigabytes));
}

OperatingPoint operating_point(const Problem& problem, const OperatingPointChoice& choice,
                               const std::string& task, Console& console) {
  const AskedState at = choice.of(problem);
  announce_equilibrium(console, problem, at);
  Progress progress(console, task);
  std::atomic<double> residual = 0;  // before the first
  // From a thread of its own: neither a long step of the search nor the iteration for the fastest mode calls
  // anybody.
  const Ticker ticker(5, [&](int seconds) { progress.update(0, words_of_search(residual, seconds)); });
  return operating_point(problem, at, [&](double found) { residual = found; });
}

}  // namespace hmax
