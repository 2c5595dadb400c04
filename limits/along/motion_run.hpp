/// The motion from the initial state that limits are looked for along, to tolerances that follow its size.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "catalogue/methods/method.hpp"
#include "integrators/tolerances.hpp"

namespace hmax {

/// Called from time to time while something long goes on; what it throws ends that.
using Watcher = std::function<void()>;

/// The relative tolerance of motions, and their absolute one as a share of the size of the motion.
inline constexpr Tolerances<double> motion_shares{1e-10, 1e-12};

/// The tolerances of one motion. Positions and velocities differ in their units, and so in their size.
struct MotionTolerances {
  double rtol = motion_shares.rtol;
  double atol = motion_shares.atol;  ///< of positions; of problems that are not mechanical of all states
  double atol_velocities = motion_shares.atol;  ///< the same as `atol` for those
  bool has_velocities = false;                  ///< whether the problem is mechanical
};

/// motion_shares of the largest position and of the largest velocity on the motion from y0 to t_end, by one
/// crude run, or two where the first was weighed by a size far from that. Of a motion that grows by more than
/// a million, a share of a million times its beginning: the end must not hide how it began.
/// @cost  of an undamped motion about a tenth of show_motion(), of one whose steps stability limits the same
MotionTolerances motion_tolerances(const Problem& problem, double t_end, const Watcher& watcher = {});

/// Shows the motion from y0 to t_end by dormand_prince_54 at `points` instants, or where it is 0 after every
/// step.
/// @returns  how many steps were accepted
/// @throws InputError  when t_end is no end of a run, or the motion does not reach it within
/// most_observed_steps attempts
std::int64_t show_motion(const Problem& problem, const MotionTolerances& tolerances, double t_end, int points,
                         const Watcher& watcher, const Sink& show);

/// "rtol 1e-10, atol 1e-12", with both absolute tolerances where they differ.
std::string in_words(const MotionTolerances& tolerances);

}  // namespace hmax
