#include "advice/step_search.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "advice/motion/motion_limits.hpp"
#include "advice/time_limit.hpp"
#include "analysis/amplification/numerical_damping.hpp"
#include "core/process/peak_memory.hpp"

namespace hmax {

namespace {

void fail(AdviceRow& row, const std::string& why) {
  row.verdict = AdviceVerdict::unstable;
  row.bound = AdviceBound::stability;
  row.status = why;
}

/// Searches the step of one candidate. Few late frames may be the machine's: the timing of the best rows
/// decides.
class StepSearch {
 public:
  StepSearch(const AdviceQuestion& question, const AnalysedModel& model, const Watcher& watcher)
      : question_(question), model_(model), watcher_(watcher) {}

  void operator()(AdviceRow& row) const {
    if (row.h_max == 0) return fail_at_every_step(row);
    const std::int64_t first = first_steps(row.h_max, question_.frame());
    std::int64_t steps = first;
    AdviceBound cause = steps > 1 ? AdviceBound::stability : AdviceBound::rate;
    std::int64_t failed = steps - 1;  // the most steps that do not suffice
    for (;; steps = next_steps(row, cause, steps)) {
      if (steps > most_steps) return give_up(row, first);
      const MotionRun run = run_at(row, steps);
      if (suffices(run)) break;
      cause = cause_of(row, run);
      failed = steps;
      if (is_hopeless(row, cause, steps, first)) return conclude_failure(row, cause);
    }
    refine(row, failed, steps, cause);
    row.h_accurate = row.h;
    row.least_steps = row.steps_per_frame;
    row.bound = cause;
    row.verdict = AdviceVerdict::suitable;
    if (is_surely_late(row.missed, row.frames) || row.frame.p50 > question_.frame_budget()) {
      row.bound = AdviceBound::budget;
      row.verdict = AdviceVerdict::too_slow;
      row.status = fmt::format("{} of {} frames took more than the budget", row.missed, row.frames);
    }
  }

  /// As halve_step().
  bool halve(AdviceRow& row) const {
    row.bound = AdviceBound::budget;
    if (2 * row.frame.p50 > 0.8 * question_.frame_budget() || 2 * row.steps_per_frame > most_steps)
      return false;
    AdviceRow shorter = row;
    const MotionRun run = run_at(shorter, 2 * row.steps_per_frame);
    if (is_surely_late(shorter.missed, shorter.frames)) return false;
    if (!suffices(run) || shorter.error > 0.9 * row.error) {
      row.bound = AdviceBound::accuracy;
      return false;
    }
    // What is known of the limit stays true.
    if (shorter.status.empty()) shorter.status = row.status;
    row = shorter;
    describe_step(row, model_);
    return true;
  }

 private:
  static constexpr std::int64_t most_steps_after_failure = 64;

  /// Whether more steps per frame than those that did not suffice would not suffice either.
  [[nodiscard]] bool is_hopeless(const AdviceRow& row, AdviceBound cause, std::int64_t steps,
                                 std::int64_t first) const {
    if (cause == AdviceBound::budget) return true;
    if (cause == AdviceBound::accuracy)
      return time_to_meet(row, question_.tolerance) > question_.frame_budget();
    return steps >= most_steps_after_failure * first;
  }

  /// How many steps are tried after so many: a whole multiple, twice as many or where accuracy is missed as
  /// the order of the method tells, a little fewer, since halves between are tried last; most_steps + 1 after
  /// most_steps.
  [[nodiscard]] std::int64_t next_steps(const AdviceRow& row, AdviceBound cause, std::int64_t steps) const {
    if (steps == most_steps) return most_steps + 1;
    const double wanted = 0.8 * steps_to_meet(row, question_.tolerance);
    const double factor = cause == AdviceBound::accuracy ? std::clamp(wanted, 2.0, 64.0) : 2;
    return std::min(most_steps, static_cast<std::int64_t>(factor) * steps);
  }

  [[nodiscard]] bool suffices(const MotionRun& run) const {
    return run.reached_end() && run.error <= question_.tolerance;
  }

  /// Why a run does not suffice. One that is off by the whole motion may have grown, though it is bounded;
  /// where a motion jumps, as at an impact, a late jump is as far off.
  [[nodiscard]] AdviceBound cause_of(const AdviceRow& row, const MotionRun& run) const {
    if (run.outcome == Outcome::newton_failed) return AdviceBound::newton;
    if (run.outcome == Outcome::stopped) return AdviceBound::budget;
    if (!run.reached_end()) return AdviceBound::stability;
    if (run.error <= 1) return AdviceBound::accuracy;
    return judged_step(row.candidate, model_.motion, model_.reference, row.h, watcher_).stable
               ? AdviceBound::accuracy
               : AdviceBound::stability;
  }

  MotionRun run_at(AdviceRow& row, std::int64_t steps) const {
    if (watcher_) watcher_();
    MotionRun run = run_motion(
        row.candidate, model_.motion, model_.reference, question_.frame(), steps,
        {.most_per_frame = hopeless_budgets * question_.frame_budget(), .budget = question_.frame_budget()},
        watcher_);
    record(row, run, steps, question_, model_);
    row.status = run.note;
    return run;
  }

  /// Between a number of steps that does not suffice and one that does, three times halved.
  void refine(AdviceRow& row, std::int64_t failed, std::int64_t steps, AdviceBound& cause) const {
    AdviceRow best = row;
    for (int i = 0; i < 3 && steps - failed > std::max<std::int64_t>(1, steps / 10); ++i) {
      const std::int64_t middle = (failed + steps) / 2;
      const MotionRun run = run_at(row, middle);
      if (suffices(run)) {
        steps = middle;
        best = row;
      } else {
        failed = middle;
        cause = cause_of(row, run);
      }
    }
    row = best;
  }

  /// Without a step that is long enough: no run was stable, or none was made.
  static void give_up(AdviceRow& row, std::int64_t first) {
    if (first <= most_steps)
      return fail(row, fmt::format("a stable step would be less than 1/{} of a frame", most_steps));
    row.verdict = AdviceVerdict::too_slow;
    row.bound = AdviceBound::stability;
    row.status =
        fmt::format("its limit, {:.3g} s, lies below the smallest step that is tried, 1/{} of a frame",
                    row.h_max, most_steps);
  }

  void conclude_failure(AdviceRow& row, AdviceBound cause) const {
    row.bound = cause;
    if (cause == AdviceBound::budget) {
      row.verdict = AdviceVerdict::too_slow;
      row.error = AdviceRow::none;
      row.status = fmt::format("frames take more than {} times the budget; the run was not finished",
                               hopeless_budgets);
      return;
    }
    if (cause == AdviceBound::accuracy && row.frame.p50 > question_.frame_budget()) {
      row.bound = AdviceBound::budget;
      row.verdict = AdviceVerdict::too_slow;
      row.status = "even steps that miss the tolerance take more than the budget";
      return;
    }
    if (cause == AdviceBound::accuracy) {
      row.verdict = AdviceVerdict::inaccurate;
      if (row.status.empty()) row.status = "steps that meet the tolerance would take more than the budget";
      return;
    }
    row.verdict = AdviceVerdict::unstable;
    const StepVerdict verdict = judged_step(row.candidate, model_.motion, model_.reference, row.h, watcher_);
    row.status = fmt::format("no step down to {:.3g} s is stable: {}{}", row.h, verdict.why,
                             row.status.empty() ? "" : " (" + row.status + ")");
  }

  const AdviceQuestion& question_;
  const AnalysedModel& model_;
  const Watcher& watcher_;
};

}  // namespace

std::int64_t first_steps(double h_max, double frame) {
  if (!std::isfinite(h_max) || h_max <= 0) return 1;
  // Not one more for rounding.
  const double steps = std::ceil(frame / (step_safety * h_max) * (1 - 1e-9));
  return static_cast<std::int64_t>(std::min(steps, static_cast<double>(most_steps + 1)));
}

void fail_at_every_step(AdviceRow& row) {
  fail(row, "a mode grows at every step size, if only slowly; the method was not run");
}

void record(AdviceRow& row, const MotionRun& run, std::int64_t steps, const AdviceQuestion& question,
            const AnalysedModel& model) {
  row.steps_per_frame = steps;
  row.stiffness_shown = row.stiffness_ceiling = AdviceRow::none;
  row.h = question.frame() / static_cast<double>(steps);
  // The method of the reference at its step would have none.
  row.error = std::max(run.error, model.reference.error_bound);
  row.frame = frame_times(run.frames_s);
  row.first_frame = run.first_frame_s;
  row.frames = run.frames_s.size();
  row.missed = run.missed;
  row.disturbed = run.disturbed;
  // Foreign engines tell their iterations at the end alone.
  const auto in_nearly_all = [](const std::vector<double>& counts) {
    const double most = quantile(counts, 0.999);
    return most > 0 ? most : AdviceRow::none;
  };
  // A number that the method fixes is one of its parameters.
  const bool fixed = row.candidate.method.parameter("iterations").has_value();
  row.newton_per_frame = fixed ? AdviceRow::none : in_nearly_all(run.newton);
  row.linear_per_frame = in_nearly_all(run.linear_iterations);
}

bool is_suitable(const AdviceRow& row) {
  return row.verdict == AdviceVerdict::suitable || row.verdict == AdviceVerdict::recommended ||
         row.verdict == AdviceVerdict::tie;
}

void describe_step(AdviceRow& row, const AnalysedModel& model) {
  const auto& amplification = row.candidate.method.amplification;
  row.damping_added.clear();
  row.frequency_shift.clear();
  for (const auto& [omega, zeta] : model.slow) {
    ShownOscillation shown{.omega = AdviceRow::none, .zeta = AdviceRow::none};
    if (amplification) shown = shown_oscillation(*amplification, omega, zeta, row.h);
    row.damping_added.push_back(shown.zeta - zeta);
    row.frequency_shift.push_back(shown.omega / omega - 1);
  }
}

void search_step(AdviceRow& row, const CandidateLimit& limit, const AdviceQuestion& question,
                 const AnalysedModel& model, const Watcher& watcher) {
  reset_peak_memory();
  row.status.clear();
  row.limit_pending = limit.pending;
  if (!limit.pending) {
    row.h_max = limit.h_max;
    row.h_max_of_start = limit.of_start;
  } else if (!row.candidate.method.stages_by_radius) {
    row.h_max = AdviceRow::none;
  }
  StepSearch(question, model, watcher)(row);
  row.memory = peak_memory();
  if (row.status.empty()) row.status = limit.status;
  describe_step(row, model);
}

bool halve_step(AdviceRow& row, const AdviceQuestion& question, const AnalysedModel& model,
                const Watcher& watcher) {
  return StepSearch(question, model, watcher).halve(row);
}

bool settle_limit(AdviceRow& row, const AdviceQuestion& question, const AnalysedModel& model,
                  const Watcher& watcher) {
  const CandidateLimit limit = pending_limit(row.candidate, model, watcher);
  const double before = row.h;
  if (before > step_safety * limit.h_max) {
    search_step(row, limit, question, model, watcher);
    return true;
  }
  row.limit_pending = false;
  row.h_max = limit.h_max;
  row.h_max_of_start = limit.of_start;
  if (row.status.empty()) row.status = limit.status;
  describe_step(row, model);
  return false;
}

}  // namespace hmax
