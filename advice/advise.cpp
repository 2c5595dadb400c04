#include "advice/advise.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include <fmt/format.h>

#include "advice/first_answer.hpp"
#include "advice/motion/motion_limits.hpp"
#include "advice/shown_material.hpp"
#include "advice/step_search.hpp"
#include "advice/time_limit.hpp"
#include "catalogue/device/device_run.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/resisting_model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/text/sentences.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "limits/undamped_modes.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

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

/// The slowest oscillations at a state [rad/s] with their damping ratios; undamped modes where the damping is
/// not proportional.
std::vector<std::pair<double, double>> slowest_modes(const Linearised& near) {
  const std::optional<MechanicalPart>& part = near.point.model.mechanical;
  const bool non_proportional = part && part->symmetric && part->damping == Damping::general &&
                                part->mass.size() <= most_cheaply_factored;
  std::vector<std::pair<double, double>> modes;
  for (const MechanicalMode& each :
       non_proportional ? undamped_modes(near.point, 3).slowest : near.modes.spectrum.mechanical) {
    const Mode mode = mode_of(each);
    if (mode.omega && *mode.omega > 0 && mode.zeta && *mode.zeta < 1)
      modes.emplace_back(*mode.omega, *mode.zeta);
  }
  std::ranges::sort(modes);
  // Of large models the ends alone are known, and sometimes only the fast one.
  const std::size_t known = near.modes.slow_end ? 0 : near.modes.curve ? 1 : 3;
  if (modes.size() > known) modes.resize(known);
  return modes;
}

/// The limit on the motion: the middle between a step that holds and one 0.5 % longer that does not, sought
/// between 0.8 and 1.25 of the prediction, first near it. Where there is none, the status says why.
void observe_limit(AdviceRow& row, const AnalysedModel& model, const Watcher& watcher) {
  StepVerdict verdict;
  const auto is_stable = [&](double share) {
    verdict = judged_step(row.candidate, model.motion, model.reference, share * row.h_max, watcher);
    return verdict.stable;
  };
  const auto say = [&](const std::string& why) {
    row.unobserved = why;
    add_sentence(row.status, why);
  };
  double low = 0, high = 0;
  for (const double share : {1.02, 1.25}) {
    if (!is_stable(share)) {
      high = share;
      break;
    }
    low = share;
  }
  if (high == 0)
    return say("runs at 1.25 of the predicted limit still hold: growth beyond it is too slow, or bounded");
  for (const double share : {0.98, 0.8}) {
    if (low > 0) break;
    if (is_stable(share))
      low = share;
    else
      high = share;
  }
  if (low == 0) return say(fmt::format("runs at 0.8 of the predicted limit are not stable: {}", verdict.why));
  while (high / low > 1.005) {
    const double middle = std::sqrt(low * high);
    (is_stable(middle) ? low : high) = middle;
  }
  row.h_max_observed = std::sqrt(low * high) * row.h_max;
}

/// What rows are ranked by; smaller is better.
double rank_of(const AdviceRow& row, const AdviceQuestion& question) {
  return question.least_error ? row.error : row.frame.p50;
}

void sort_rows(std::span<AdviceRow> rows, const AdviceQuestion& question) {
  std::ranges::stable_sort(rows, [&](const AdviceRow& a, const AdviceRow& b) {
    if (is_suitable(a) != is_suitable(b)) return is_suitable(a);
    if (a.verdict != b.verdict && !is_suitable(a))
      return static_cast<int>(a.verdict) > static_cast<int>(b.verdict);
    if (!is_suitable(a)) return false;
    return std::pair(rank_of(a, question), a.frame.p50) < std::pair(rank_of(b, question), b.frame.p50);
  });
}

/// Where steps are shorter than they need be, to lower the error: half as many, to be timed anew.
/// @returns whether they are
bool lengthen_step(AdviceRow& row) {
  if (2 * row.least_steps > row.steps_per_frame) return false;
  row.steps_per_frame /= 2;
  row.h *= 2;
  row.frames = 0;
  row.bound = AdviceBound::budget;
  return true;
}

std::string unstable_in_words(const AdviceRow& row, const ProofRun& failed) {
  return fmt::format("h = {:.4g} s is not stable on {}: {}", row.h, failed.motion, failed.why);
}

/// Where a long run at a step was not stable: a fifth less of it, to be timed anew.
void shorten_step(AdviceRow& row, const AdviceQuestion& question, const ProofRun& failed) {
  row.status = unstable_in_words(row, failed) + "; this step is shorter";
  row.steps_per_frame = (5 * row.steps_per_frame + 3) / 4;
  row.least_steps = row.steps_per_frame;  // no longer step suffices
  row.h = question.frame() / static_cast<double>(row.steps_per_frame);
  row.frames = 0;
  row.bound = AdviceBound::stability;
}

/// Which rows are timed.
enum class Timed {
  best,   ///< the first, and those that may be as good
  others  ///< those after the first, which stays where it is
};

/// Times rows for as many frames as asked, best first, of at most four that suffice; those that miss more
/// than one frame in a thousand are too slow. A limit that is pending is found first.
void time_rows(Timed which, std::vector<AdviceRow>& rows, const AdviceQuestion& question,
               const AnalysedModel& model, const Watcher& watcher) {
  constexpr std::size_t most = 4;
  const std::size_t first = which == Timed::best ? 0 : 1;
  // Frames that were late in one run are timed again.
  const auto is_timed = [&](const AdviceRow& row) {
    return !row.limit_pending && row.frames >= question.frames && !is_late(row.missed, row.frames);
  };
  const auto time_row = [&](AdviceRow& row) {
    if (row.limit_pending && settle_limit(row, question, model, watcher)) return;
    const MotionRun run = run_motion(
        row.candidate, model.motion, model.reference, question.frame(), row.steps_per_frame,
        {.frames = question.frames, .budget = question.frame_budget(), .with_repeats = infinity}, watcher);
    record(row, run, row.steps_per_frame, question, model);
    describe_step(row, model);
    if (is_timed(row) || (is_late(row.missed, row.frames) && lengthen_step(row))) return;
    row.verdict = AdviceVerdict::too_slow;
    row.bound = AdviceBound::budget;
    row.status = fmt::format("{} of {} frames took more than the budget", row.missed, row.frames);
  };
  for (std::size_t i = first; i < std::min(most, rows.size()) && is_suitable(rows[i]);) {
    const bool may_be_best = rank_of(rows[i], question) <= noise * rank_of(rows.front(), question);
    if (which == Timed::best && !may_be_best) break;
    if (is_timed(rows[i])) {
      ++i;
      continue;
    }
    time_row(rows[i]);
    sort_rows(std::span(rows).subspan(first), question);
    i = first;
  }
}

/// Runs the best row for long, for most_cpu [s] on both motions. Where that is not stable, up to four shorter
/// steps are tried; what does not hold is no longer suitable, and the next best is the best.
std::vector<ProofRun> prove_best(std::vector<AdviceRow>& rows, const AdviceQuestion& question,
                                 const AnalysedModel& model, double most_cpu, const Watcher& watcher) {
  constexpr int most_shortened = 4;
  for (int shortened = 0; is_suitable(rows.front());) {
    AdviceRow& best = rows.front();
    const double affordable = most_cpu / 2 * best.realtime_factor(question.rate);
    std::vector<ProofRun> proof =
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
      time_rows(Timed::best, rows, question, model, watcher);
      continue;
    }
    if (!failed->stable && shortened++ < most_shortened) {
      shorten_step(best, question, *failed);
      time_rows(Timed::best, rows, question, model, watcher);
      continue;
    }
    shortened = 0;
    best.verdict = failed->stable ? AdviceVerdict::too_slow : AdviceVerdict::unstable;
    best.bound = failed->stable ? AdviceBound::budget : AdviceBound::stability;
    best.status = failed->stable ? fmt::format("{} of {} frames took more than the budget: {}",
                                               failed->missed, failed->frames, failed->motion)
                                 : unstable_in_words(best, *failed);
    sort_rows(rows, question);
    time_rows(Timed::best, rows, question, model, watcher);
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

/// Of a body; none of other problems.
ExplicitLimits explicit_limits(const Linearised& near) {
  const auto limit = [&](const char* method) {
    return near.point.is_body ? predict(find_method(method), near).h_max.value_or(0) : 0;
  };
  return {.central = limit("central_difference"), .rk4 = limit("rk4")};
}

/// One search for an answer.
class Search {
 public:
  Search(const Problem& problem, const AdviceQuestion& question, Advice& advice, const AdviceWatcher& watcher,
         const ProblemWith& make)
      : problem_(problem),
        question_(question),
        advice_(advice),
        watcher_(watcher),
        make_(make),
        time_(question.within) {}

  void operator()() {
    try {
      predict_all();
      if (has_hope()) {
        analyse();
        search_steps();
        if (question_.least_error) spend_budgets();
        if (suits()) verify_best();
        if (suits()) {
          look_at_other_model();
          enter(AdviceStage::observing, 0.9, "timing other methods");
          time_rows(Timed::others, advice_.rows, question_, *model_, watch_);
        }
        tell_what_is_shown();
        observe_others();
      }
      advice_.stage = AdviceStage::done;
    } catch (const OutOfTime&) {
      advice_.out_of_time = true;
    } catch (...) {
      conclude();
      throw;
    }
    conclude();
  }

 private:
  /// Says what is being done, and which share of all is done; ends the search where a share of its time is
  /// over.
  void enter(AdviceStage stage, double share, std::string what, double until = 1) {
    advice_.stage = stage;
    share_ = share;
    what_ = std::move(what);
    until_ = until;
    watch_();
  }

  void predict_all() {
    enter(AdviceStage::predicting, 0, "limits near the initial state");
    const std::vector<Candidate> all = candidates(question_.methods, problem_);
    if (all.empty())
      throw InputError(fmt::format(
          "none of the methods can step {} at a fixed step; name others with --methods", problem_.id));
    model_->near = linearised(problem_, 0, problem_.y0);
    advice_.rows = first_answer(problem_, question_, model_->near, all, watch_);
  }

  [[nodiscard]] bool has_hope() const {
    return std::ranges::any_of(advice_.rows,
                               [](const AdviceRow& row) { return row.verdict == AdviceVerdict::predicted; });
  }

  /// The motion, its reference and the limits along it of the rows that have hope.
  void analyse() {
    AnalysedModel& model = *model_;
    enter(AdviceStage::searching, 0.01, "comparing supports");
    advice_.suggested_support = suggested_support(problem_);
    enter(AdviceStage::searching, 0.02, "finding a load with an equilibrium");
    model.motion = question_.motion ? probing_motion(problem_, *question_.motion, watch_)
                                    : probing_motion(problem_, watch_, question_.frame());
    lengthen(model.motion, question_);
    advice_.motion = fmt::format("{}; to t = {:.6g} s", model.motion.words, model.motion.t_end);
    advice_.t_end = model.motion.t_end;
    advice_.load_share = model.motion.load_share;
    advice_.gravity_share = model.motion.gravity_share;
    enter(AdviceStage::searching, 0.05, "finding the reference motion");
    if (problem_.body || question_.motion)
      model.near = linearised(model.motion.problem, 0, model.motion.problem.y0);
    // Points that a motion moves are free without it: the limits would be those of two systems.
    if (make_ && model.motion.problem.y0.size() == problem_.y0.size())
      model.stiffer = stiffer(problem_, changed_state(), make_);
    if (model.stiffer)
      model.with_stiffness = [problem = problem_, y = changed_state(), make = make_](double factor) {
        return stiffer(problem, y, make, factor);
      };
    model.slow = slowest_modes(model.near);
    for (const auto& [omega, zeta] : model.slow) advice_.modes.push_back(omega);
    ExplicitLimits limits = explicit_limits(model.near);
    if (question_.least_error) limits.central = 0;  // errors that are ranked must be seen apart
    model.reference = reference_motion(model.motion, question_.frame(), question_.tolerance, watch_, limits,
                                       placing(model.motion.problem));
    advice_.scale = model.reference.scale;
    advice_.reference_error = model.reference.error_bound;
    advice_.inversion = first_inversion(model.motion, model.reference);
    enter(AdviceStage::searching, 0.15, "limits along the motion");
    std::vector<Candidate> all;
    for (const AdviceRow& row : advice_.rows)
      if (row.verdict == AdviceVerdict::predicted) all.push_back(row.candidate);
    predict_limits(model, all, watch_, [&](std::size_t i) {
      enter(AdviceStage::searching, 0.15 + 0.15 * static_cast<double>(i) / static_cast<double>(all.size()),
            "limit of " + all[i].words());
    });
    advice_.stiffened = model.stiffened;
    advice_.model = model_;
  }

  /// Where the problem is looked at with other parameters: at the start of the motion, or at rest where that
  /// moves points which are free without it.
  [[nodiscard]] const Eigen::VectorXd& changed_state() const {
    const Eigen::VectorXd& start = model_->motion.problem.y0;
    return start.size() == problem_.y0.size() ? start : problem_.y0;
  }

  /// Methods on the device of the question where that runs them; find_method() where there is none.
  [[nodiscard]] FindMethod placing(const Problem& problem) const {
    if (!question_.device) return find_method;
    return [&problem, device = question_.device](std::string_view id) {
      Method method = find_method(id);
      return unsuited_for_device(problem, method).empty() ? on_device(std::move(method), device) : method;
    };
  }

  /// In the order of the first answer, which is that of AnalysedModel::limits. A row that takes more than
  /// half of the time that is left waits until the others are searched. Where none suits that is half of the
  /// time for trying, so that most is left to a method that needs it.
  void search_steps() {
    std::vector<AdviceRow> rows = advice_.rows;
    std::erase_if(rows, [](const AdviceRow& row) { return row.verdict != AdviceVerdict::predicted; });
    std::vector<std::size_t> waiting;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const bool is_only = i + 1 == rows.size() && waiting.empty();
      const double end = suits() ? time_of_search : is_only ? 1 : time_of_trying;
      if (!search_row(rows[i], i, rows.size(), end, is_only ? 1 : 0.5)) waiting.push_back(i);
    }
    for (const std::size_t i : waiting) {
      if (search_row(rows[i], i, rows.size(), suits() ? time_of_search : 1, 1)) continue;
      // What was found so far is verified in the time that is left.
      if (!suits()) throw OutOfTime{};
      advice_.out_of_time = true;
      return;
    }
  }

  [[nodiscard]] bool suits() const { return is_suitable(advice_.rows.front()); }

  /// One of so many rows, for a part of the time that is left before a share of all is over.
  /// @returns whether that sufficed
  bool search_row(AdviceRow row, std::size_t i, std::size_t rows, double end, double part) {
    const std::string words = row.candidate.words();
    if (time_.spent() > end) return false;
    try {
      enter(AdviceStage::searching, 0.3 + 0.4 * static_cast<double>(i) / static_cast<double>(rows),
            "steps of " + words, time_.spent() + part * (end - time_.spent()));
      search_step(row, model_->limits[i], question_, *model_, watch_);
    } catch (const OutOfTime&) {
      return false;
    }
    *std::ranges::find(advice_.rows, words, [](const AdviceRow& each) { return each.candidate.words(); }) =
        std::move(row);
    sort_rows(advice_.rows, question_);
    return true;
  }

  /// Halves steps where that pays, as long as there is time: always those with the cheapest frames, so that
  /// no method waits for what another one spends.
  void spend_budgets() {
    for (AdviceRow& row : advice_.rows)
      if (is_suitable(row)) row.bound = AdviceBound::budget;
    try {
      std::set<std::string> done;
      for (;;) {
        AdviceRow* next = nullptr;
        for (AdviceRow& row : advice_.rows)
          if (is_suitable(row) && !done.contains(row.candidate.words()) &&
              (!next || row.frame.p50 < next->frame.p50))
            next = &row;
        if (!next) break;
        enter(AdviceStage::searching, 0.7, "shorter steps of " + next->candidate.words(), time_of_search);
        if (!halve_step(*next, question_, *model_, watch_)) done.insert(next->candidate.words());
        sort_rows(advice_.rows, question_);
      }
    } catch (const OutOfTime&) {  // what suffices stays
    }
  }

  void verify_best() {
    std::vector<AdviceRow>& rows = advice_.rows;
    const AnalysedModel& model = *model_;
    enter(AdviceStage::timing, 0.7, "timing the best methods");
    time_rows(Timed::best, rows, question_, model, watch_);
    enter(AdviceStage::proving, 0.75, "long runs of the best method");
    advice_.proof = prove_best(rows, question_, model, std::min(20.0, time_.left() / 3), watch_);
    if (!is_suitable(rows.front())) return;
    observe(rows.front(), 0.8);
    enter(AdviceStage::observing, 0.84, "how much larger the loads may be");
    advice_.load_margin = load_margin(rows.front().candidate, rows.front().h, model.motion, model.reference,
                                      make_, watch_, std::min(10.0, time_.left() / 3));
    enter(AdviceStage::observing, 0.88, "how sure the limit is");
    if (make_ && std::isfinite(rows.front().h_max))
      advice_.bands = limit_bands(rows.front().candidate.method, problem_, changed_state(), make_);
    tell_margin(rows.front(), 0.885);
  }

  /// Where elements are inverted, or loads are too large for this model: what one does that resists.
  void look_at_other_model() {
    const bool fails = advice_.inversion || advice_.load_share < 1 || advice_.gravity_share < 1;
    const std::optional<Problem> other =
        problem_.body && fails ? with_resisting_model(problem_) : std::nullopt;
    if (!other) return;
    enter(advice_.stage, 0.89, "a model that resists inversion");
    try {
      const ProbingMotion motion = question_.motion ? probing_motion(*other, *question_.motion, watch_)
                                                    : probing_motion(*other, watch_, question_.frame());
      const ReferenceMotion reference = reference_motion(
          motion, question_.frame(), question_.tolerance, watch_,
          explicit_limits(linearised(motion.problem, 0, motion.problem.y0)), placing(motion.problem));
      advice_.other_model = {.id = settings_of(*other).model.id,
                             .load_share = motion.load_share,
                             .gravity_share = motion.gravity_share,
                             .scale = reference.scale,
                             .inversion = first_inversion(motion, reference)};
    } catch (const InputError&) {  // no reference with that model either
    }
  }

  void tell_what_is_shown() {
    if (!question_.material) return;
    enter(advice_.stage, 0.91, "what is shown of the material");
    if (const auto model = material_model(problem_, question_, advice_, watch_))
      tell_material(advice_.rows, *model, std::min(10.0, time_.left() / 3), watch_);
  }

  void observe_others() {
    std::vector<AdviceRow>& rows = advice_.rows;
    for (std::size_t i = 1; i < rows.size(); ++i)
      observe(rows[i], 0.92 + 0.07 * static_cast<double>(i) / static_cast<double>(rows.size()));
    for (std::size_t i = 1; i < rows.size(); ++i) tell_margin(rows[i], 0.99);
  }

  /// Of rows that suit, once they are all run: of frozen Jacobians it takes longer than the run.
  void tell_margin(AdviceRow& row, double share) {
    if (!is_suitable(row)) return;
    enter(AdviceStage::observing, share, "how much stiffer the model may be with " + row.candidate.words());
    row.stiffening = stiffening_margin(row.candidate, row.h_max, *model_, row.h, watch_);
  }

  /// Of rows that suit: nobody takes the others, and some take a million steps.
  void observe(AdviceRow& row, double share) {
    if (!is_suitable(row) || row.limit_pending || !std::isfinite(row.h_max)) return;
    enter(AdviceStage::observing, share, "runs beside the limit of " + row.candidate.words());
    observe_limit(row, *model_, watch_);
  }

  void conclude() {
    recommend(advice_.rows, question_);
    for (AdviceRow& row : advice_.rows) {
      if (advice_.out_of_time && row.verdict == AdviceVerdict::predicted)
        row.status = "not run: time limit reached";
      if (row.limit_pending && is_suitable(row) && row.status.empty())
        row.status = "its limit along the motion was not sought, since others are better";
    }
    advice_.seconds = time_.elapsed();
  }

  /// Of all, from the first row that suits on.
  static constexpr double time_of_search = 0.6;
  /// Of all, as long as none suits, for rows that may wait.
  static constexpr double time_of_trying = 1.0 / 3;

  const Problem& problem_;
  const AdviceQuestion& question_;
  Advice& advice_;
  const AdviceWatcher& watcher_;
  const ProblemWith& make_;
  TimeLimit time_;
  double share_ = 0, until_ = 1;
  std::string what_;
  std::shared_ptr<AnalysedModel> model_ = std::make_shared<AnalysedModel>();
  Watcher watch_ = [this] {
    if (watcher_) watcher_(share_, what_);
    time_.require(until_);
  };
};

}  // namespace

Advice advise(const Problem& problem, const AdviceQuestion& question, const AdviceWatcher& watcher,
              const ProblemWith& make) {
  Advice advice;
  advise(problem, question, advice, watcher, make);
  return advice;
}

void advise(const Problem& problem, const AdviceQuestion& question, Advice& advice,
            const AdviceWatcher& watcher, const ProblemWith& make) {
  advice = {};
  Search(problem, question, advice, watcher, make)();
}

}  // namespace hmax
