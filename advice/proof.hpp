/// What is recommended, run for long: on the motion it was chosen for, and on another.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "advice/motion/motion_run.hpp"
#include "advice/motion/stable_step.hpp"

namespace hmax {

/// One long run at the recommended step.
struct ProofRun {
  std::string motion;                  ///< in words
  double seconds = 0;                  ///< simulated [s]
  bool stable = false;                 ///< it reached the end, and as judged_step()
  bool parts = false;                  ///< StepVerdict::parts
  std::string why;                     ///< where it is not stable
  std::optional<Inversion> inversion;  ///< StepVerdict::inversion
  std::size_t frames = 0, missed = 0;
  std::size_t disturbed = 0;  ///< MotionRun::disturbed
  double frame_p999 = 0;      ///< CPU time that 99.9 % of the frames do not exceed [s]

  /// Stable, and within the budget in 99.9 % of the frames.
  [[nodiscard]] bool holds() const { return stable && !is_late(missed, frames); }
};

/// What is run, and how long.
struct ProofPlan {
  double frame = 0;     ///< [s]
  double budget = 0;    ///< CPU time of a frame [s]
  double cpu = 20;      ///< CPU time of both motions [s], which repeats of late runs stay within
  double seconds = 60;  ///< simulated [s], of each motion
  double slowest = 0;   ///< the slowest frequency of the model [rad/s]; 0: not known
};

/// The probing motion, over and over, and the other motion once, each after a shorter run that judges the
/// step. The first run that does not hold is the last.
/// @param steps_per_frame  the recommended step
std::vector<ProofRun> prove(const Candidate& candidate, std::int64_t steps_per_frame,
                            const ProbingMotion& motion, const ReferenceMotion& reference,
                            const ProofPlan& plan, const Watcher& watcher = {});

}  // namespace hmax
