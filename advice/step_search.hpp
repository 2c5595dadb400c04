/// The step of one candidate: the longest part of a frame that holds and meets the tolerance.
#pragma once

#include <cstdint>

#include "advice/advice.hpp"

namespace hmax {

/// Steps stay this far below a predicted limit.
inline constexpr double step_safety = 0.95;
/// A frame is at most so many steps.
inline constexpr std::int64_t most_steps = 100'000;
/// What takes more than so many times the budget of a frame is not run to its end.
inline constexpr double hopeless_budgets = 4;

/// Steps of a frame of the longest part below step_safety of a limit; most_steps + 1 where they are more, 1
/// without a limit.
std::int64_t first_steps(double h_max, double frame);

/// Of a row whose limit is 0.
void fail_at_every_step(AdviceRow& row);

/// Puts a run into its row.
void record(AdviceRow& row, const MotionRun& run, std::int64_t steps, const AdviceQuestion& question,
            const AnalysedModel& model);

bool is_suitable(const AdviceRow& row);

/// What the step adds to the slowest modes.
void describe_step(AdviceRow& row, const AnalysedModel& model);

/// Searches the step of a row, from the longest one below the limit on; where the limit is pending, below
/// that of the first answer, or from a whole frame on. Few late frames may be the machine's: the timing of
/// the best rows decides.
void search_step(AdviceRow& row, const CandidateLimit& limit, const AdviceQuestion& question,
                 const AnalysedModel& model, const Watcher& watcher);

/// Halves the step of a row that suits, where that fits into four fifths of the budget and lowers the error
/// by a tenth at least.
/// @returns whether it did; else AdviceRow::bound says why not
bool halve_step(AdviceRow& row, const AdviceQuestion& question, const AnalysedModel& model,
                const Watcher& watcher);

/// Finds the pending limit of a row that suits, and another step where the one it has is too near.
/// @returns whether its step was searched again
bool settle_limit(AdviceRow& row, const AdviceQuestion& question, const AnalysedModel& model,
                  const Watcher& watcher);

}  // namespace hmax
