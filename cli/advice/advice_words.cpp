#include "cli/advice/advice_words.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "advice/shown_material.hpp"
#include "advice/step_search.hpp"
#include "catalogue/models/body_summary.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/text/counted.hpp"
#include "problems/tissue/body.hpp"
#include "results/fingerprint.hpp"

namespace hmax {

namespace {

std::string milliseconds(double seconds, int digits = 3) {
  if (std::isnan(seconds)) return "-";
  return std::isinf(seconds) ? "unbounded" : short_number(1e3 * seconds, digits);
}

std::string percent(double share) { return std::isfinite(share) ? short_number(100 * share, 2) + " %" : "-"; }

/// What keeps the step from being longer.
std::string sentence_of_bound(const AdviceRow& row, bool least_error) {
  const bool suits = row.verdict == AdviceVerdict::recommended || row.verdict == AdviceVerdict::tie;
  if (least_error && suits && row.bound == AdviceBound::budget)
    return "the budget: frames of twice as many steps would take more than 0.8 of it, be late, or were not tried in "
           "time";
  if (least_error && suits && row.bound == AdviceBound::accuracy)
    return "accuracy: twice as many steps hardly lower the error";
  switch (row.bound) {
    case AdviceBound::stability:
      if (const auto steps = static_cast<double>(row.steps_per_frame);
          steps > 1 && row.h * steps / (steps - 1) < step_safety * row.h_max)
        return "stability: longer parts of a frame are below the limit, but were not stable in a run";
      return "stability: a longer part of a frame is within 5 % of the limit or beyond it";
    case AdviceBound::accuracy:
      return "accuracy: the next longer part of a frame misses the tolerance";
    case AdviceBound::newton:
      return "Newton's method: it does not converge for the next longer part of a frame";
    case AdviceBound::budget:
      return "the budget: frames take longer than it";
    case AdviceBound::rate:
      break;
  }
  return "the rate: one step a frame suffices";
}

std::string words_of_modes(const AdviceRow& row, const Advice& advice) {
  std::string words;
  for (std::size_t i = 0; i < std::min(advice.modes.size(), row.damping_added.size()); ++i)
    if (std::isfinite(row.damping_added[i]))
      words += fmt::format("{}{} rad/s: damping ratio {:+.2g}, frequency {:+.2g} %",
                           words.empty() ? "" : "; ", short_number(advice.modes[i], 3),
                           row.damping_added[i] + 0.0, 100 * row.frequency_shift[i] + 0.0);
  return words;
}

std::string words_of_limit(const AdviceRow& row) {
  if (std::isinf(row.h_max)) return "stable at every step size (linearised model)";
  if (std::isnan(row.h_max)) return "no limit is predicted; stable in the run";
  const std::string seen = !std::isnan(row.h_max_observed) ? milliseconds(row.h_max_observed) + " ms observed"
                           : row.unobserved.empty()        ? "not observed"
                                                           : row.unobserved;
  return fmt::format("h_max {} ms predicted, {}; {}", milliseconds(row.h_max, 4),
                     row.h_max_of_start ? "that of the start: along the motion none is known"
                                        : "the smallest along the motion",
                     seen);
}

std::string words_of_step(const AdviceRow& row) {
  return fmt::format("take {} with h = {} ms, {} per frame", row.candidate.words(), milliseconds(row.h, 5),
                     counted(row.steps_per_frame, "step"));
}

using Facts = std::vector<std::pair<std::string, std::string>>;

/// How a model that resists inversion stands the same motion; empty where it was not tried, or does no
/// better.
std::string words_of_other_model(const Advice& advice) {
  if (!advice.other_model) return {};
  const OtherModel& other = *advice.other_model;
  const bool bears_more = other.gravity_share > advice.gravity_share || other.load_share > advice.load_share;
  const bool is_whole = !other.inversion && other.gravity_share == 1 && other.load_share == 1;
  if (!is_whole && !bears_more && (other.inversion || !advice.inversion)) return {};
  const auto share = [](double of) { return of == 1 ? std::string("all") : short_number(of, 3); };
  return fmt::format("--model {} moves by {} mm under {} of gravity and {} of the load, and {}", other.id,
                     milliseconds(other.scale), share(other.gravity_share), share(other.load_share),
                     other.inversion ? in_words(*other.inversion) : "inverts no element");
}

/// What the user must know before trusting the answer: loads that were reduced, and a limit that published
/// spreads cross.
void add_cautions(Facts& facts, const Advice& advice, const AdviceRow& row, const AdviceQuestion& question) {
  const auto caution = [&](std::string words) {
    facts.emplace_back(facts.empty() ? "caution" : "", std::move(words));
  };
  const auto share = [](double of) { return of == 0 ? std::string("no") : short_number(of, 3) + " of"; };
  if (advice.gravity_share < 1)
    caution(fmt::format("tried with {} gravity only: under all of it the step may fail",
                        share(advice.gravity_share)));
  if (advice.load_share < 1)
    caution(fmt::format("tried with {} the load only: under all of it the step may fail",
                        share(advice.load_share)));
  if (advice.inversion)
    caution(fmt::format(
        "{}, in the reference motion too: the load causes it, not the step; reduce the load or take a "
        "stiffer material",
        in_words(*advice.inversion)));
  if (const std::string other = words_of_other_model(advice); !other.empty()) caution(other);
  const auto band = std::ranges::min_element(advice.bands, {}, &LimitBand::low);
  if (band == advice.bands.end() || band->low * row.h_max >= row.h) return;
  constexpr double safety = 0.95;  // below a limit, as steps are chosen
  const double steps = std::ceil(question.frame() / (safety * band->low * row.h_max));
  caution(fmt::format(
      "where the {} is {} % off, h_max falls to {} ms; h = {} ms, {} steps per frame, is below that",
      band->quantity, short_number(100 * band->spread, 2), milliseconds(band->low * row.h_max),
      milliseconds(question.frame() / steps, 4), steps));
}

/// Empty of none.
std::string words_of_disturbed(std::size_t frames) {
  return frames == 0
             ? ""
             : fmt::format(" (of three runs; {} more did in one run alone, which is the machine)", frames);
}

/// Which Jacobian "frozen" is; empty of others. Its limit depends on the state that it is of.
std::string words_of_frozen(const AdviceRow& row, const Problem& problem) {
  if (row.candidate.jacobian.every != JacobianUpdate::frozen) return {};
  const bool weighted = problem.body && settings_of(problem).gravity.norm() > 0;
  return fmt::format(
      "of the start of the motion{}; that of `run` and `stability predict --jacobian frozen` is of their "
      "initial state{}",
      weighted ? ", the equilibrium under gravity" : "",
      problem.body ? ", by default the body without loads" : "");
}

/// Whose time frames take.
std::string_view time_word(const AdviceQuestion& question) {
  return question.device ? "time of the device" : "CPU time";
}

/// Why it is the recommended row: beside the next of those that suit and are no ties, and the most accurate
/// of those that are cheaper and do not suit.
std::string words_of_choice(const AdviceRow& best, const Advice& advice, const AdviceQuestion& question) {
  const AdviceRow *next = nullptr, *cheaper = nullptr;
  std::size_t suitable = 0;
  for (const AdviceRow& row : advice.rows) {
    if (is_suitable(row)) ++suitable;
    if (row.verdict == AdviceVerdict::suitable && !std::isnan(row.frame.p50) &&
        (!next || row.frame.p50 < next->frame.p50))
      next = &row;
    if (row.verdict == AdviceVerdict::inaccurate && row.frame.p50 < best.frame.p50 &&
        (!cheaper || row.error < cheaper->error))
      cheaper = &row;
  }
  const auto takes = [&](const AdviceRow& row) {
    return fmt::format("; {} takes {} times as much", row.candidate.words(),
                       short_number(row.frame.p50 / best.frame.p50, 2));
  };
  std::string words = suitable == 1
                          ? "the only row that suits"
                          : fmt::format("the least {} of {} rows that suit", time_word(question), suitable);
  if (std::ranges::find(advice.rows, AdviceVerdict::predicted, &AdviceRow::verdict) != advice.rows.end())
    words += ", of those that were run";
  if (next) words += takes(*next);
  if (cheaper) words += fmt::format("{}, and is off by {}", takes(*cheaper), percent(cheaper->error));
  return words;
}

/// What was measured of the recommended row.
void add_measured(Facts& facts, const Problem& problem, const AdviceRow& row, const Advice& advice,
                  const AdviceQuestion& question) {
  if (question.device) {
    const DeviceFacts device = question.device->facts();
    facts.emplace_back("device", fmt::format("{}, {} MHz, {}, double precision", device.name,
                                             short_number(device.clock_mhz, 4), device.driver));
  }
  if (!question.least_error && advice.rows.size() > 1)
    facts.emplace_back("chosen as", words_of_choice(row, advice, question));
  facts.emplace_back("stability", words_of_limit(row));
  facts.emplace_back("limited by", sentence_of_bound(row, question.least_error));
  if (const std::string frozen = words_of_frozen(row, problem); !frozen.empty())
    facts.emplace_back("Jacobian", frozen);
  facts.emplace_back("error",
                     fmt::format("{}{} of the {}",
                                 row.error <= advice.reference_error ? "that of the reference, at most " : "",
                                 percent(row.error), error_scale(problem)));
  facts.emplace_back(
      fmt::format("{} time", question.device ? "device" : "CPU"),
      fmt::format("{} ms per frame (median), {} ms (99 %), {} ms (maximum); {} times real time",
                  milliseconds(row.frame.p50), milliseconds(row.frame.p99), milliseconds(row.frame.max),
                  short_number(row.realtime_factor(question.rate), 3)));
  facts.emplace_back("deadline", fmt::format("{} of {} frames took more than {} ms{}; one in a thousand may",
                                             row.missed, row.frames, milliseconds(question.frame_budget()),
                                             words_of_disturbed(row.disturbed)));
  for (const ProofRun& run : advice.proof) {
    const bool first = &run == &advice.proof.front();
    facts.emplace_back(
        first ? "long runs" : "",
        fmt::format("{} s, {}: stable{}, {} of {} frames took more than {} ms{}",
                    short_number(run.seconds, 3), first ? "this motion, repeated" : run.motion,
                    run.parts ? " (neighbours part, at shorter steps too: that is the model)" : "",
                    run.missed, run.frames, milliseconds(question.frame_budget()),
                    words_of_disturbed(run.disturbed)));
  }
  std::vector<std::string> iterations;
  if (!std::isnan(row.newton_per_frame))
    iterations.push_back(fmt::format("{} of Newton's method", short_number(row.newton_per_frame)));
  if (!std::isnan(row.linear_per_frame))
    iterations.push_back(fmt::format("{} of conjugate gradients", short_number(row.linear_per_frame)));
  if (!iterations.empty())
    facts.emplace_back("iterations",
                       fmt::format("at most {} in 99.9 % of the frames", fmt::join(iterations, " and ")));
}

/// How much larger the motion may become, as runs showed; empty where none was made.
std::string words_of(const LoadMargin& margin, bool of_body) {
  if (std::isnan(margin.holds))
    return margin.inversion ? "none: " + in_words(*margin.inversion) + " by the loads of the motion" : "";
  const std::string& loads = margin.loads;
  const std::string size =
      of_body ? fmt::format(", which move it by {} mm", milliseconds(margin.displacement)) : "";
  const std::string held = margin.holds > 1 ? fmt::format("stable at {} times the {}{}",
                                                          short_number(margin.holds, 3), loads, size)
                                            : fmt::format("stable at the {} of the motion{}", loads, size);
  if (!std::isfinite(margin.fails)) return held + "; more was not run";
  if (margin.inversion)
    return fmt::format("{}; at {} times {}{}", held, short_number(margin.fails, 3),
                       in_words(*margin.inversion),
                       margin.of_model ? ", with a quarter of the step too: the loads cause it" : "");
  return fmt::format("{}; not at {} times{}", held, short_number(margin.fails, 3),
                     margin.of_model.value_or(false) ? ", where a quarter of the step fails too" : "");
}

/// What the best row shows of the stiffness of a body, beside the fastest row that shows another; empty where
/// neither is off.
std::string words_of_material(const AdviceRow& best, const Advice& advice) {
  const AdviceRow* other = nullptr;
  for (const AdviceRow& row : advice.rows)
    if (&row != &best && shows_other_material(row) && (!other || row.frame.p50 < other->frame.p50))
      other = &row;
  if (std::isnan(best.stiffness_shown) || (!other && !shows_other_material(best))) return {};
  return fmt::format("shows {} of the stiffness{}", percent(best.stiffness_shown),
                     other ? fmt::format("; {}, {} ms per frame, shows {}", other->candidate.words(),
                                         milliseconds(other->frame.p50), percent(other->stiffness_shown))
                           : "");
}

/// The margin to instability, and the damping added to slow modes.
void add_margins(Facts& facts, const Problem& problem, const AdviceRow& row, const Advice& advice) {
  if (!std::isnan(row.stiffening))
    facts.emplace_back("margin", std::isinf(row.stiffening)
                                     ? row.candidate.jacobian.every == JacobianUpdate::frozen
                                           ? "predicted: stable at 64 times the stiffness"
                                           : "predicted: stable at every stiffness"
                                     : fmt::format("predicted: stable up to {} times the stiffness",
                                                   short_number(row.stiffening, 3)));
  if (const std::string loads = words_of(advice.load_margin, problem.body != nullptr); !loads.empty())
    facts.emplace_back(std::isnan(row.stiffening) ? "margin" : "", "observed: " + loads);
  for (const LimitBand& band : advice.bands)
    facts.emplace_back(
        &band == &advice.bands.front() ? "uncertainty" : "",
        fmt::format("h_max {} to {} ms where the {} is {} % less or more", milliseconds(band.low * row.h_max),
                    milliseconds(band.high * row.h_max), band.quantity, short_number(100 * band.spread, 2)));
  if (const std::string material = words_of_material(row, advice); !material.empty())
    facts.emplace_back("material", material);
  if (const std::string modes = words_of_modes(row, advice); !modes.empty())
    facts.emplace_back("slow modes", modes);
  std::vector<std::string> ties;
  for (const AdviceRow& each : advice.rows)
    if (each.verdict == AdviceVerdict::tie)
      ties.push_back(fmt::format("{} at {} ms", each.candidate.words(), milliseconds(each.h, 4)));
  if (!ties.empty()) facts.emplace_back("equally good", fmt::format("{}", fmt::join(ties, "; ")));
}

std::vector<std::string> words_of_remedies(const Advice& advice) {
  std::vector<std::string> words;
  for (const Remedy& remedy : advice.remedies)
    words.push_back(fmt::format("{} {} in place of {}{}: {} with h = {} ms", remedy.change,
                                short_number(remedy.to, 4), short_number(remedy.from, 4),
                                remedy.cost.empty() ? "" : " (" + remedy.cost + ")", remedy.method,
                                milliseconds(remedy.h, 5)));
  return words;
}

/// The row that comes nearest where none suits; empty where none has a number to tell it by.
std::string words_of_nearest(const Advice& advice, const AdviceQuestion& question) {
  if (advice.rows.empty()) return {};
  const AdviceRow& row = advice.rows.front();
  if (std::isnan(row.h)) return {};
  if (std::isnan(row.frame.p50) && !std::isnan(row.expected_frame))
    return fmt::format(
        "Nearest: {} with h = {} ms, at least {} of {} ms per frame, measured on single steps. ",
        row.candidate.words(), milliseconds(row.h, 4), milliseconds(row.expected_frame),
        milliseconds(question.frame_budget()));
  if (!std::isfinite(row.error) || std::isnan(row.frame.p50)) return {};
  return fmt::format("Nearest: {} with h = {} ms, error {}, {} ms of {} ms per frame (median). ",
                     row.candidate.words(), milliseconds(row.h, 4), percent(row.error),
                     milliseconds(row.frame.p50), milliseconds(question.frame_budget()));
}

/// What is said above the remedies.
std::string words_of_help(const Advice& advice, bool interrupted) {
  const bool none = advice.remedies.empty();
  if (interrupted)
    return none ? "Interrupted: no change that was tried so far helps."
                : "Interrupted; what helps, of the changes tried so far:";
  const std::string part = advice.all_tried ? "" : " (not every change was tried: time limit reached)";
  return none ? fmt::format("No change that was tried helps{}.", part)
              : fmt::format("What helps, each tried{}:", part);
}

/// What a search that ended early has left to do; empty of one that has not.
std::string words_of_missing(const Advice& advice, bool interrupted) {
  if (!interrupted && !advice.out_of_time) return {};
  const std::string ended = interrupted ? "interrupted" : "time limit reached";
  const auto not_run = std::ranges::count(advice.rows, AdviceVerdict::predicted, &AdviceRow::verdict);
  const std::string others =
      not_run == 0 ? "" : fmt::format("; {} of {} rows were not run", not_run, advice.rows.size());
  switch (advice.stage) {
    case AdviceStage::predicting:
      return ended + ": nothing was run";
    case AdviceStage::searching:
      return ended +
             (advice.recommended() ? ": the best rows are not timed for long, and not verified"
                                   : ": no method that was run to its end meets this") +
             others;
    case AdviceStage::timing:
      return ended + ": the best rows are not all timed for long, and not verified by long runs" + others;
    case AdviceStage::proving:
      return ended + ": the best rows are timed, but not verified by long runs" + others;
    case AdviceStage::observing:
      return ended + ": not all limits are observed" + others;
    case AdviceStage::remedies:
    case AdviceStage::done:
      break;
  }
  return ended + others;
}

/// What is likely to be the answer where nothing was run to its end: no row whose single steps take more than
/// a frame may.
std::string words_of_prediction(const Advice& advice, const AdviceQuestion& question) {
  const auto row = std::ranges::find_if(advice.rows, [&](const AdviceRow& each) {
    return each.verdict == AdviceVerdict::predicted && !(each.expected_frame > question.frame_budget());
  });
  if (row == advice.rows.end()) return {};
  return fmt::format("Predicted, not run: {} with h = {} ms, {} per frame{}. Take a longer --within",
                     row->candidate.words(), milliseconds(row->h, 4), counted(row->steps_per_frame, "step"),
                     std::isnan(row->expected_frame)
                         ? ""
                         : fmt::format(", at least {} of {} ms per frame", milliseconds(row->expected_frame),
                                       milliseconds(question.frame_budget())));
}

/// The median; of a row that was not run what is expected at least.
std::string words_of_frame(const AdviceRow& row) {
  if (!std::isnan(row.frame.p50) || std::isnan(row.expected_frame)) return milliseconds(row.frame.p50);
  return ">= " + milliseconds(row.expected_frame);
}

/// @param records  of the rows
std::vector<std::vector<std::string>> table_of(const Advice& advice,
                                               const std::vector<AdviceRecord>& records) {
  std::vector<std::vector<std::string>> table{{"method", "h [ms]", "steps", "h_max [ms]", "observed [ms]",
                                               "error", "frame [ms]", "p99 [ms]", "bound", "verdict"}};
  const bool of_material = std::ranges::any_of(advice.rows, shows_other_material);
  if (of_material) table.front().insert(table.front().begin() + 6, "stiffness");
  for (std::size_t i = 0; i < records.size(); ++i) {
    const AdviceRecord& row = records[i];
    table.push_back({row.words(), milliseconds(row.h, 4), fmt::format("{:.0f}", row.steps_per_frame),
                     milliseconds(row.h_max, 4), milliseconds(row.h_max_observed), percent(row.error),
                     words_of_frame(advice.rows[i]), milliseconds(row.frame_p99), row.bound, row.verdict});
    if (of_material) table.back().insert(table.back().begin() + 6, percent(advice.rows[i].stiffness_shown));
  }
  return table;
}

/// What is said of the rows of which something holds, each sentence once.
std::vector<std::string> statuses_of(const std::vector<AdviceRecord>& rows,
                                     const std::function<bool(const AdviceRecord&)>& holds) {
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  for (const AdviceRecord& row : rows) {
    if (row.status.empty() || !holds(row)) continue;
    const auto same =
        std::ranges::find(reasons, row.status, &std::pair<std::string, std::vector<std::string>>::first);
    (same == reasons.end() ? reasons.emplace_back(row.status, std::vector<std::string>{}) : *same)
        .second.push_back(row.words());
  }
  std::vector<std::string> lines;
  for (const auto& [reason, methods] : reasons)
    lines.push_back(fmt::format("{}: {}", fmt::join(methods, "; "), reason));
  return lines;
}

/// What the dashes of the table stand for.
std::vector<std::string> notes_of(const std::vector<AdviceRecord>& rows) {
  const auto lacks = [](const AdviceRecord& row) {
    return std::isnan(row.h_max) || (std::isfinite(row.h_max) && std::isnan(row.h_max_observed));
  };
  std::vector<std::string> notes =
      statuses_of(rows, [&](const AdviceRecord& row) { return row.suits() && lacks(row); });
  const bool unbounded =
                 std::ranges::any_of(rows, [](const AdviceRecord&row) { return std::isinf(row.h_max); }),
             unsuitable = std::ranges::any_of(
                 rows, [&](const AdviceRecord&row) { return !row.suits() && lacks(row); });
  std::string words;
  if (unbounded) words = "methods without a limit";
  if (unsuitable) words += std::string(words.empty() ? "" : " and ") + "methods that do not suit";
  if (!words.empty()) notes.push_back(fmt::format("observed -: no limit is sought of {}", words));
  return notes;
}

}  // namespace

AdviceText words_of(const Problem& problem, const AdviceQuestion& question, const Advice& advice,
                    bool interrupted) {
  AdviceText text;
  text.model = fmt::format("{}{}{}", problem.id, problem.material.empty() ? "" : ", ", problem.material);
  if (problem.body) text.body = in_words(summary_of(*problem.body));
  if (advice.suggested_support) text.body += "; " + in_words(*advice.suggested_support);
  text.motion = !advice.motion.empty() ? advice.motion
                : advice.stage == AdviceStage::done
                    ? "no motion was run: single steps are too slow or unstable"
                    : "no motion was run";
  text.question = fmt::format(
      "{} Hz, error at most {} of the {}{}, frames of at most {} ms; best is {}", short_number(question.rate),
      percent(question.tolerance), error_scale(problem),
      problem.body && advice.scale > 0
          ? fmt::format(" ({} mm from the start of the motion)", milliseconds(advice.scale))
          : "",
      milliseconds(question.frame_budget()),
      question.least_error ? "the smallest error" : fmt::format("the lowest {}", time_word(question)));
  const std::string missing = words_of_missing(advice, interrupted);
  if (const AdviceRow* best = advice.recommended()) {
    text.answer = words_of_step(*best);
    if (!missing.empty()) text.facts.emplace_back("caution", missing);
    add_cautions(text.facts, advice, *best, question);
    add_measured(text.facts, problem, *best, advice, question);
    add_margins(text.facts, problem, *best, advice);
  } else if (!missing.empty() && advice.stage < AdviceStage::remedies) {
    text.answer = missing;
    text.help = words_of_prediction(advice, question);
  } else {
    text.answer = "no method that was tried meets this";
    text.help = words_of_nearest(advice, question) + words_of_help(advice, interrupted);
    text.remedies = words_of_remedies(advice);
  }
  const std::vector<AdviceRecord> rows = advice_records(advice);
  text.table = table_of(advice, rows);
  text.reasons = statuses_of(rows, [](const AdviceRecord& row) { return !row.suits(); });
  text.notes = notes_of(rows);
  text.machine = summary(fingerprint());
  return text;
}

std::string words_of_first_answer(const Problem& problem, const AdviceQuestion& question,
                                  const Advice& advice, const Console& console) {
  TextTable table({"method", "h [ms]", "steps", "h_max [ms]", "frame [ms]", "verdict"});
  for (const AdviceRow& row : advice.rows)
    table.add({row.candidate.words(), milliseconds(row.h, 4), fmt::format("{}", row.steps_per_frame),
               milliseconds(row.h_max, 4), words_of_frame(row), std::string(name_of(row.verdict))});
  return fmt::format(
      "{}: first answer, predicted from the modes of the initial state and the time of single steps; accuracy may ask for "
      "more steps\n{}\nThe answer of runs follows{}.\n\n",
      problem.id, table.text(console),
      std::isfinite(question.within) ? fmt::format(" within {} s", short_number(question.within)) : "");
}

std::string for_people(const AdviceText& text, const Console& console) {
  std::string all =
      fmt::format("{}: {}\n{}{}\n\n{}\n", text.model, text.motion, text.body.empty() ? "" : text.body + "\n",
                  text.question, console.strong(text.answer));
  for (const auto& [name, words] : text.facts) all += fmt::format("  {:<13} {}\n", name, words);
  if (!text.help.empty()) all += text.help + "\n";
  for (const std::string& remedy : text.remedies) all += "  " + remedy + "\n";
  TextTable table(text.table.front());
  for (std::size_t i = 1; i < text.table.size(); ++i) table.add(text.table[i]);
  all += "\n" + table.text(console) + "\n";
  for (const std::string& reason : text.reasons) all += reason + "\n";
  for (const std::string& note : text.notes) all += note + "\n";
  all += console.faint(text.machine) + "\n";
  return text.left_out.empty() ? all : all + text.left_out + "\n";
}

}  // namespace hmax
