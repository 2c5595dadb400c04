/// The state of a body that a subcommand asks about: --at rest|equilibrium.
#pragma once

#include <atomic>
#include <string>

#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"
#include "cli/stability/row_progress.hpp"
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

/// Shows in a line of progress, from the fifth second on, that the linear model of a large body is being
/// made: the residual of the search for its equilibrium, and the time. From a thread of its own, because
/// neither a long step of that search nor the iteration for the fastest mode calls anybody.
class LinearisationProgress {
 public:
  /// @param progress  is left alone once this has ended
  explicit LinearisationProgress(Progress& progress);

  [[nodiscard]] EquilibriumWatcher watcher() {
    return [this](double residual) { residual_ = residual; };
  }

 private:
  std::atomic<double> residual_ = 0;  ///< 0 before the first
  Ticker ticker_;                     // last: the other must be there
};

}  // namespace hmax
