/// hmax advise: which integrator, and how large a step, for a model and a frame rate.
#include <algorithm>
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/advice/advice_records.hpp"
#include "bench/advice/advise.hpp"
#include "bench/models/support_sets.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/stability.hpp"
#include "results/errors.hpp"
#include "results/fingerprint.hpp"
#include "results/numbers.hpp"
#include "results/store.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

struct AdviseOptions {
  ProblemChoice problem;
  std::optional<double> rate, tolerance, budget;
  std::string methods, frames, out, motion;
  std::vector<std::string> motion_at;
};

double positive(const char* option, double value, const char* example) {
  if (!(value > 0 && std::isfinite(value)))
    throw InputError(fmt::format("{} is {} but must be positive, such as {}", option, to_text(value), example));
  return value;
}

AdviceQuestion question_of(const AdviseOptions& options, const Problem& problem) {
  if (!options.rate) throw InputError("no frame rate is given; add --rate, such as --rate 100");
  AdviceQuestion question;
  question.rate = positive("--rate", *options.rate, "100");
  if (question.rate < 1 || question.rate > 1e5)
    throw InputError(fmt::format("--rate is {} Hz, but must lie between 1 and 100000", to_text(question.rate)));
  if (options.tolerance) {
    question.tolerance = positive("--tolerance", *options.tolerance, "0.01");
    if (question.tolerance >= 1)
      throw InputError("--tolerance is relative to the largest displacement and must be below 1, such as 0.01");
  }
  if (options.budget) question.budget = positive("--budget", *options.budget, "5") / 1000;
  question.least_error = options.budget && !options.tolerance;
  if (!options.frames.empty())
    question.frames = static_cast<std::size_t>(
        std::min<std::int64_t>(parse_count("--frames", options.frames, 1), 1'000'000));
  if (!options.motion_at.empty() && options.motion.empty())
    throw InputError("--motion-at names the points of --motion; add a file of forces or displacements");
  if (!options.motion.empty()) {
    question.motion = read_user_motion(options.motion);
    if (!options.motion_at.empty()) {
      if (options.problem.body.mesh.empty()) throw InputError("--motion-at names points of --mesh; name a mesh");
      question.motion->points = points_of_sets(
          options.motion_at, load_mesh(options.problem.body.mesh, options.problem.body.metres()));
    }
  }
  question.methods = options.methods.empty()
                         ? choose_methods(simulator_methods(), {problem})
                         : choose_methods(with_their_parameters(parse_names("--methods", options.methods)), {problem});
  return question;
}

/// What errors are relative to.
std::string error_scale(const Problem& problem) {
  return problem.body ? "largest displacement" : "range of each state";
}

// ---- for programs

Json to_json(const AdviceRow& row, const AdviceQuestion& question, const std::string& error_of) {
  const auto numbers = [](const std::vector<double>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(number_or_word(value));
    return list;
  };
  Json options = Json::object();
  if (row.candidate.method.needs_jacobian) {
    options["jacobian"] = to_string(row.candidate.jacobian);
    options["linear"] = to_string(row.candidate.linear_solve);
  }
  if (!std::isnan(row.newton_per_frame)) options["iterations"] = row.newton_per_frame;
  return {{"method", row.candidate.method.id},
          {"options", std::move(options)},
          {"h", number_or_word(row.h)},
          {"steps_per_frame", row.steps_per_frame},
          {"h_max", number_or_word(row.h_max)},
          {"h_max_observed", number_or_word(row.h_max_observed)},
          {"h_accurate", number_or_word(row.h_accurate)},
          {"bound", name_of(row.bound)},
          {"error", number_or_word(row.error)},
          {"error_of", error_of},
          {"frame_ms",
           {{"p50", number_or_word(1e3 * row.frame.p50)},
            {"p99", number_or_word(1e3 * row.frame.p99)},
            {"max", number_or_word(1e3 * row.frame.max)},
            {"first", number_or_word(1e3 * row.first_frame)}}},
          {"missed", row.missed},
          {"frames", row.frames},
          {"realtime_factor", number_or_word(row.realtime_factor(question.rate))},
          {"memory_bytes", row.memory ? Json(*row.memory) : Json()},
          {"damping_added", numbers(row.damping_added)},
          {"frequency_shift", numbers(row.frequency_shift)},
          {"margin", {{"stiffening", number_or_word(row.stiffening)}}},
          {"verdict", name_of(row.verdict)},
          {"status", row.status}};
}

Json to_json(const std::vector<ProofRun>& proof) {
  Json list = Json::array();
  for (const ProofRun& run : proof)
    list.push_back({{"motion", run.motion},
                    {"seconds", run.seconds},
                    {"stable", run.stable},
                    {"frames", run.frames},
                    {"missed", run.missed},
                    {"frame_ms_p999", number_or_word(1e3 * run.frame_p999)}});
  return list;
}

/// @param h_max  that the bands are of [s]
Json to_json(const std::vector<LimitBand>& bands, double h_max) {
  Json list = Json::array();
  for (const LimitBand& band : bands)
    list.push_back({{"quantity", band.quantity},
                    {"spread", band.spread},
                    {"h_max_low", band.low * h_max},
                    {"h_max_high", band.high * h_max},
                    {"exponent", band.exponent}});
  return list;
}

Json to_json(const Problem& problem, const AdviceQuestion& question, const Advice& advice) {
  Json rows = Json::array(), ties = Json::array(), remedies = Json::array();
  for (const AdviceRow& row : advice.rows) {
    rows.push_back(to_json(row, question, error_scale(problem)));
    if (row.verdict == AdviceVerdict::tie) ties.push_back(row.candidate.words());
  }
  for (const Remedy& remedy : advice.remedies)
    remedies.push_back({{"change", remedy.change},
                        {"from", remedy.from},
                        {"to", remedy.to},
                        {"cost", remedy.cost},
                        {"then", {{"method", remedy.method}, {"h", remedy.h}}}});
  Json parameters = Json::object();
  for (const auto& [name, value] : problem.parameters) parameters[name] = value;
  const AdviceRow* best = advice.recommended();
  return {{"model", problem.id},
          {"material", problem.material},
          {"parameters", std::move(parameters)},
          {"motion", advice.motion},
          {"scale", advice.scale},
          {"reference_error", advice.reference_error},
          {"modes", advice.modes},
          {"rate", question.rate},
          {"tolerance", question.tolerance},
          {"budget_ms", 1e3 * question.frame_budget()},
          {"machine", summary(fingerprint())},
          {"rows", std::move(rows)},
          {"proof", to_json(advice.proof)},
          {"uncertainty", to_json(advice.bands, best ? best->h_max : AdviceRow::none)},
          {"recommended", best ? to_json(*best, question, error_scale(problem)) : Json()},
          {"ties", std::move(ties)},
          {"remedies", std::move(remedies)}};
}

// ---- for people

std::string milliseconds(double seconds, int digits = 3) {
  if (std::isnan(seconds)) return "-";
  return std::isinf(seconds) ? "unbounded" : short_number(1e3 * seconds, digits);
}

std::string percent(double share) {
  return std::isfinite(share) ? short_number(100 * share, 2) + " %" : "-";
}

/// What keeps the step from being longer.
std::string words_of_bound(const AdviceRow& row) {
  switch (row.bound) {
    case AdviceBound::stability:
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
      words += fmt::format("{}{} rad/s: damping ratio {:+.2g}, frequency {:+.2g} %", words.empty() ? "" : "; ",
                           short_number(advice.modes[i], 3), row.damping_added[i], 100 * row.frequency_shift[i]);
  return words;
}

std::string words_of_limit(const AdviceRow& row) {
  if (std::isinf(row.h_max)) return "stable at every step size (linearised model)";
  if (std::isnan(row.h_max)) return "no limit is predicted; stable in the run";
  const std::string seen = std::isnan(row.h_max_observed)
                               ? "growth just beyond it is too slow to be observed"
                               : milliseconds(row.h_max_observed) + " ms observed";
  return fmt::format("h_max {} ms predicted, the smallest along the motion; {}", milliseconds(row.h_max, 4), seen);
}

std::string words_of_best(const Problem& problem, const AdviceRow& row, const Advice& advice,
                          const AdviceQuestion& question, const Console& console) {
  const auto line = [](std::string_view name, const std::string& words) {
    return fmt::format("  {:<13} {}\n", name, words);
  };
  std::string text = console.strong(fmt::format("take {} with h = {} ms, {} step{} per frame", row.candidate.words(),
                                                milliseconds(row.h, 5), row.steps_per_frame,
                                                row.steps_per_frame == 1 ? "" : "s")) +
                     "\n";
  text += line("stability", words_of_limit(row));
  text += line("limited by", words_of_bound(row));
  text += line("error", fmt::format("{} of the {}", percent(row.error), error_scale(problem)));
  text += line("CPU time", fmt::format("{} ms per frame (median), {} ms (99 %), {} ms (maximum); {} times real time",
                                       milliseconds(row.frame.p50), milliseconds(row.frame.p99),
                                       milliseconds(row.frame.max), short_number(row.realtime_factor(question.rate), 3)));
  text += line("deadline", fmt::format("{} of {} frames took more than {} ms", row.missed, row.frames,
                                       milliseconds(question.frame_budget())));
  for (const ProofRun& run : advice.proof)
    text += line(&run == &advice.proof.front() ? "long runs" : "",
                 fmt::format("{} s, {}: stable, {} of {} frames took more than {} ms",
                             short_number(run.seconds, 3),
                             &run == &advice.proof.front() ? "this motion, repeated" : run.motion, run.missed,
                             run.frames, milliseconds(question.frame_budget())));
  if (!std::isnan(row.newton_per_frame))
    text += line("iterations", fmt::format("at most {} of Newton's method in 99.9 % of the frames",
                                           short_number(row.newton_per_frame)));
  if (!std::isnan(row.stiffening))
    text += line("margin", std::isinf(row.stiffening)
                               ? "stable at every stiffness"
                               : fmt::format("stable up to {} times the stiffness", short_number(row.stiffening, 3)));
  for (const LimitBand& band : advice.bands)
    text += line(&band == &advice.bands.front() ? "uncertainty" : "",
                 fmt::format("h_max {} to {} ms where the {} is {} % less or more{}", milliseconds(band.low * row.h_max),
                             milliseconds(band.high * row.h_max), band.quantity, short_number(100 * band.spread, 2),
                             band.low * row.h_max < row.h ? ": at the lower end the step is unstable" : ""));
  if (const std::string modes = words_of_modes(row, advice); !modes.empty()) text += line("slow modes", modes);
  return text;
}

std::string words_of_remedies(const Advice& advice) {
  if (advice.remedies.empty()) return "No change that was tried helps.\n";
  std::string text = "What helps, each tried:\n";
  for (const Remedy& remedy : advice.remedies)
    text += fmt::format("  {} {} in place of {}{}: {} with h = {} ms\n", remedy.change, short_number(remedy.to),
                        short_number(remedy.from), remedy.cost.empty() ? "" : " (" + remedy.cost + ")", remedy.method,
                        milliseconds(remedy.h, 5));
  return text;
}

std::string table_of(const Advice& advice, const Console& console) {
  TextTable table({"method", "h [ms]", "steps", "h_max [ms]", "observed [ms]", "error", "frame [ms]", "p99 [ms]",
                   "bound", "verdict"});
  for (const AdviceRow& row : advice.rows)
    table.add({row.candidate.words(), milliseconds(row.h, 4), std::to_string(row.steps_per_frame),
               milliseconds(row.h_max, 4), milliseconds(row.h_max_observed), percent(row.error),
               milliseconds(row.frame.p50), milliseconds(row.frame.p99), std::string(name_of(row.bound)),
               std::string(name_of(row.verdict))});
  return table.text(console);
}

/// Why rows do not suit, each reason once.
std::string words_of_reasons(const Advice& advice) {
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  for (const AdviceRow& row : advice.rows) {
    if (row.status.empty() || row.verdict < AdviceVerdict::unstable) continue;
    const auto same = std::ranges::find(reasons, row.status, &std::pair<std::string, std::vector<std::string>>::first);
    (same == reasons.end() ? reasons.emplace_back(row.status, std::vector<std::string>{}) : *same)
        .second.push_back(row.candidate.words());
  }
  std::string text;
  for (const auto& [reason, methods] : reasons) text += fmt::format("{}: {}\n", fmt::join(methods, "; "), reason);
  return text;
}

/// Methods that were asked for and do not step this problem.
std::string words_of_left_out(const AdviseOptions& options, const Problem& problem) {
  if (!options.methods.empty()) return {};
  std::vector<std::string> names;
  for (const std::string& name : simulator_methods())
    if (!suits(find_method(name), problem)) names.push_back(name);
  return names.empty() ? ""
                       : fmt::format("left out: {}, which need positions and velocities or a stiff part that the "
                                     "problem does not declare\n",
                                     fmt::join(names, ", "));
}

std::string for_people(const Problem& problem, const AdviceQuestion& question, const Advice& advice,
                       const Console& console) {
  std::string text =
      fmt::format("{}{}{}: {}\n", problem.id, problem.material.empty() ? "" : ", ", problem.material, advice.motion);
  text += fmt::format("{} Hz, error at most {} of the {}{}, frames of at most {} ms\n\n",
                      short_number(question.rate), percent(question.tolerance), error_scale(problem),
                      problem.body ? fmt::format(", {} mm", milliseconds(advice.scale)) : "",
                      milliseconds(question.frame_budget()));
  if (const AdviceRow* best = advice.recommended()) {
    text += words_of_best(problem, *best, advice, question, console);
    std::vector<std::string> ties;
    for (const AdviceRow& row : advice.rows)
      if (row.verdict == AdviceVerdict::tie)
        ties.push_back(fmt::format("{} at {} ms", row.candidate.words(), milliseconds(row.h, 4)));
    if (!ties.empty()) text += fmt::format("  {:<13} {}\n", "equally good", fmt::join(ties, "; "));
  } else {
    text += console.strong("no method that was tried meets this") + "\n" + words_of_remedies(advice);
  }
  return text + "\n" + table_of(advice, console) + "\n" + words_of_reasons(advice) + console.faint(summary(fingerprint())) + "\n";
}

Remaking remaking(const ProblemChoice& choice) {
  Remaking make;
  make.with = [&](const std::vector<std::pair<std::string, double>>& values) {
    ProblemChoice changed = choice;
    for (const auto& [name, value] : values) {
      std::erase_if(changed.set, [&](const std::string& text) { return text.starts_with(name + "="); });
      changed.set.push_back(name + "=" + to_text(value));
    }
    return changed.make();
  };
  if (const std::string coarser = coarser_mesh(choice.body.mesh); !coarser.empty())
    make.coarser = [&choice, coarser] {
      ProblemChoice changed = choice;
      changed.body.mesh = coarser;
      return changed.make();
    };
  return make;
}

void advise_on(const AdviseOptions& options, Console& console) {
  const Problem problem = options.problem.make();
  const AdviceQuestion question = question_of(options, problem);
  remark_unusual(console, problem);
  options.problem.remark_idle(console, problem);
  Advice advice;
  {
    Progress progress(console, "advise");
    const auto& interrupted = interrupt_flag();
    const AdviceWatcher watcher = [&](double share, const std::string& what) {
      if (interrupted) throw Interrupted{};
      progress.update(share, what);
    };
    const Remaking make = remaking(options.problem);
    advice = advise(problem, question, watcher, make.with);
    if (!advice.recommended())
      find_remedies(
          problem, question, advice, make,
          [&](double share, const std::string& what) { watcher(share, "what would help: " + what); });
  }
  if (!advice.recommended()) console.exit_code = Exit::failed;
  if (!options.out.empty()) {
    Store store = Store::open_or_create(store_path(options.out));
    store.begin_session(fingerprint());
    store.insert_advice(advice_key(problem, question, advice), advice_records(advice));
  }
  if (console.json) return console.print_json(to_json(problem, question, advice));
  console.print(for_people(problem, question, advice, console) + words_of_left_out(options, problem));
}

}  // namespace

void add_advise(CLI::App& app, Console& console) {
  CLI::App& command = add_command(
      app, console, "advise",
      "Which integrator, and how large a step: for a model and a frame rate; exit 1 where nothing suits",
      {"hmax advise --mesh liver --material male_normal --rate 100",
       "hmax advise --mesh phantom --load tool --rate 1000 --budget 0.5 --json",
       "hmax advise --problem liver_forced --rate 100 --tolerance 1e-3"});
  const auto options = std::make_shared<AdviseOptions>();
  options->problem.add_to(command);
  add_number(command, "--rate", options->rate, "Frame rate [Hz]; required");
  add_number(command, "--tolerance", options->tolerance,
             "Largest error of the motion, relative to the largest displacement of a body, or to the range of each "
             "state [1]; 0.01 by default");
  add_number(command, "--budget", options->budget,
             "CPU time that a frame may take [ms]; given without --tolerance, methods are ranked by error; the whole frame by "
             "default");
  command
      .add_option("--methods", options->methods,
                  fmt::format("Ids, aliases or families of `hmax list methods`, or all; {} by default",
                              fmt::join(simulator_methods(), ", ")))
      ->type_name("A,B");
  command.add_option("--frames", options->frames, "Number of frames that the best methods are timed for; 1000 by default")
      ->type_name("N");
  command
      .add_option("--motion", options->motion,
                  "Motion of a body in place of the probing motion: CSV with the columns t [s] and fx, fy, fz [N] or x, "
                  "y, z [m], forces or displacements")
      ->type_name("FILE");
  command
      .add_option("--motion-at", options->motion_at,
                  "Points that --motion acts on, as --support; the far end of the body by default; may be repeated")
      ->type_name("SET")
      ->take_all()
      ->allow_extra_args(false);
  command
      .add_option("--out", options->out,
                  "Store of the advice, one row a method: a file that ends in .sqlite, or a name under results/runs; none "
                  "by default")
      ->type_name("STORE");
  command.callback([options, &console] { advise_on(*options, console); });
}

}  // namespace hmax
