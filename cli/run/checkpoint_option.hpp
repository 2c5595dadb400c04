/// The options --checkpoint and --checkpoint-every of `hmax run`.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bench/timing/run_checkpoint.hpp"
#include "catalogue/methods/method.hpp"
#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"

namespace hmax {

/// What a run is, for the run that is to go on from its checkpoint.
struct CheckpointedRun {
  const Problem& problem;
  const Method& method;
  const RunSpec& spec;
  std::string tableau, output;  ///< files, empty where they are not given
  double every;                 ///< interval of the written points [s]; 0: every step
  std::string jobs;             ///< threads, on which times depend
};

struct CheckpointChoice {
  std::string file;
  std::optional<double> every;

  void add_to(CLI::App& command);
  /// @throws InputError  for an interval without a file or below zero, or another file of the command with
  /// this name
  void check(const std::string& output, const std::string& picture) const;
  /// Null where no file is given. Says on standard error where the run goes on.
  /// @param stop  what ends the run; null only where no file is given
  /// @throws InputError  see RunCheckpoint
  [[nodiscard]] std::unique_ptr<RunCheckpoint> open(const CheckpointedRun& run, const StopFlag* stop,
                                                    Console& console) const;
};

/// Names of the runs of a command in its checkpoint: the one that is reported, and the one whose points are
/// written.
inline constexpr const char* reported_part = "run";
inline constexpr const char* output_part = "output";

/// What to say of a method whose state cannot be saved.
std::string without_checkpoints(const Method& method);

}  // namespace hmax
