/// hmax advise: which integrator, and how large a step, for a model and a frame rate.
#include "advice/advise.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "advice/advice_json.hpp"
#include "advice/motion/candidate.hpp"
#include "advice/remaking.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/chosen_methods.hpp"
#include "catalogue/methods/unsuited.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/support_sets.hpp"
#include "catalogue/models/tissue_choice.hpp"
#include "catalogue/scenes/scene.hpp"
#include "cli/advice/advice_page.hpp"
#include "cli/advice/advice_words.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/device_option.hpp"
#include "cli/shared/mpirun.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/shared/work_limit.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/process/leaving.hpp"
#include "plots/pages/answer_words.hpp"
#include "problems/tissue/sofa_scene.hpp"
#include "results/fingerprint.hpp"
#include "results/store.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

struct AdviseOptions {
  ProblemChoice problem;
  DeviceChoice device;
  std::optional<double> rate, tolerance, budget, within;
  std::string methods, frames, out, output, motion;
  std::vector<std::string> motion_at;
};

/// Frames of a motion of the user's: days at 100 Hz.
constexpr double most_motion_frames = 1e7;

double positive(const char* option, double value, const char* example) {
  if (!(value > 0 && std::isfinite(value)))
    throw InputError(
        fmt::format("{} is {} but must be positive, such as {}", option, to_text(value), example));
  return value;
}

/// The methods of --methods; what is left out of families is warned of.
std::vector<Method> named_methods(const AdviseOptions& options, const Problem& problem, Console& console) {
  ChosenMethods chosen = chosen_methods(parse_names("--methods", options.methods), {problem});
  std::vector<LeftOut> not_tried;
  for (const Method& method : chosen.methods)
    if (std::string why = why_no_candidate(method, problem); !why.empty())
      not_tried.push_back({method.id, std::move(why)});
  // Where nothing is tried the error says so alone.
  if (not_tried.size() < chosen.methods.size())
    chosen.left_out.insert(chosen.left_out.end(), not_tried.begin(), not_tried.end());
  warn_of_left_out(console, chosen.left_out);
  return std::move(chosen.methods);
}

/// Puts the methods on the device; what it does not run is left out, with a warning where a user has named
/// it.
/// @throws InputError  where it runs none
void place_on_device(const AdviseOptions& options, const Problem& problem, AdviceQuestion& question,
                     Console& console) {
  if (!options.device.is_gpu()) return;
  if (question.motion && question.motion->kind == UserMotion::Kind::displacements)
    throw InputError(
        "--device gpu moves no points, which the displacements of --motion do; leave one of them out");
  std::vector<LeftOut> left_out;
  question.device = options.device.place({problem}, question.methods, left_out);
  std::erase_if(question.methods, [](const Method& method) { return !method.device; });
  if (!options.methods.empty()) warn_of_left_out(console, left_out);
}

/// Whether a scene of SOFA is asked for, else a page.
bool writes_scene(const AdviseOptions& options) {
  return std::filesystem::path(options.output).extension() == ".scn";
}

/// Leaves out the methods that SOFA does not step this body with, before the minutes of the search.
/// @throws InputError  for one that the user names, and where none is left
void keep_methods_of_sofa(const AdviseOptions& options, const Problem& problem,
                          std::vector<Method>& methods) {
  const TissueBody& body = require_body(
      problem, "and FILE.scn is a scene of a body for SOFA; name a mesh with --mesh, or write FILE.html");
  std::string refusal;
  std::erase_if(methods, [&](const Method& method) {
    try {
      check_sofa_scene(body.settings(), sofa_step(method.id, 1));
      return false;
    } catch (const std::invalid_argument& error) {
      refusal = error.what();
    } catch (const InputError& error) {
      refusal = error.what();
    }
    return true;
  });
  if (!refusal.empty() && (methods.empty() || !options.methods.empty())) throw InputError(refusal);
}

/// The body with the method and the step that are recommended.
void write_scene(const AdviseOptions& options, const Problem& problem, const Advice& advice,
                 Console& console) {
  const AdviceRow* const row = advice.recommended();
  if (!row)
    return console.remark(fmt::format("{} is not written, as nothing is recommended", options.output));
  write_file(options.output, sofa_text(*problem.body, sofa_step(row->candidate.method.id, row->h)));
  if (const std::string chosen = row->candidate.options(); !chosen.empty())
    console.remark(fmt::format("SOFA solves its equations anew in every step, and not with {}", chosen));
  if (!console.json) console.print(fmt::format("\nOpen {} with SOFA\n", options.output));
}

AdviceQuestion question_of(const AdviseOptions& options, const Problem& problem, Console& console) {
  if (!options.rate) throw InputError("no frame rate is given; add --rate, such as --rate 100");
  AdviceQuestion question;
  question.rate = positive("--rate", *options.rate, "100");
  if (question.rate < 1e-4 || question.rate > 1e5)
    throw InputError(
        fmt::format("--rate is {} Hz, but must lie between 0.0001 and 100000", to_text(question.rate)));
  if (options.tolerance) {
    question.tolerance = positive("--tolerance", *options.tolerance, "0.01");
    if (question.tolerance >= 1)
      throw InputError(
          "--tolerance is relative to the largest displacement and must be below 1, such as 0.01");
    if (question.tolerance < 1e-10)
      throw InputError(fmt::format("--tolerance is {}, which no reference reaches; give 1e-10 or more",
                                   to_text(question.tolerance)));
  }
  if (options.budget) question.budget = positive("--budget", *options.budget, "5") / 1000;
  // Frames are written with few digits, such as 16.67.
  if (question.budget && *question.budget > 1.05 * question.frame())
    throw InputError(fmt::format("--budget is {} ms, and a frame has {} ms; give less, or leave it out",
                                 to_text(*options.budget), short_number(1000 * question.frame())));
  if (question.budget) question.budget = std::min(*question.budget, question.frame());
  question.least_error = options.budget && !options.tolerance;
  question.within = positive("--within", options.within.value_or(60), "60");
  if (!options.frames.empty()) {
    constexpr std::int64_t most = 1'000'000;
    const std::int64_t frames = parse_count("--frames", options.frames, 1);
    if (frames > most) throw InputError(fmt::format("--frames is {}; time {} frames at most", frames, most));
    question.frames = static_cast<std::size_t>(frames);
  }
  if (!options.motion_at.empty() && options.motion.empty())
    throw InputError("--motion-at names the points of --motion; add a file of forces or displacements");
  if (!options.motion.empty()) {
    question.motion = read_user_motion(options.motion);
    refuse_endless({.asked = fmt::format("--motion of {} s at --rate {}", to_text(question.motion->t_end),
                                         to_text(question.rate)),
                    .count = question.motion->t_end * question.rate,
                    .of = "frames",
                    .most_count = most_motion_frames,
                    .remedy = "take a shorter motion"});
    if (!options.motion_at.empty()) {
      if (!options.problem.body.is_given())
        throw InputError("--motion-at names points of --mesh; name a mesh");
      question.motion->points = points_of_sets(
          options.motion_at, load_mesh(TissueId(problem.id).mesh, options.problem.body.metres(),
                                       element_nodes(TissueId(problem.id))));
    }
  }
  question.methods =
      options.methods.empty()
          ? choose_methods(writes_scene(options) ? sofa_methods() : simulator_methods(), {problem})
          : named_methods(options, problem, console);
  if (writes_scene(options)) keep_methods_of_sofa(options, problem, question.methods);
  place_on_device(options, problem, question, console);
  return question;
}

/// Methods that were asked for and do not step this problem.
std::string words_of_left_out(const AdviseOptions& options, const Problem& problem) {
  if (!options.methods.empty()) return {};
  std::vector<LeftOut> left_out;
  for (const std::string& name : simulator_methods()) {
    const Method method = find_method(name);
    if (!problem.body && method.unsuited) continue;  // of bodies alone
    std::string why = why_unsuited(method, problem);
    if (why.empty() && options.device.is_gpu()) why = unsuited_for_device(problem, method);
    if (!why.empty()) left_out.push_back({name, std::move(why)});
  }
  return left_out.empty() ? "" : fmt::format("left out: {}", fmt::join(in_words(left_out), "; "));
}

/// @throws InputError  for a store or a page that cannot have its name, and for a file that is no store
void check_names(const AdviseOptions& options) {
  std::error_code ignored;
  if (!options.out.empty())
    if (const std::filesystem::path store = store_path(options.out); std::filesystem::exists(store, ignored))
      (void)Store::open_existing(store);
  if (!options.output.empty() && !writes_scene(options)) check_page_name(options.output, "advice.html");
}

/// Whether a row is more than a prediction.
bool has_finished_rows(const Advice& advice) {
  return !std::ranges::all_of(advice.rows,
                              [](const AdviceRow& row) { return row.verdict == AdviceVerdict::predicted; });
}

/// Fills the answer; what would help is sought where nothing is recommended.
/// @returns what ended the search early, Interrupted after Ctrl-C: what is finished is in `advice`; else null
/// @throws the same when nothing is, but after Ctrl-C, when JSON is told so too
std::exception_ptr search(const AdviseOptions& options, const Problem& problem,
                          const AdviceQuestion& question, Advice& advice, Console& console) {
  constexpr double soon = 2;  // [s]
  Progress progress(console, "advise");
  const auto& interrupted = interrupt_flag();
  const LeavesIterations leaves(interrupted, [] { throw Interrupted{"no method was finished"}; });
  const double begun = elapsed_seconds();
  bool waits = !console.json;  // whether people may still wait for a first answer
  Advice first;                // its rows, which the search changes
  const AdviceWatcher watcher = [&](double share, const std::string& what) {
    if (interrupted) throw Interrupted{"no method was finished"};
    if (waits && first.rows.empty() && advice.stage == AdviceStage::searching) first.rows = advice.rows;
    if (waits && advice.stage == AdviceStage::searching && elapsed_seconds() - begun > soon) {
      progress.clear();
      console.print(words_of_first_answer(problem, question, first, console));
      console.flush();
      waits = false;
    }
    progress.update(share, what);
  };
  try {
    const Remaking make = remaking(options.problem.id(), options.problem.settings());
    advise(problem, question, advice, watcher, make.with);
    if (!advice.recommended())
      find_remedies(problem, question, advice, make, [&](double share, const std::string& what) {
        watcher(share, "what would help: " + what);
      });
  } catch (...) {
    // An error in place of predictions alone; Ctrl-C shows them.
    if (!(interrupted ? console.json || !advice.rows.empty() : has_finished_rows(advice))) throw;
    return std::current_exception();
  }
  return nullptr;
}

/// Whether it was Ctrl-C. @throws what it was otherwise
bool was_interrupted(const std::exception_ptr& end) {
  if (!end) return false;
  try {
    std::rethrow_exception(end);
  } catch (const Interrupted&) {
    return true;
  }
}

/// Whether a store has an answer to this question whose search was not interrupted.
bool has_whole_answer(const Store& store, const AdviceKey& key) {
  return std::ranges::any_of(store.advice(),
                             [&](const AdviceRecord& row) { return row.key == key && row.stage == "done"; });
}

/// Behind the answer itself, which is not lost when something cannot be written. A whole answer in the store
/// is not replaced by the part that an interrupted search has found.
void keep(const AdviseOptions& options, const Problem& problem, const AdviceQuestion& question,
          const Advice& advice, const AdviceText& text, Console& console) {
  if (options.out.empty() && options.output.empty()) return;
  console.flush();
  const AdviceKey key = advice_key(problem, question, advice);
  const std::vector<AdviceRecord> rows = advice_records(advice);
  const std::string scene = problem.body && advice.model ? body_scene_text(*advice.model) : "";
  std::exception_ptr page_failure;  // the store is written all the same
  try {
    if (writes_scene(options)) {
      write_scene(options, problem, advice, console);
    } else if (!options.output.empty()) {
      write_advice_page(options.output, text, key, rows, scene);
      if (!console.json) console.print(fmt::format("\nOpen {}\n", options.output));
    }
  } catch (const InputError&) {
    page_failure = std::current_exception();
  }
  if (!options.out.empty()) {
    Store store = Store::open_or_create(store_path(options.out));
    if (advice.stage != AdviceStage::done && has_whole_answer(store, key)) {
      console.note(fmt::format("{} keeps the whole answer that it has to this question",
                               store.file().generic_string()));
    } else {
      store.begin_session(fingerprint());
      store.insert_advice(key, rows, scene, answer_text(text));
      if (!console.json) console.print(fmt::format("\nStored in {}\n", store.file().generic_string()));
    }
  }
  if (page_failure) std::rethrow_exception(page_failure);
}

void advise_on(const AdviseOptions& options, Console& console) {
  if (!options.out.empty()) refuse_copies("hmax advise --out");
  // Stores and pages have CPU times.
  options.device.check({{"--out", !options.out.empty()}, {"--output", !options.output.empty()}});
  check_names(options);
  const Problem problem = options.problem.make();
  const AdviceQuestion question = question_of(options, problem, console);
  // Before the minutes of the search, and behind the files that are read, which are no outputs.
  if (!options.output.empty()) check_writable(options.output);
  remark_unusual(console, problem);
  options.problem.remark_idle(console, problem);
  Advice advice;
  const std::exception_ptr end = search(options, problem, question, advice, console);
  const bool finished = end == nullptr;
  if (!advice.recommended()) console.exit_code = Exit::failed;
  AdviceText text = words_of(problem, question, advice, !finished);
  text.left_out = words_of_left_out(options, problem);
  if (console.json) {
    (void)was_interrupted(end);  // one document: an error takes the place of the answer
    console.print_json(advice_json(problem, question, advice, !finished));
  } else {
    console.print(for_people(text, console));
  }
  if (!finished && !was_interrupted(end)) return;
  const bool any_is_finished = has_finished_rows(advice);
  if (any_is_finished) keep(options, problem, question, advice, text, console);
  if (finished) return;
  console.flush();
  console.note(any_is_finished ? "interrupted; the rows so far are printed"
                               : "interrupted; no method was finished");
  console.exit_code = Exit::interrupted;
}

}  // namespace

void add_advise(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "advise",
      "Which integrator, and how large a step: for a model and a frame rate; exit 1 where nothing suits",
      {"hmax advise --mesh liver --material male_normal --rate 100",
       "hmax advise --mesh phantom --load tool --rate 1000 --budget 0.5 --within 5 --json",
       "hmax advise --problem liver_forced --rate 100 --tolerance 1e-3",
       "hmax advise --problem liver_forced --rate 100 --methods rk4,newmark --output advice.html"},
      advise_on);
  options.problem.add_to(command);
  add_number(command, "--rate", options.rate, "Frame rate [Hz]; required");
  add_number(
      command, "--tolerance", options.tolerance,
      "Largest error of the motion, relative to the largest displacement of a body, or to the range of each "
      "state [1]; 0.01 by default");
  add_number(
      command, "--budget", options.budget,
      "CPU time that a frame may take [ms]; given without --tolerance, methods are ranked by error; the whole frame by "
      "default");
  add_number(command, "--within", options.within,
             "Time limit of the answer [s]: what is known by then is the answer; 60 by default");
  add_text(command, "--methods", options.methods,
           fmt::format("Ids, aliases or families of `hmax list methods`, or all; {} by default",
                       fmt::join(simulator_methods(), ", ")),
           "A,B");
  add_text(command, "--frames", options.frames,
           "Number of frames that the best methods are timed for; 1000 by default", "N");
  add_text(command, "--motion", options.motion,
           "Motion of a body in place of the test load: CSV with the columns t [s] and fx, fy, fz [N] or x, "
           "y, z [m], forces or displacements",
           "FILE");
  add_repeated(
      command, "--motion-at", options.motion_at,
      "Points that --motion acts on, as --support, which displacements need; the far end of the body by default; may be "
      "repeated",
      "SET");
  add_text(
      command, "--out", options.out,
      "Store of the advice, one row a method: a file that ends in .sqlite, or a name under results/runs; none "
      "by default",
      "STORE");
  add_text(
      command, "--output", options.output,
      "Page of HTML with the whole answer and its figures, which needs no other file; or FILE.scn, the body as a "
      "scene of SOFA with what is recommended of its solvers; none by default",
      "FILE");
  options.device.add_to(command, "motions of a body");
  add_force(command);
  add_jobs(command);
}

}  // namespace hmax
