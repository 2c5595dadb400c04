/// How much larger the motion may become before the recommended step fails.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "advice/motion/candidate.hpp"
#include "advice/motion/probing_motion.hpp"
#include "advice/motion/stable_step.hpp"
#include "advice/motion/uncertainty.hpp"

namespace hmax {

/// Found by running the candidate on larger motions.
struct LoadMargin {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();
  /// What the factors are of: "loads" of a body, else such as "force and initial state".
  std::string loads = {};
  double holds = none;  ///< the largest factor of the loads at which the step is stable
  double fails = none;  ///< the smallest tried at which it is not, or inverts an element; infinity: 8 holds
  double displacement =
      none;  ///< the largest of the motion at `holds`: of a body [m], else of |y_i - y_i(0)|
  /// Whether a quarter of the step fails at `fails` too: the model itself gives way, or moves so that
  /// neighbours part. Nothing where that was not run.
  std::optional<bool> of_model = {};
  std::optional<Inversion> inversion = {};  ///< at `fails`: no step helps where the loads invert an element
};

/// The motion with its forces, and the travels of its supports, times a factor; gravity and tools as they
/// are. Of what is no body the amplitude P of its force, where it has one and `make` is given, and its
/// initial state.
ProbingMotion larger_motion(const ProbingMotion& motion, double factor, const ProblemWith& make);

/// Motions of 2, 4 and 8 times the loads, until one fails or inverts an element, then two between; none is
/// begun after most_cpu of CPU time [s], and `fails` is NaN where that ends the search before one has failed.
/// All is NaN of bodies that a tool touches or that nothing but gravity loads, and of what begins at zero and
/// has no P.
/// @param h  [s]
LoadMargin load_margin(const Candidate& candidate, double h, const ProbingMotion& motion,
                       const ReferenceMotion& reference, const ProblemWith& make, const Watcher& watcher = {},
                       double most_cpu = 10);

}  // namespace hmax
