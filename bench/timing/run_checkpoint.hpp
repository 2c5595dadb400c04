/// Runs that are saved to a file now and then, and go on from it with the same bits.
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catalogue/methods/run.hpp"
#include "core/checkpoint_file.hpp"
#include "integrators/saved_state.hpp"

namespace hmax {

/// Who sees the points of a run, and what that records of them; all empty where nobody watches.
struct KeptOutput {
  Sink sink;
  std::function<void(StateVisitor&)> visit;
};

/// @param members  what the sink changes; they must outlive the run
template <class... Members>
KeptOutput kept_output(Sink sink, Members&... members) {
  return {std::move(sink), [&](StateVisitor& visit) { visit(members...); }};
}

struct CheckpointOptions {
  std::filesystem::path file;
  double every = 60;             ///< between two savings [s], of the clock on the wall; 0: after each step
  std::vector<RunFact> facts{};  ///< what has to be the same for a run to go on
  std::function<bool()> stop{};  ///< asked after each step: save and end by InterruptedRun
  std::function<void(double t)> progress{};          ///< called about every millisecond
  std::function<void(const std::string&)> remark{};  ///< where saving fails, which ends no run
};

/// A run was saved because somebody has asked it to stop.
struct InterruptedRun {
  double t;  ///< where it goes on [s]
};

/// A run and its times, those of earlier processes included [s].
struct CountedRun {
  RunRecord record;
  double cpu_seconds, elapsed_seconds;
};

/// The runs of one command in one file. Each has a name; what is finished is told at once.
class RunCheckpoint {
 public:
  /// Locks the file, removes what a killed process has left of it, and reads it where there is one.
  /// @throws InputError  where it cannot be read or written, is in use by another process, is damaged, or
  /// differs in a fact, which is named
  explicit RunCheckpoint(CheckpointOptions options);

  /// Runs, goes on with, or recalls the run `name`. The record must not outlive this object.
  /// @throws InterruptedRun  where it was stopped;  StateNotSaved  (catalogue/methods/kept_sink.hpp)
  CountedRun run(const std::string& name, const Runner& runner, const RunSpec& spec,
                 const KeptOutput& output = {});

  /// What the file holds of a run: where it goes on, or a negative number of one that has not begun.
  [[nodiscard]] double resumes_at(std::string_view name) const;
  [[nodiscard]] bool has_finished(std::string_view name) const;

 private:
  class Keeper;
  /// One run as the file holds it.
  struct Part {
    std::string name;
    bool finished = false;
    double t = 0, cpu_seconds = 0, elapsed_seconds = 0;
    std::string state{}, output{};  ///< bytes of the run under way, and of its KeptOutput
    RunRecord record{};             ///< of a finished run
    std::string note{};             ///< what its `note` refers to

    void visit_state(auto& visit) {
      Stats& s = record.stats;
      visit(name, finished, t, cpu_seconds, elapsed_seconds, state, output, note);
      visit(record.outcome, record.t, record.y, record.t_state);
      visit(s.steps, s.rejected, s.rhs, s.jacobian, s.factorisations, s.newton, s.linear_iterations,
            s.newton_error);
    }
  };

  void read();
  [[nodiscard]] const Part* find(std::string_view name) const;
  Part& part_of(const std::string& name);
  /// @returns why it could not be written; empty when it was
  std::string write();

  CheckpointOptions options_;
  std::optional<CheckpointLock> lock_;
  std::deque<Part> parts_;  ///< whose places in memory stay
};

}  // namespace hmax
