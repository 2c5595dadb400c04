/// What is known of all candidates within seconds: their limits near the initial state, and what a few of
/// their steps take.
#pragma once

#include <optional>
#include <vector>

#include "advice/advice.hpp"
#include "limits/linearised_problem.hpp"

namespace hmax {

/// CPU time of the steps of a candidate [s].
struct StepTime {
  double first = 0;  ///< with what is done once, such as an order of elimination and the first factors
  double later = 0;  ///< the mean of those after it
};

/// From the initial state, as a timed run is made: some milliseconds of steps, at least three of them unless
/// they take a second.
/// @param h  [s]
/// @returns nothing where no step is made
std::optional<StepTime> time_of_steps(const Candidate& candidate, const Problem& problem, double h,
                                      const Watcher& watcher = {});

/// Every candidate at the longest part of a frame below 0.95 of its limit near the initial state, and what a
/// frame of such steps takes at least: more where accuracy or the motion ask for shorter ones. Those that
/// take more than twice the budget are too slow, all others AdviceVerdict::predicted. Cheapest
/// first; last those whose steps were not timed, because that takes seconds: after 2.5 of them, and of
/// those that factor or solve equations on large bodies.
/// @param near  the problem at its initial state; its modes
std::vector<AdviceRow> first_answer(const Problem& problem, const AdviceQuestion& question,
                                    const Linearised& near, const std::vector<Candidate>& all,
                                    const Watcher& watcher = {});

}  // namespace hmax
