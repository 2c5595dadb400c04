/// The state of a body that a subcommand asks about: --at rest|equilibrium.
#pragma once

#include <string>

#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"
#include "limits/predict.hpp"

namespace CLI {
class App;
}

namespace hmax {

struct OperatingPointChoice {
  std::string at;

  void add_to(CLI::App& command);
  /// @throws InputError  for an unknown word, or rest of a problem that is no body on a mesh
  [[nodiscard]] AskedState of(const Problem& problem) const;
};

/// Says on standard error what the search for the static equilibrium of a large body will about take; nothing
/// of small bodies and of those at rest.
void announce_equilibrium(Console& console, const Problem& problem, AskedState at);

/// The point that is asked for, announced. A line of progress shows from the fifth second on the residual of
/// the search for the equilibrium of a large body, and the time.
/// @throws InputError  as OperatingPointChoice::of()
OperatingPoint operating_point(const Problem& problem, const OperatingPointChoice& choice,
                               const std::string& task, Console& console);

}  // namespace hmax
