/// Motions of many oscillators at a time, each in a lane of the vector registers. Each is what it is alone,
/// to the last bit.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include <Eigen/Core>

#include "core/instructions/instruction_set.hpp"
#include "integrators/stepper.hpp"
#include "integrators/tolerances.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// A motion from t = 0 on.
struct OscillatorRun {
  const Oscillator* system;
  double t_end;                            ///< [s], positive
  Eigen::Vector2d y;                       ///< its start, then its end
  Outcome outcome = Outcome::reached_end;  ///< how it has ended
};

/// What is run side by side.
struct LaneClient {
  /// The next run, which stays in its place until it has ended; null where there is none, maybe until another
  /// one has ended.
  std::function<OscillatorRun*()> next;
  /// A run has its end and its outcome.
  std::function<void(OscillatorRun& run)> ended;
  /// Whether a run ends, as `stopped`, at a state that is about to be accepted; may be empty.
  std::function<bool(const OscillatorRun& run, const Eigen::Vector2d& y)> is_over = {};
};

/// Runs each as integrate() does with dop_853 and a DeadbandController, with a step control and a time of its
/// own. A lane whose run has ended takes the next one; where there is none it takes that of the last lane, so
/// that those that are left stand side by side.
/// @param most_attempts  of a run, after which it ends as too_many_steps
/// @param steady         no force of any run changes in time: no cosine is computed
/// @param set            of the vector operations; it changes times, not motions
void run_side_by_side(const LaneClient& client, const Tolerances<double>& tolerances,
                      std::int64_t most_attempts, bool steady, InstructionSet set);

/// Runs all of them by the same steps.
using SharedSteps = std::function<void(std::span<OscillatorRun> runs)>;

/// Steps of one size from t = 0 to t_end by a method of tableaux::All; empty where it is no such method. All
/// lanes stand at the same time, so the cosines of the force are computed once, here.
/// @param method  its id
/// @param w       of the forces of all runs [rad/s]
/// @param h       [s], positive
SharedSteps shared_steps(std::string_view method, double w, double t_end, double h, InstructionSet set);

}  // namespace hmax
