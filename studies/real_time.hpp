/// What simulators get from a method on a frame's time: a body pressed, held, released and grasped.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "advice/motion/candidate.hpp"
#include "results/json.hpp"

namespace hmax {

struct RealTimeQuestion {
  std::string body = "liver", material = "liver:male_normal";  ///< of fem_neo_hookean
  std::vector<double> rates{60, 100, 1000};                    ///< frames a second [Hz]
  std::size_t frames = 300;                                    ///< that are timed
  double ceilings_up_to = 100;  ///< they are sought at rates up to this one [Hz]
};

/// One method at one rate. The body is pressed, held and released, and then pulled, as advise does it.
struct RealTimeRow {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  double rate = 0;  ///< [Hz]
  std::string method, family{};
  std::int64_t steps = 1;  ///< in a frame; of explicit methods as many as hold both motions
  double error_pressed = none, error_grasped = none;  ///< of the motion, relative to its largest displacement
  double frame_p99 = none;                            ///< CPU time of a frame [s]
  std::size_t frames = 0, missed = 0;                 ///< frames that were timed, those over 1 / rate
  double stiffness_shown = none;                      ///< as Fidelity has them, pressed
  double stiffness_ceiling = none;                    ///< [Pa]
  double damping_added = none;                        ///< to the damping ratio of the slowest mode
  double frequency_shift = none;                      ///< relative, of that mode
  std::string status{};
};
HMAX_RECORD(RealTimeRow, rate, method, family, steps, error_pressed, error_grasped, frame_p99, frames, missed,
            stiffness_shown, stiffness_ceiling, damping_added, frequency_shift, status);

/// Settings that simulators use, of six families.
std::vector<Candidate> real_time_candidates();

/// A row for each rate and candidate, in this order.
/// @param progress  told the share that is done and what comes next; may throw to stop
std::vector<RealTimeRow> real_time_study(const RealTimeQuestion& question,
                                         const std::vector<Candidate>& candidates,
                                         const std::function<void(double, const std::string&)>& progress);

}  // namespace hmax
