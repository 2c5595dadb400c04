#include "advice/advise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "advice/motion_limits.hpp"
#include "analysis/amplification/numerical_damping.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/process/peak_memory.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// Steps stay this far below a predicted limit.
constexpr double safety = 0.95;
/// Rows this close to the best are as good.
constexpr double noise = 1.10;

/// A body stays where it is after its motion; of other problems the motion must have frames to be timed.
/// @throws InputError  where it has not
void lengthen(ProbingMotion& motion, const AdviceQuestion& question) {
  constexpr double least_frames = 5;
  if (motion.t_end >= least_frames * question.frame()) return;
  if (!motion.problem.body)
    throw InputError(
        fmt::format("the motion of {} ends at {:.6g} s, before {} frames of {:.6g} Hz; take a higher --rate",
                    motion.problem.id, motion.t_end, least_frames, question.rate));
  motion.t_end = least_frames * question.frame();
}

/// The slowest oscillations of a spectrum [rad/s] with their damping ratios.
std::vector<std::pair<double, double>> slowest_modes(const ModeSet& set) {
  std::vector<std::pair<double, double>> modes;
  for (const MechanicalMode& each : set.spectrum.mechanical) {
    const Mode mode = mode_of(each);
    if (mode.omega && *mode.omega > 0 && mode.zeta && *mode.zeta < 1)
      modes.emplace_back(*mode.omega, *mode.zeta);
  }
  std::ranges::sort(modes);
  // Of large models the ends alone are known, and sometimes only the fast one.
  const std::size_t known = set.slow_end ? 0 : set.curve ? 1 : 3;
  if (modes.size() > known) modes.resize(known);
  return modes;
}

/// Puts a run into its row.
void record(AdviceRow& row, const MotionRun& run, std::int64_t steps, const AdviceQuestion& question,
            const AnalysedModel& model) {
  row.steps_per_frame = steps;
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
  row.newton_per_frame = in_nearly_all(run.newton);
  row.linear_per_frame = in_nearly_all(run.linear_iterations);
}

/// Searches the step of one candidate. Few late frames may be the machine's: the timing of the best rows
/// decides.
class StepSearch {
 public:
  StepSearch(const AdviceQuestion& question, const AnalysedModel& model, const Watcher& watcher)
      : question_(question), model_(model), watcher_(watcher) {}

  void operator()(AdviceRow& row) const {
    if (row.h_max == 0)
      return fail(row, "a mode grows at every step size, if only slowly; the method was not run");
    const std::int64_t first = first_steps(row);
    std::int64_t steps = first;
    AdviceBound cause = steps > 1 ? AdviceBound::stability : AdviceBound::rate;
    std::int64_t failed = steps - 1;  // the most steps that do not suffice
    for (;; steps *= 2) {
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
    if (question_.least_error) spend_budget(row);
    if (is_surely_late(row.missed, row.frames) || row.frame.p50 > question_.frame_budget()) {
      row.bound = AdviceBound::budget;
      row.verdict = AdviceVerdict::too_slow;
      row.status = fmt::format("{} of {} frames took more than the budget", row.missed, row.frames);
    }
  }

 private:
  static constexpr std::int64_t most_steps = 100'000, most_steps_after_failure = 64;
  /// A run whose frames take longer than so many budgets is not finished.
  static constexpr double most_budgets = 4;

  /// Whether more steps per frame than those that did not suffice would not suffice either.
  [[nodiscard]] bool is_hopeless(const AdviceRow& row, AdviceBound cause, std::int64_t steps,
                                 std::int64_t first) const {
    if (cause == AdviceBound::budget) return true;
    if (cause == AdviceBound::accuracy)
      return time_to_meet(row, question_.tolerance) > 2 * question_.frame_budget();
    return steps >= most_steps_after_failure * first;
  }

  /// Those of the longest step below the predicted limit; one more than most_steps where they are more.
  [[nodiscard]] std::int64_t first_steps(const AdviceRow& row) const {
    if (!std::isfinite(row.h_max)) return 1;
    // Not one more for rounding.
    const double steps = std::ceil(question_.frame() / (safety * row.h_max) * (1 - 1e-9));
    return static_cast<std::int64_t>(std::min(steps, static_cast<double>(most_steps + 1)));
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
        {.most_per_frame = most_budgets * question_.frame_budget(), .budget = question_.frame_budget()},
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

  /// Shorter steps as long as they fit into four fifths of the budget and the error falls.
  void spend_budget(AdviceRow& row) const {
    while (2 * row.frame.p50 <= 0.8 * question_.frame_budget() && 2 * row.steps_per_frame <= most_steps) {
      AdviceRow shorter = row;
      const MotionRun run = run_at(shorter, 2 * row.steps_per_frame);
      row.bound =
          is_surely_late(shorter.missed, shorter.frames) ? AdviceBound::budget : AdviceBound::accuracy;
      if (!suffices(run) || row.bound == AdviceBound::budget || shorter.error > 0.9 * row.error) return;
      row = shorter;
    }
    row.bound = AdviceBound::budget;
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

  static void fail(AdviceRow& row, const std::string& why) {
    row.verdict = AdviceVerdict::unstable;
    row.bound = AdviceBound::stability;
    row.status = why;
  }

  void conclude_failure(AdviceRow& row, AdviceBound cause) const {
    row.bound = cause;
    if (cause == AdviceBound::budget) {
      row.verdict = AdviceVerdict::too_slow;
      row.error = AdviceRow::none;
      row.status =
          fmt::format("frames take more than {} times the budget; the run was not finished", most_budgets);
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

bool is_suitable(const AdviceRow& row) {
  return row.verdict == AdviceVerdict::suitable || row.verdict == AdviceVerdict::recommended ||
         row.verdict == AdviceVerdict::tie;
}

/// What follows from the step: what it adds to the slowest modes, and how much stiffer the model may become.
void describe_step(AdviceRow& row, const AnalysedModel& model, const Watcher& watcher) {
  const auto& amplification = row.candidate.method.amplification;
  row.damping_added.clear();
  row.frequency_shift.clear();
  for (const auto& [omega, zeta] : model.slow) {
    ShownOscillation shown{.omega = AdviceRow::none, .zeta = AdviceRow::none};
    if (amplification) shown = shown_oscillation(*amplification, omega, zeta, row.h);
    row.damping_added.push_back(shown.zeta - zeta);
    row.frequency_shift.push_back(shown.omega / omega - 1);
  }
  if (is_suitable(row)) row.stiffening = stiffening_margin(row.candidate, row.h_max, model, row.h, watcher);
}

/// One candidate at the longest of its steps that suffices.
/// @param i  its place in AnalysedModel::limits
AdviceRow searched_row(const Candidate& candidate, std::size_t i, const AdviceQuestion& question,
                       const AnalysedModel& model, const Watcher& watcher) {
  AdviceRow row;
  row.candidate = candidate;
  row.h_max = model.limits[i].h_max;
  row.h_max_of_start = model.limits[i].of_start;
  reset_peak_memory();
  StepSearch(question, model, watcher)(row);
  row.memory = peak_memory();
  if (row.status.empty()) row.status = model.limits[i].status;
  describe_step(row, model, watcher);
  return row;
}

/// The limit on the motion: the middle between a step that holds and one 0.5 % longer that does not, sought
/// between 0.8 and 1.25 of the prediction. Where there is none, the status says why.
void observe_limit(AdviceRow& row, const AnalysedModel& model, const Watcher& watcher) {
  double low = 0.8 * row.h_max, high = 1.25 * row.h_max;
  const auto judged = [&](double h) {
    return judged_step(row.candidate, model.motion, model.reference, h, watcher);
  };
  const auto say = [&](const std::string& why) {
    row.unobserved = why;
    row.status += (row.status.empty() ? "" : "; ") + why;
  };
  if (const StepVerdict verdict = judged(low); !verdict.stable)
    return say(fmt::format("runs at 0.8 of the predicted limit are not stable: {}", verdict.why));
  if (judged(high).stable)
    return say("runs at 1.25 of the predicted limit still hold: growth beyond it is too slow, or bounded");
  while (high / low > 1.005) {
    const double middle = std::sqrt(low * high);
    (judged(middle).stable ? low : high) = middle;
  }
  row.h_max_observed = std::sqrt(low * high);
}

/// What rows are ranked by; smaller is better.
double rank_of(const AdviceRow& row, const AdviceQuestion& question) {
  return question.least_error ? row.error : row.frame.p50;
}

void sort_rows(std::vector<AdviceRow>& rows, const AdviceQuestion& question) {
  std::ranges::stable_sort(rows, [&](const AdviceRow& a, const AdviceRow& b) {
    if (is_suitable(a) != is_suitable(b)) return is_suitable(a);
    if (!is_suitable(a)) return static_cast<int>(a.verdict) > static_cast<int>(b.verdict);
    return std::pair(rank_of(a, question), a.frame.p50) < std::pair(rank_of(b, question), b.frame.p50);
  });
}

/// Where steps are shorter than they need be, to lower the error: half as many, to be timed anew.
/// @returns whether they are
bool lengthen_step(AdviceRow& row) {
  if (2 * row.least_steps > row.steps_per_frame) return false;
  row.steps_per_frame /= 2;
  row.frames = 0;
  row.bound = AdviceBound::budget;
  return true;
}

/// Times rows for as many frames as asked, best first, until the best four that suffice are timed; those that
/// miss more than one frame in a thousand are too slow.
void time_best(std::vector<AdviceRow>& rows, const AdviceQuestion& question, const AnalysedModel& model,
               const Watcher& watcher) {
  constexpr std::size_t most_timed = 4;
  // Frames that were late in one run are timed again.
  const auto is_timed = [&](const AdviceRow& row) {
    return row.frames >= question.frames && !is_late(row.missed, row.frames);
  };
  for (std::size_t i = 0; i < std::min(most_timed, rows.size()) && is_suitable(rows[i]);) {
    AdviceRow& row = rows[i];
    if (is_timed(row)) {
      ++i;
      continue;
    }
    const MotionRun run = run_motion(
        row.candidate, model.motion, model.reference, question.frame(), row.steps_per_frame,
        {.frames = question.frames, .budget = question.frame_budget(), .with_repeats = infinity}, watcher);
    const double searched = row.h;
    record(row, run, row.steps_per_frame, question, model);
    if (row.h != searched) describe_step(row, model, watcher);
    if (is_late(row.missed, row.frames) && lengthen_step(row)) continue;
    if (!is_timed(row)) {
      row.verdict = AdviceVerdict::too_slow;
      row.bound = AdviceBound::budget;
      row.status = fmt::format("{} of {} frames took more than the budget", row.missed, row.frames);
    }
    sort_rows(rows, question);
    i = 0;
  }
}

/// Runs the best row for long; one that does not hold is no longer suitable, and the next best is the best.
std::vector<ProofRun> prove_best(std::vector<AdviceRow>& rows, const AdviceQuestion& question,
                                 const AnalysedModel& model, const Watcher& watcher) {
  constexpr double most_cpu = 20;  // [s] of both motions
  while (is_suitable(rows.front())) {
    AdviceRow& best = rows.front();
    const double affordable = most_cpu / 2 * best.realtime_factor(question.rate);
    const std::vector<ProofRun> proof =
        prove(best.candidate, best.steps_per_frame, model.motion, model.reference,
              {.frame = question.frame(),
               .budget = question.frame_budget(),
               .cpu = most_cpu,
               .seconds = std::max(std::min(question.proof, affordable), 5 * question.frame()),
               .slowest = model.slow.empty() ? 0 : model.slow.front().first},
              watcher);
    const auto failed = std::ranges::find_if_not(proof, &ProofRun::holds);
    if (failed == proof.end()) return proof;
    if (failed->stable && lengthen_step(best)) {
      time_best(rows, question, model, watcher);
      continue;
    }
    best.verdict = failed->stable ? AdviceVerdict::too_slow : AdviceVerdict::unstable;
    best.bound = failed->stable ? AdviceBound::budget : AdviceBound::stability;
    best.status = failed->stable ? fmt::format("{} of {} frames took more than the budget: {}",
                                               failed->missed, failed->frames, failed->motion)
                                 : fmt::format("h = {:.4g} s is not stable on {}: {}", best.h, failed->motion,
                                               failed->why);
    sort_rows(rows, question);
    time_best(rows, question, model, watcher);
  }
  return {};
}

void recommend(std::vector<AdviceRow>& rows, const AdviceQuestion& question) {
  if (rows.empty() || !is_suitable(rows.front())) return;
  rows.front().verdict = AdviceVerdict::recommended;
  const double best = rank_of(rows.front(), question);
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (is_suitable(rows[i]) && rank_of(rows[i], question) <= noise * best)
      rows[i].verdict = AdviceVerdict::tie;
}

/// Says what is being done, and which share of all is done.
using Now = std::function<void(double share, std::string what)>;

/// The motion, its reference and the limits along it.
/// @param advice  gets what people read of them
/// @returns the candidates, in the order of AnalysedModel::limits
std::vector<Candidate> analyse(const Problem& problem, const AdviceQuestion& question, AnalysedModel& model,
                               Advice& advice, const Now& now, const Watcher& watch) {
  now(0, "finding a load with an equilibrium");
  model.motion =
      question.motion ? probing_motion(problem, *question.motion, watch) : probing_motion(problem, watch);
  lengthen(model.motion, question);
  advice.motion = fmt::format("{}; to t = {:.6g} s", model.motion.words, model.motion.t_end);
  advice.t_end = model.motion.t_end;
  advice.load_share = model.motion.load_share;
  advice.gravity_share = model.motion.gravity_share;
  std::vector<Candidate> all = candidates(question.methods, model.motion.problem);
  if (all.empty())
    throw InputError(fmt::format(
        "none of the methods can step {} at a fixed step; name others with --methods", problem.id));
  now(0.02, "finding the reference motion");
  model.near = linearised(model.motion.problem, 0, model.motion.problem.y0);
  model.slow = slowest_modes(model.near.modes);
  for (const auto& [omega, zeta] : model.slow) advice.modes.push_back(omega);
  const double rk4_limit = predict(find_method("rk4"), model.near).h_max.value_or(0);
  model.reference = reference_motion(model.motion, question.frame(), question.tolerance, watch, rk4_limit);
  advice.scale = model.reference.scale;
  advice.reference_error = model.reference.error_bound;
  advice.inversion = first_inversion(model.motion, model.reference);
  now(0.1, "limits along the motion");
  predict_limits(model, all, watch, [&](std::size_t i) {
    now(0.1 + 0.2 * static_cast<double>(i) / static_cast<double>(all.size()), "limit of " + all[i].words());
  });
  advice.stiffened = model.stiffened;
  return all;
}

/// Of the rows that suit: nobody takes the others, and some take a million steps.
void observe_limits(std::vector<AdviceRow>& rows, const AnalysedModel& model, const Now& now,
                    const Watcher& watch) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    AdviceRow& row = rows[i];
    if (!is_suitable(row) || !std::isfinite(row.h_max)) continue;
    now(0.8 + 0.17 * static_cast<double>(i) / static_cast<double>(rows.size()),
        "runs beside the limit of " + row.candidate.words());
    observe_limit(row, model, watch);
  }
}

}  // namespace

std::string error_scale(const Problem& problem) {
  return problem.body ? "largest displacement" : "range of each state";
}

std::string_view name_of(AdviceBound bound) {
  constexpr std::array<std::string_view, 5> names{"stability", "accuracy", "newton", "budget", "rate"};
  return names[static_cast<std::size_t>(bound)];
}

std::string_view name_of(AdviceVerdict verdict) {
  constexpr std::array<std::string_view, 6> names{"recommended", "tie",        "suitable",
                                                  "unstable",    "inaccurate", "too_slow"};
  return names[static_cast<std::size_t>(verdict)];
}

std::string_view name_of(AdviceStage stage) {
  constexpr std::array<std::string_view, 6> names{"searching", "timing",   "proving",
                                                  "observing", "remedies", "done"};
  return names[static_cast<std::size_t>(stage)];
}

double time_to_meet(const AdviceRow& row, double tolerance) {
  const double order = std::max(1, row.candidate.method.order);
  return row.frame.p50 * std::max(1.0, std::pow(row.error / tolerance, 1 / order));
}

Advice advise(const Problem& problem, const AdviceQuestion& question, const AdviceWatcher& watcher,
              const ProblemWith& make) {
  Advice advice;
  advise(problem, question, advice, watcher, make);
  return advice;
}

void advise(const Problem& problem, const AdviceQuestion& question, Advice& advice,
            const AdviceWatcher& watcher, const ProblemWith& make) {
  double share = 0;
  std::string what;
  const Watcher watch = [&] {
    if (watcher) watcher(share, what);
  };
  const Now now = [&](double part, std::string text) {
    share = part;
    what = std::move(text);
    watch();
  };
  advice = {};
  const auto known = std::make_shared<AnalysedModel>();
  AnalysedModel& model = *known;
  const std::vector<Candidate> all = analyse(problem, question, model, advice, now, watch);
  advice.model = known;
  for (std::size_t i = 0; i < all.size(); ++i) {
    now(0.3 + 0.4 * static_cast<double>(i) / static_cast<double>(all.size()), "steps of " + all[i].words());
    advice.rows.push_back(searched_row(all[i], i, question, model, watch));
    sort_rows(advice.rows, question);
  }
  advice.stage = AdviceStage::timing;
  now(0.7, "timing the best methods");
  time_best(advice.rows, question, model, watch);
  advice.stage = AdviceStage::proving;
  now(0.75, "long runs of the best method");
  advice.proof = prove_best(advice.rows, question, model, watch);
  advice.stage = AdviceStage::observing;
  observe_limits(advice.rows, model, now, watch);
  if (!advice.rows.empty() && is_suitable(advice.rows.front())) {
    now(0.97, "how much larger the loads may be");
    const AdviceRow& best = advice.rows.front();
    advice.load_margin = load_margin(best.candidate, best.h, model.motion, model.reference, make, watch);
  }
  now(0.99, "how sure the limit is");
  // Behind the last call of the watcher, so that what it throws leaves nothing recommended.
  recommend(advice.rows, question);
  if (const AdviceRow* best = advice.recommended(); best && make && std::isfinite(best->h_max))
    advice.bands = limit_bands(best->candidate.method, problem, model.motion.problem.y0, make);
  advice.stage = AdviceStage::done;
}

}  // namespace hmax
