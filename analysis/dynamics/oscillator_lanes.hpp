/// Motions of many oscillators at a time, each in a lane of the vector registers. Each is what it is alone,
/// to the last bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include <Eigen/Core>

#include "core/instruction_set.hpp"
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

/// Runs all of them as integrate() does with dop_853 and a DeadbandController. A lane whose run has ended
/// takes the next one; where there is none it takes that of the last lane, so that those that are left stand
/// side by side. Each lane has a step control and a time of its own. Where no force changes in time no cosine
/// is computed.
/// @param most_attempts  of a run, after which it ends as too_many_steps
/// @param is_over        of a state of run i that is about to be accepted: whether the run ends there, as
///                       `stopped`; may be empty
/// @param set            of the vector operations; it changes times, not motions
void run_side_by_side(std::span<OscillatorRun> runs, const Tolerances<double>& tolerances,
                      std::int64_t most_attempts,
                      const std::function<bool(std::size_t i, const Eigen::Vector2d& y)>& is_over,
                      InstructionSet set);

/// Runs all of them by the same steps.
using SharedSteps = std::function<void(std::span<OscillatorRun> runs)>;

/// Steps of one size from t = 0 to t_end by a method of tableaux::All; empty where it is no such method. All
/// lanes stand at the same time, so the cosines of the force are computed once, here.
/// @param method  its id
/// @param w       of the forces of all runs [rad/s]
/// @param h       [s], positive
SharedSteps shared_steps(std::string_view method, double w, double t_end, double h, InstructionSet set);

}  // namespace hmax
