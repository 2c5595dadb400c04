/// Which integrator, and how large a step: the question of the whole program, answered for one model and
/// frame rate.
#pragma once

#include <functional>
#include <string>

#include "advice/advice.hpp"

namespace hmax {

/// Called with what is being decided; what it throws ends the search.
using AdviceWatcher = std::function<void(double share, const std::string& what)>;

/// Tries every candidate on the probing motion of a problem.
///
/// First come the limits near the initial state and the time of single steps, which tell how the candidates
/// are likely to rank and which are hopeless; Advice::rows has them from AdviceStage::searching on. The
/// others follow, cheapest first. The step of a candidate is a whole part of a frame. The search begins with
/// the longest one below 0.95 of the predicted limit and takes shorter ones until the motion holds and meets
/// the tolerance. The best rows are then timed over `frames` frames, in turn; the best must hold for `proof`
/// simulated seconds, as far as they take no more than 20 s of CPU time, or a third of the time that is left.
/// Rows within 10 % of the best are ties. Once a row suits, the search for steps ends when six
/// tenths of AdviceQuestion::within are over, all else at its end: the answer is what is known by then.
/// @throws InputError  as probing_motion() and reference_motion()
/// @param make  for the bands of the limit; without it there are none
Advice advise(const Problem& problem, const AdviceQuestion& question, const AdviceWatcher& watcher = {},
              const ProblemWith& make = {});

/// The same into `advice`. What the watcher throws leaves the rows as they are, best first; Advice::stage
/// says what is missing.
void advise(const Problem& problem, const AdviceQuestion& question, Advice& advice,
            const AdviceWatcher& watcher = {}, const ProblemWith& make = {});

/// How a model can be made again.
struct Remaking {
  ProblemWith with;                       ///< other parameters
  std::function<Problem()> coarser = {};  ///< on a coarser mesh; empty where there is none
  /// On a mesh where as many of the tetrahedra that limit explicit steps most are mended; may be empty.
  std::function<Problem(int count)> mended = {};
};

/// Of an advice that recommends nothing, though it had the time: changes one by one under which it would,
/// each tried like the first, in this order: a larger budget, a coarser mesh, the tetrahedra mended that
/// limit explicit steps most, more mass where elements are fast, a lower rate, and of a body more density or
/// mass, a softer material, a softer or thinner skin, less damping by stiffness.
/// @param failed  what was found without a change. What helps goes into Advice::remedies, where it stays when
/// the
///                watcher throws. No change is tried after two minutes of CPU time, or beyond what the failed
///                search has left of AdviceQuestion::within.
void find_remedies(const Problem& problem, const AdviceQuestion& question, Advice& failed,
                   const Remaking& make, const AdviceWatcher& watcher = {});

}  // namespace hmax
