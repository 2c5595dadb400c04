#include "advice/first_answer.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "advice/step_search.hpp"
#include "bench/timing/timing.hpp"
#include "core/numbers.hpp"
#include "core/process/pinned_thread.hpp"
#include "limits/modes/mode_curve.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// Ends a run from its sink.
struct Enough {};

/// A frame of the steps of a row; NaN where none was timed.
double time_of_frame(const AdviceRow& row, const std::optional<StepTime>& step) {
  if (!step) return AdviceRow::none;
  const int every = row.candidate.jacobian.every;
  const double share_of_factors = row.candidate.method.linearly_implicit && every > 1 ? 1.0 / every : 0;
  return static_cast<double>(row.steps_per_frame) *
         (step->later + share_of_factors * std::max(0.0, step->first - step->later));
}

/// What a step solves, in the order of the time it takes as a rule: nothing, linear equations by a few
/// iterations or by factors, equations that are not linear.
int effort_of_step(const Candidate& candidate) {
  if (!candidate.method.needs_jacobian) return 0;
  if (!candidate.method.linearly_implicit) return 3;
  return candidate.linear_solve.iterations > 0 ? 1 : 2;
}

/// Whether the first step of a candidate, or of one of more effort, takes seconds.
bool takes_seconds(const Candidate& candidate, const Problem& problem) {
  return factors_take_seconds(problem) && effort_of_step(candidate) > 1;
}

}  // namespace

std::optional<StepTime> time_of_steps(const Candidate& candidate, const Problem& problem, double h,
                                      const Watcher& watcher) {
  constexpr double enough = 5e-3, most = 1;  // [s]
  constexpr std::int64_t least_steps = 3, enough_steps = 256;
  const PinnedThread pinned;
  const Runner runner = candidate.method.bind(problem);
  const auto clock = clock_of(runner);
  const double begun = clock();
  double first = 0, last = 0;
  std::int64_t timed = 0, look_at = 1;
  // A device replays steps as a graph; one by one they take longer.
  const std::int64_t seen_every = runner.seconds ? 64 : 1;
  const Sink sink = [&](double t, const Eigen::Ref<const Eigen::VectorXd>&) {
    const std::int64_t step = std::llround(t / h);
    // The clock takes as long as a step of few numbers.
    if (step < look_at) return;
    last = clock() - begun;
    timed = step;
    if (first == 0) first = last / static_cast<double>(step);
    if (watcher) watcher();
    if ((step >= least_steps && last > enough) || last > most) throw Enough{};
    look_at = step < least_steps ? step + 1 : 2 * step;
  };
  const double steps = std::clamp(std::floor(problem.t_end / h), 1.0, static_cast<double>(enough_steps));
  try {
    RunSpec spec = candidate.spec(h, steps * h);
    spec.seen_every = seen_every;
    (void)runner.run(spec, sink);
  } catch (const Enough&) {
  }
  if (timed < 1) return std::nullopt;
  return StepTime{.first = first,
                  .later = timed > 1 ? (last - first) / static_cast<double>(timed - 1) : first};
}

std::vector<AdviceRow> first_answer(const Problem& problem, const AdviceQuestion& question,
                                    const Linearised& near, const std::vector<Candidate>& all,
                                    const Watcher& watcher) {
  constexpr double most = 2.5;  // [s]
  // Single steps are timed on a cold machine.
  constexpr double surely_late = 2;
  Linearised fast = near;
  // A bound will do: the least stiffness itself takes the factors of a large body.
  if (near.point.is_body && fast.modes.slow_end) fast.modes.slow_end = std::make_shared<SlowEnd>(0.0);
  std::vector<AdviceRow> rows;
  for (const Candidate& candidate : all) {
    if (watcher) watcher();
    AdviceRow& row = rows.emplace_back();
    row.candidate = candidate;
    row.h_max = predict(candidate.method, fast).h_max.value_or(AdviceRow::none);
    row.h_max_of_start = true;
    row.steps_per_frame = first_steps(row.h_max, question.frame());
    row.h = question.frame() / static_cast<double>(row.steps_per_frame);
    row.bound = row.steps_per_frame > 1 ? AdviceBound::stability : AdviceBound::rate;
    row.verdict = AdviceVerdict::predicted;
    if (row.h_max == 0) fail_at_every_step(row);
  }
  std::ranges::stable_sort(rows, {}, [](const AdviceRow& row) { return effort_of_step(row.candidate); });
  const double begun = elapsed_seconds();
  for (AdviceRow& row : rows) {
    if (elapsed_seconds() - begun > most || takes_seconds(row.candidate, problem)) break;
    if (row.h_max == 0) continue;
    if (watcher) watcher();
    row.expected_frame = time_of_frame(row, time_of_steps(row.candidate, problem, row.h, watcher));
    if (!(row.expected_frame > surely_late * question.frame_budget())) continue;
    row.verdict = AdviceVerdict::too_slow;
    row.status = fmt::format(
        "a frame takes at least {} times the budget, measured on single steps; the motion was not run",
        short_number(row.expected_frame / question.frame_budget(), 2));
  }
  std::ranges::stable_sort(rows, {}, [](const AdviceRow& row) {
    return std::isnan(row.expected_frame) ? infinity : row.expected_frame;
  });
  return rows;
}

}  // namespace hmax
