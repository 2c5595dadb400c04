/// Whether a step is stable on a motion, and what makes it fail.
#pragma once

#include <optional>
#include <string>

#include "advice/motion/candidate.hpp"
#include "advice/motion/probing_motion.hpp"
#include "catalogue/models/equilibria/inversion.hpp"

namespace hmax {

struct StepVerdict {
  bool stable = false;
  std::string why;                     ///< of a step that is not stable
  std::optional<Inversion> inversion;  ///< the first one of the run; it does not decide `stable`
  bool parts = false;  ///< neighbours part, with a quarter of the step too: by impacts or chaos of the model
};

/// Runs a motion from two states that are 1e-8 of the scale apart, of what is no body each number of its
/// range, for 500 steps at least. A step is stable where both reach the end within 1e-4 of each other. Where
/// they part further, the same is run with a quarter of the step. The growth of an unstable step fades with
/// the step, that of the model does not: the model parts its neighbours where the largest growth with a
/// quarter of the step has at least half of the orders of magnitude. The step is then stable if the motion is
/// at most twice as large as with a quarter of the step. Impacts part the neighbours of every run whose steps
/// do not land on them, though the exact ones stay together.
/// @param reference  its scale and ranges are read
/// @param h          [s]
/// @param watcher    called by the calling thread all along the runs, of which those of a body have a thread
/// each
StepVerdict judged_step(const Candidate& candidate, const ProbingMotion& motion,
                        const ReferenceMotion& reference, double h, const Watcher& watcher = {});

/// The first element that the reference inverts, at the instants that it has.
std::optional<Inversion> first_inversion(const ProbingMotion& motion, const ReferenceMotion& reference);

/// StepVerdict::stable.
bool holds(const Candidate& candidate, const ProbingMotion& motion, const ReferenceMotion& reference,
           double h);

}  // namespace hmax
