/// A candidate on the probing motion: its error, and the time of each frame.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "advice/motion/candidate.hpp"
#include "advice/motion/probing_motion.hpp"
#include "results/advice_record.hpp"

namespace hmax {

/// One or several runs at one step.
struct MotionRun {
  Outcome outcome = Outcome::reached_end;
  double t = 0;      ///< where it ended [s]
  double error = 0;  ///< the largest of the instants, relative; infinity where it did not reach the end
  /// CPU time of each frame but the first of each run [s]; of frames that were timed three times the middle
  /// one.
  std::vector<double> frames_s;
  double first_frame_s = 0;  ///< with what a simulator does before it starts: its first factors
  std::vector<double> newton,
      linear_iterations;   ///< of Newton's method and of conjugate gradients, in each frame
  std::size_t missed = 0;  ///< of frames_s: more than RunLength::budget
  std::size_t disturbed =
      0;  ///< frames over the budget in the first of three runs, and in none or one of the others
  std::int64_t steps = 0;
  Stats stats;
  std::string note;  ///< why equations were not solved

  [[nodiscard]] bool reached_end() const { return outcome == Outcome::reached_end; }
};

/// The smallest value that a share of all of them does not exceed; NaN of none.
double quantile(std::vector<double> values, double share);

/// Whether a deadline is missed by more than one frame in a thousand. A single late frame may be the
/// machine's.
inline bool is_late(std::size_t missed, std::size_t frames) { return missed > 1 && 1000 * missed > frames; }
/// Whether it is missed by more frames than the machine delays: more than one in twenty.
inline bool is_surely_late(std::size_t missed, std::size_t frames) {
  return is_late(missed, frames) && 20 * missed > frames;
}

/// Order statistics of the time of a frame [s].
struct FrameTimes {
  double p50 = std::numeric_limits<double>::quiet_NaN(), p99 = p50, max = p50;
  /// What the first frame_shares of the frames exceed, as far as they are a frame at least.
  std::vector<double> tail = {};
};
/// NaN of no frames.
FrameTimes frame_times(const std::vector<double>& frames_s);

/// The middle of three times of each frame: what delays one run of a frame and not the others, such as an
/// interrupt, is the machine's.
/// @param runs  of one length
std::vector<double> middle_times(const std::array<std::vector<double>, 3>& runs);

/// How long a motion is run.
struct RunLength {
  std::size_t frames = 1;  ///< again from the start until there are so many
  /// A run that has taken so much for each frame but the first, and for at least five, and a second in all,
  /// ends as Outcome::stopped; also one whose first frame takes 20 s: CPU time [s].
  double most_per_frame = std::numeric_limits<double>::infinity();
  double budget = std::numeric_limits<double>::infinity();  ///< that a frame is late beyond, CPU time [s]
  /// That the run may take together with the two which tell frames that the machine has delayed, CPU time
  /// [s]; 0: there is one run only.
  double with_repeats = 0;
};

/// Runs the motion with `steps_per_frame` steps in each frame; once where it does not reach its end. The
/// thread is kept on its processor. Where frames are late, but not surely, all of it is run twice more as far
/// as RunLength::with_repeats allows: the same steps take the same time but for what the machine does
/// besides.
/// @param frame  [s]
MotionRun run_motion(const Candidate& candidate, const ProbingMotion& motion,
                     const ReferenceMotion& reference, double frame, std::int64_t steps_per_frame,
                     const RunLength& length = {}, const Watcher& watcher = {});

}  // namespace hmax
