/// The state of a body that a subcommand asks about: --at rest|equilibrium.
#pragma once

#include <string>

#include "bench/predict.hpp"
#include "cli/console.hpp"

namespace CLI {
class App;
}

namespace hmax {

struct OperatingPointChoice {
  std::string at;

  void add_to(CLI::App& command);
  /// @throws InputError  for an unknown word, or rest of a problem that is no body on a mesh
  [[nodiscard]] OperatingPoint of(const Problem& problem) const;
};

/// Says on standard error what the search for the static equilibrium of a large body will about take; nothing
/// of small bodies and of those at rest.
void announce_equilibrium(Console& console, const Problem& problem, OperatingPoint at);

/// Shows the residual of that search in a line of progress.
/// @param progress  must live as long as what is returned
EquilibriumWatcher shown_in(Progress& progress);

}  // namespace hmax
