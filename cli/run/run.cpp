/// hmax run: one integration, where it ends and what it costs.
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "catalogue/methods/kept_sink.hpp"
#include "catalogue/methods/method.hpp"
#include "catalogue/models/equilibria/inversion.hpp"
#include "catalogue/models/equilibria/tool_report.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "cli/bodies/body_picture.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/run/checkpoint_option.hpp"
#include "cli/run/motion_outputs.hpp"
#include "cli/run/run_options.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/shared/work_limit.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/parallel_for.hpp"
#include "core/process/leaving.hpp"
#include "core/text/counted.hpp"
#include "integrators/control.hpp"
#include "integrators/implicit/newton.hpp"
#include "integrators/run_end.hpp"
#include "limits/along/trajectory_limit.hpp"
#include "limits/documents/model_json.hpp"
#include "limits/documents/number_json.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/tissue/body.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

/// The problem in the order of states of the user.
Problem as_shown(const Problem& problem) {
  Problem shown = problem;
  shown.states = problem.shown.in_order(problem.states);
  shown.y0 = problem.shown.state(problem.y0);
  shown.shown = {};
  return shown;
}

/// An adaptive run of an explicit method follows each period of a load by a step at least; an implicit one
/// steps over fast loads that its tolerances do not see. Fixed steps are counted by check().
void check_length(const RunOptions& options, const RunSpec& spec, const Method& method,
                  const Problem& problem) {
  if (!spec.adaptive || !method.is_explicit) return;
  const std::optional<double> period = period_of_load(problem);
  if (!period) return;
  refuse_endless({.asked = options.t_end ? fmt::format("--t-end {}", to_text(*options.t_end))
                                         : fmt::format("a run of {} s", to_text(spec.t_end)),
                  .count = spec.t_end / *period,
                  .of = "periods of the load, each of which takes a step at least",
                  .most_count = static_cast<double>(spec.max_steps),
                  .most_seconds = std::numeric_limits<double>::infinity(),
                  .remedy = "take a shorter --t-end or raise --max-steps"});
}

bool is_series(const RunOptions& options) {
  return form_of(options.output, {{".csv", "the motion"}, {".pvd", "a body, for ParaView"}}) == ".pvd";
}

/// Throws unless the points that are asked for can be made and written.
void check_output(const RunOptions& options, const RunSpec& spec, const Problem& problem) {
  if (options.output.empty()) {
    if (options.every)
      throw InputError("--every asks for points but no file is given for them; add --output FILE.csv");
    return;
  }
  if (options.every && !(*options.every > 0 && *options.every <= spec.t_end))
    throw InputError(fmt::format(
        "--every is {} but must be a number of seconds above 0 and up to the length of the run, {}",
        to_text(*options.every), to_text(spec.t_end)));
  if (is_series(options))
    require_body(
        problem,
        fmt::format("and {} would be a series of meshes; write to FILE.csv, or name a body with --mesh",
                    options.output));
  const double interval = options.every.value_or(spec.h),
               most = is_series(options) ? most_frames : most_points;
  if (interval > 0 && spec.t_end / interval > most)
    throw InputError(
        fmt::format("the output would have {:.3g} points, more than {:.0g}; take a larger --every",
                    spec.t_end / interval, most));
  check_writable(options.output);
}

struct TimedRun : CountedRun {
  std::optional<std::size_t> threads;  ///< that --jobs has asked for
  std::optional<DeviceTime> device;    ///< of a run on one

  /// Simulated time over the CPU time of one thread, over the elapsed time where --jobs is given, or over
  /// that of a device, which of many bodies is the one of each.
  [[nodiscard]] double realtime_factor() const {
    if (device) return record.t / device->seconds;
    return record.t / (threads ? elapsed_seconds : cpu_seconds);
  }
};

/// What a run came to, in the order of states and the time of the user.
TimedRun as_shown(const Problem& problem, const TimedRun& run) {
  TimedRun shown = run;
  shown.record.y = problem.shown.state(run.record.y);
  shown.record.t = problem.shown.time(run.record.t);
  shown.record.t_state = problem.shown.time(run.record.t_state);
  return shown;
}

CountedRun timed(const Runner& runner, const RunSpec& spec, const Sink& sink) {
  const CpuClock clock = cpu_clock();
  const double cpu = clock(), start = elapsed_seconds();
  RunRecord record = runner.run(spec, sink);
  return {std::move(record), clock() - cpu, elapsed_seconds() - start};
}

/// The run that is reported, on `threads` or one, and kept where there is a checkpoint. Nobody watches
/// it, unless it is long and a person waits at a terminal: then it shows its progress, and ends on Ctrl-C.
CountedRun reported_run(const Runner& runner, const RunSpec& spec, std::optional<std::size_t> threads,
                        RunCheckpoint* checkpoint, const Console& console) {
  const ThreadLimit limit(threads.value_or(1));
  if (checkpoint) return checkpoint->run(reported_part, runner, spec);
  if (!console.shows_progress()) return timed(runner, spec, {});
  RunSpec first_hundredth = spec;
  first_hundredth.t_end /= 100;
  if (timed(runner, first_hundredth, {}).cpu_seconds < 0.01) return timed(runner, spec, {});
  Progress progress(console, "run");
  const auto& interrupted = interrupt_flag();
  const LeavesIterations leaves(interrupted, [] { throw Interrupted{}; });
  std::uint32_t count = 0;
  return timed(runner, spec, [&](double t, const auto&) {
    if (interrupted.load(std::memory_order_relaxed)) throw Interrupted{};
    if (++count % 1024 == 0) progress.update(t / spec.t_end);
  });
}

TimedRun run_on_gpu(const Problem& problem, const Method& method, const RunSpec& spec,
                    const DeviceChoice& choice) {
  const std::unique_ptr<Device> gpu = open_gpu();
  DeviceRun run = run_on_device(*gpu, problem, method, spec, choice.precision(), choice.bodies());
  TimedRun timed{};
  timed.record = std::move(run.record);
  timed.device = {gpu->facts(), run.seconds, run.flops, run.bytes, choice.precision(), choice.bodies()};
  return timed;
}

std::string with_unit(double value, std::string_view unit) {
  return std::isfinite(value) ? fmt::format("{} {}", short_number(value), unit)
                              : "beyond the range of numbers";
}

/// Whether the user limits the iterations of an adaptive run, which then takes shorter steps instead.
bool is_limited(const RunRecord& record, const RunSpec& spec) {
  return spec.adaptive && spec.newton.iterations > 0 && record.stats.newton > 0;
}
constexpr const char* without_limit =
    "run without --newton-iterations, which tells whether its limit is the cause";

/// Whether equations were not solved because the user's --newton-iterations did not suffice.
bool stopped_by_limit(const RunRecord& record, const RunSpec& spec) {
  return spec.newton.iterations > 0 && record.note == to_string(NewtonEnd::too_slow);
}

/// What to do where a fixed step fails: a body that collapses under its load does so at every step.
std::string remedy_of_step(const Problem& problem, const RunRecord& record, const RunSpec& spec) {
  constexpr double nearly_flat = 0.1;  // of the volume at rest
  const auto crushed = inversion_at(problem, record.t_state, record.y, nearly_flat);
  const bool is_old = spec.jacobian.every != JacobianUpdate::automatic && spec.jacobian.every != 1;
  return fmt::format(
      "{}take a smaller step{}",
      crushed ? in_words(*crushed) + "; `hmax static` shows whether the load causes this, otherwise " : "",
      is_old ? fmt::format(
                   ", or --jacobian exact, which tells whether the Jacobian of --jacobian {} is the cause",
                   to_string(spec.jacobian))
             : "");
}

/// Why the equations of a fixed step were not solved, and what to do about it.
std::string unsolved_in_words(const Problem& problem, const RunRecord& record, const RunSpec& spec) {
  if (stopped_by_limit(record, spec))
    return fmt::format("Newton's method has not converged within {}; raise --newton-iterations",
                       counted(spec.newton.iterations, "iteration"));
  return fmt::format("{}; {}", record.note.empty() ? "the equations of a step are not solved" : record.note,
                     remedy_of_step(problem, record, spec));
}

/// What stops an adaptive run where the right-hand side jumps at a time that the model does not name.
std::string jump_in_words(const RunRecord& record) {
  return fmt::format(
      "got stuck at t = {} s, where the right-hand side jumps in time; loosen the tolerances, or take fixed steps --h "
      "that end there",
      short_number(record.t, 10));
}

/// What happened, and what to do about it when the end was not reached.
std::string in_words(const Problem& problem, const RunRecord& record, const RunSpec& spec) {
  const std::string at = fmt::format("t = {} s{}", short_number(record.t, 10),
                                     record.note.empty() ? "" : fmt::format(" ({})", record.note));
  if (record.note == jump_note) return jump_in_words(record);
  switch (record.outcome) {
    case Outcome::reached_end:
      return "reached the end at " + at;
    case Outcome::stopped:
      return "was stopped at " + at;
    case Outcome::diverged:
      return "diverged at " + at +
             (spec.adaptive ? "; the solution may have no bound, or the tolerances are too loose for it"
                            : "; " + remedy_of_step(problem, record, spec));
    case Outcome::step_too_small:
      return "got stuck at " + at + ", where no step meets the tolerances; " +
             (is_limited(record, spec) ? without_limit
                                       : "the solution may have no bound there, or they are too tight");
    case Outcome::too_many_steps:
      return fmt::format(
          "used up {} steps at {}; {}", spec.max_steps, at,
          is_limited(record, spec) ? without_limit : "raise --max-steps or take looser tolerances");
    case Outcome::newton_failed:
      return fmt::format("stopped at t = {} s: {}", short_number(record.t, 10),
                         unsolved_in_words(problem, record, spec));
  }
  return "ended at " + at;
}

/// A state; of a body in the order of the points in its file.
std::vector<double> listed(const Problem& problem, const Eigen::VectorXd& y) {
  if (!problem.body || y.size() == 0) return {y.begin(), y.end()};
  const Eigen::Index n = problem.body->dofs();
  std::vector<std::pair<TetMesh::Index, Eigen::Index>> places;
  for (const TetMesh::Index point : problem.body->free_points())
    places.emplace_back(problem.body->origin()->points[static_cast<std::size_t>(point)],
                        3 * static_cast<Eigen::Index>(places.size()));
  std::ranges::sort(places);
  std::vector<double> values;
  for (const Eigen::Index half : {Eigen::Index{0}, n})
    for (const auto& [file_point, dof] : places)
      for (Eigen::Index k = 0; k < 3; ++k) values.push_back(y[half + dof + k]);
  return values;
}

Json to_json(const Problem& problem, const Method& method, const RunSpec& spec, const TimedRun& run,
             bool full) {
  const RunRecord& record = run.record;
  const Stats& stats = record.stats;
  Json document{{"problem", problem.id},
                {"method", method.id},
                {"outcome", to_string(record.outcome)},
                HMAX_KEYS(record, t, t_state),
                {"y", listed(problem, record.y)},
                {"stats",
                 {HMAX_KEYS(stats, steps, rejected, rhs, jacobian, factorisations, newton, linear_iterations,
                            newton_error)}},
                {"cpu_seconds", run.cpu_seconds},
                {"status", record.outcome == Outcome::reached_end ? "" : in_words(problem, record, spec)},
                {"material", json_or_null(problem.material)},
                {"parameters", parameters_json(problem.parameters)},
                {"y0", std::vector<double>(problem.y0.begin(), problem.y0.end())},
                {"states", problem.states},
                HMAX_KEYS(method, order, error_order),
                {"mode", spec.adaptive ? "adaptive" : "fixed"},
                {"t_end", spec.t_end}};
  if (spec.adaptive) {
    document["rtol"] = spec.rtol;
    document["atol"] = spec.atol;
    document["control"] = control_of(method, spec);
    if (spec.h_first > 0) document["h0"] = spec.h_first;
    if (std::isfinite(spec.h_max)) document["h_max"] = spec.h_max;
  } else {
    document["h"] = spec.h;
  }
  if (run.threads) {
    document["threads"] = *run.threads;
    document["elapsed_seconds"] = run.elapsed_seconds;
  }
  if (run.device) run.device->add_to(document);
  if (method.needs_jacobian) document["jacobian"] = to_string(spec.jacobian);
  if (const auto end = end_of(problem, record.t_state, record.y)) {
    document["max_displacement"] = end->max_displacement;
    document["energy"] = end->energy;
    document["least_volume"] = end->least_volume;
    if (const auto tool = tool_report(problem, record.t_state, record.y)) document["tool"] = tool->json();
    document["dofs"] = unknowns_of(problem);
    document["body"] = body_json(problem);
    document["realtime_factor"] = run.realtime_factor();
    if (method.needs_jacobian) document["linear"] = to_string(spec.linear_solve);
    for (const char* name : {"y", "y0", "states"})
      if (!full || document[name].empty()) document.erase(name);
  }
  return document;
}

/// States of matrices that are listed one by one.
constexpr std::size_t most_listed = 24;

/// What moves most, of matrices with many unknowns.
std::string largest_states(const Problem& problem, const RunRecord& record) {
  const Eigen::Index n = is_second_order(problem) ? record.y.size() / 2 : record.y.size();
  std::string text;
  for (Eigen::Index first = 0; first < record.y.size(); first += n) {
    Eigen::Index i = 0;
    record.y.segment(first, n).cwiseAbs().maxCoeff(&i);
    text += fmt::format("  largest of {} {:<10} {:> .16g}\n", n,
                        problem.states[static_cast<std::size_t>(first + i)], record.y[first + i]);
  }
  return text;
}

std::string costs_in_words(const Method& method, const TimedRun& run) {
  std::string text;
  const Stats& stats = run.record.stats;
  text += fmt::format("\nsteps {}   rejected {}   rhs {}", stats.steps, stats.rejected, stats.rhs);
  if (method.needs_jacobian)
    text += fmt::format("   jacobian {}   factorisations {}", stats.jacobian, stats.factorisations);
  if (stats.newton > 0) text += fmt::format("   newton {}", stats.newton);
  if (stats.newton > 0 && stats.steps > 0 && stats.newton_error > 0)
    text += fmt::format(" ({} a step, error left {} of the state)",
                        short_number(static_cast<double>(stats.newton) / static_cast<double>(stats.steps), 3),
                        short_number(stats.newton_error, 2));
  if (stats.linear_iterations > 0) text += fmt::format("   linear iterations {}", stats.linear_iterations);
  text += run.device ? run.device->words() : fmt::format("   cpu {} s", short_number(run.cpu_seconds, 3));
  if (run.threads)
    text += fmt::format("   elapsed {} s on {}", short_number(run.elapsed_seconds, 3),
                        counted(*run.threads, "thread"));
  return text + "\n";
}

std::string for_people(const Problem& problem, const Method& method, const RunSpec& spec, const TimedRun& run,
                       bool own_tableau, const Console& console) {
  const RunRecord& record = run.record;
  const bool done = record.outcome == Outcome::reached_end;
  std::string text = fmt::format("{} with {}\n", problem.id, describe_acting(problem));
  if (const std::string words = body_in_words(problem); !words.empty()) text += words + "\n";
  text += fmt::format("{}, {}", method.id,
                      spec.adaptive ? fmt::format("rtol {}, atol {}, control {}", to_text(spec.rtol),
                                                  to_text(spec.atol), control_of(method, spec))
                                    : fmt::format("fixed steps of {} s", to_text(spec.h)));
  if (own_tableau)
    text += fmt::format("; its order is {}{}", method.order,
                        method.adaptive() ? fmt::format(", its error estimate O(h^{})", method.error_order)
                                          : ", without error estimate");
  const std::string words = in_words(problem, record, spec);
  text += "\n\n" + (done ? console.strong(words) : console.alarming(words)) + "\n";
  if (record.t_state != record.t)
    text += fmt::format("before that, at t = {} s:\n", short_number(record.t_state, 10));
  if (problem.matrices && problem.states.size() > most_listed)
    return text + largest_states(problem, record) + costs_in_words(method, run);
  std::size_t width = 0;
  for (const std::string& state : problem.states) width = std::max(width, state.size());
  for (std::size_t i = 0; i < problem.states.size(); ++i)
    text +=
        fmt::format("  {:<{}}  {:> .16g} {}\n", problem.states[i], width,
                    record.y[static_cast<Eigen::Index>(i)], problem.units.empty() ? "" : problem.units[i]);
  if (const auto end = end_of(problem, record.t_state, record.y)) {
    text +=
        fmt::format("  largest displacement  {}\n  energy                {}\n  real-time factor      {}\n",
                    with_unit(1000 * end->max_displacement, "mm"), with_unit(end->energy, "J"),
                    short_number(run.realtime_factor(), 3));
    if (const auto tool = tool_report(problem, record.t_state, record.y))
      text += fmt::format("  tool                  {}\n", tool->words());
  }
  return text + costs_in_words(method, run);
}

/// The body where the run ended.
BodyPicture picture_of(const RunOptions& options, const Problem& problem, const Method& method,
                       const RunSpec& spec, const RunRecord& record) {
  const TissueBody& body = *problem.body;
  const Eigen::VectorXd q = record.y.head(body.dofs());
  const BodyValue value = options.picture.value();
  BodyPicture picture{
      .title =
          fmt::format("{}{} after {} s: {}{} mm at most", title_of(problem.id),
                      problem.material.empty() ? "" : " of " + problem.material, short_number(record.t, 4),
                      body.least_volume(record.t, q).first > 0 ? "" : "inverted elements, ",
                      short_number(1000 * largest_displacement(q), 3)),
      .caption =
          fmt::format("{}; {}. {}, {}.", problem.note, describe_acting(problem), method.id,
                      spec.adaptive ? fmt::format("rtol {}, atol {}", to_text(spec.rtol), to_text(spec.atol))
                                    : fmt::format("h = {} s", to_text(spec.h))),
      .views = {body_view(body, record.t, q, value)}};
  picture.colours = colours_of(value, picture.views);
  return picture;
}

/// How far a body has moved, in its own size.
double sizes_moved(const TissueBody& body, const Eigen::VectorXd& y) {
  return largest_displacement(y.head(body.dofs())) / diagonal_of(body.mesh());
}

/// Throws where an option has nothing to act on.
void check_choices(const RunOptions& options, const Problem& problem, const Method& method, bool json) {
  if (!options.control.empty() && method.own_control)
    throw InputError(fmt::format("{} has its own step size control; remove --control", method.id));
  if (!options.jacobian.empty() && !method.needs_jacobian)
    throw InputError(method.parameter("frozen") == 0
                         ? fmt::format("{} takes no --jacobian; {}:frozen=1 keeps that of the start",
                                       method.id, method.id.substr(0, method.id.find(':')))
                         : fmt::format("{} uses no Jacobian; leave --jacobian out", method.id));
  if (!options.linear.empty()) {
    if (!method.needs_jacobian)
      throw InputError(fmt::format("{} solves no equations; leave --linear out", method.id));
    if (method.is_foreign())
      throw InputError(
          fmt::format("{} solves its equations as {} does; leave --linear out", method.id, method.engine));
    require_body(problem, "and its equations are too few to choose how they are solved; leave --linear out");
  }
  if ((options.newton_tolerance || !options.newton_iterations.empty()) &&
      (!method.solves_nonlinear_equations() || method.is_foreign()))
    throw InputError(fmt::format(
        "{} does not solve its equations by Newton's method of hmax; leave --newton-tolerance and "
        "--newton-iterations out",
        method.id));
  if (is_given(options.jobs) && !problem.body && !problem.matrices)
    throw InputError(
        fmt::format("--jobs is for bodies and matrices, and {} is neither; leave it out", problem.id));
  if (!options.full) return;
  require_body(problem, "and shows all its states without --full; remove it");
  if (!json) throw InputError("--full applies to --json only; add --json, or remove it");
}

/// @returns how many points or meshes were written
std::size_t write_output(const RunOptions& options, const WatchedRun& run, RunCheckpoint* checkpoint) {
  if (is_series(options)) return write_series(options.output, run, checkpoint);
  const Table table = points_of(run, checkpoint);
  write_csv(options.output, table);
  return table.values[0].size();
}

/// Throws unless the picture that is asked for can be drawn and written.
void check_picture(const RunOptions& options, const Problem& problem) {
  if (!options.picture.wanted()) return;
  if (problem.body) return options.picture.check(*problem.body);
  if (!options.picture.colour.empty() || !options.picture.from.empty())
    throw InputError(fmt::format("--{} is for pictures of bodies, and {} is none; leave it out",
                                 options.picture.colour.empty() ? "from" : "colour", problem.id));
}

/// @returns whether the picture that is asked for is drawn
bool draw_picture(const RunOptions& options, const WatchedRun& run, const RunRecord& record,
                  Console& console) {
  if (!options.picture.wanted()) return false;
  const auto& [problem, method, runner, spec] = run;
  if (!problem.body)
    return write_svg(options.picture.file, motion_figure(run, record), "motion", "picture", console);
  if (record.outcome == Outcome::diverged) {
    console.remark(fmt::format(
        "the picture {} is not drawn, since what has diverged has no shape; {}", options.picture.file,
        spec.adaptive ? "end the run before that with --t-end"
                      : "take a smaller --h, `hmax stability predict` says how small"));
    return false;
  }
  options.picture.write(picture_of(options, problem, method, spec, record));
  return true;
}

/// The end beside the start, by the largest number of each; of positions and velocities the smaller growth of
/// those that do not start from zero.
double growth_of(const Problem& problem, const Eigen::VectorXd& end) {
  const Eigen::Index n = is_second_order(problem) ? end.size() / 2 : end.size();
  double growth = std::numeric_limits<double>::infinity();
  for (Eigen::Index first = 0; first < end.size(); first += n)
    if (const double start = problem.y0.segment(first, n).cwiseAbs().maxCoeff(); start > 0)
      growth = std::min(growth, end.segment(first, n).cwiseAbs().maxCoeff() / start);
  return std::isfinite(growth) ? growth : 1;
}

/// Remarks on the end of a run. A step that is not stable may reach the end of a short run all the same.
void remark_end(const Problem& problem, const RunSpec& spec, const RunRecord& record, Console& console) {
  constexpr double far = 10, much = 1e6;
  if (!problem.body) {
    if (const double growth = growth_of(problem, record.y); growth > much)
      console.remark(fmt::format("the motion ends {} times as large as it began; {}", short_number(growth, 3),
                                 spec.adaptive
                                     ? "the model itself grows"
                                     : "unless the model itself grows take a smaller --h, `hmax stability "
                                       "predict` shows the largest stable one"));
  } else if (const double moved = sizes_moved(*problem.body, record.y); moved > far)
    console.remark(fmt::format(
        "the body has moved {} times its size; add a support{}", short_number(moved, 3),
        spec.adaptive ? ""
                      : " or take a smaller --h, `hmax stability predict` shows the largest stable one"));
  if (const auto inversion = inversion_at(problem, record.t, record.y))
    console.remark(fmt::format(
        "tetrahedron {} is inverted at the end, with {} of its volume at rest; `hmax static` shows whether the load "
        "causes this, otherwise take a smaller step",
        inversion->tetrahedron, short_number(inversion->volume, 3)));
}

/// Tells what a run came to, in the order of states and the time of the user.
/// @param points  written to --output
void tell(const RunOptions& options, const Problem& problem, const Method& method, const RunSpec& spec,
          const TimedRun& result, bool drawn, std::optional<std::size_t> points, Console& console) {
  const Problem shown = as_shown(problem);
  const TimedRun told = as_shown(problem, result);
  RunSpec told_spec = spec;
  told_spec.t_end = problem.shown.time(spec.t_end);
  if (console.json) {
    Json document = to_json(shown, method, told_spec, told, options.full);
    document["picture"] = drawn ? Json(options.picture.file) : Json();
    if (points) {
      document["output"] = options.output;
      document["points"] = *points;
    }
    if (!options.checkpoint.file.empty()) document["checkpoint"] = options.checkpoint.file;
    return console.print_json(document);
  }
  console.print(for_people(shown, method, told_spec, told, !options.method.tableau.empty(), console));
  if (points) console.print(fmt::format("{} points in {}\n", *points, options.output));
}

void run(const RunOptions& options, const Problem& problem, Console& console) {
  const Method method = options.method.make();
  const RunSpec asked = spec_of(options, problem);
  const RunSpec spec = options.checkpoint.file.empty() ? asked : kept_spec(asked);
  check(spec, method, problem);
  check_length(options, spec, method, problem);
  check_choices(options, problem, method, console.json);
  check_output(options, spec, problem);
  check_picture(options, problem);
  options.device.check({{"--output", !options.output.empty()},
                        {"--checkpoint", !options.checkpoint.file.empty()},
                        {"--jobs", is_given(options.jobs)}},
                       problem, method, spec.adaptive);

  remark_unusual(console, problem);
  options.problem.remark_idle(console, problem, method.needs_jacobian && !method.is_foreign());
  if (is_too_slow(method, problem.y0.size()))
    console.remark(fmt::format(
        "{} factors a dense matrix of {} rows in every step, which may take seconds; the implicit "
        "methods of hmax have sparse ones",
        method.engine, problem.y0.size()));
  if (problem.matrices && options.problem.y0.empty() && problem.matrices->files.initial.empty())
    console.note(fmt::format("the run starts from pseudo-random {} of up to {}; give another start with --y0",
                             is_second_order(problem) ? "displacements at rest" : "states",
                             to_text(random_start_size)));
  const Runner runner = method.bind(problem);
  const std::optional<std::size_t> threads = given_jobs(options.jobs);
  std::optional<StopFlag> stop;
  if (!options.checkpoint.file.empty()) stop.emplace();
  const std::unique_ptr<RunCheckpoint> checkpoint =
      options.checkpoint.open({problem, method, spec, options.method.tableau, options.output,
                               options.every.value_or(0), threads ? std::to_string(*threads) : "not given"},
                              stop ? &*stop : nullptr, console);
  const TimedRun result =
      options.device.is_gpu()
          ? run_on_gpu(problem, method, spec, options.device)
          : TimedRun{reported_run(runner, spec, threads, checkpoint.get(), console), threads, {}};
  const bool reached_end = result.record.outcome == Outcome::reached_end;
  WatchedRun watched{problem, method, runner, spec};
  watched.spec.every = options.every.value_or(0);
  std::optional<std::size_t> points;
  if (!options.output.empty()) points = write_output(options, watched, checkpoint.get());
  // Nothing saves its state from here on: signals end the program again, also one that came while the last
  // run ended.
  if (stop && stop->is_set()) throw Interrupted::with_store(options.checkpoint.file, 1);
  stop.reset();
  const bool drawn = draw_picture(options, watched, result.record, console);
  if (reached_end) {
    remark_end(problem, spec, result.record, console);
    warn_of_tool(console, problem, result.record.t, result.record.y);
  } else {
    console.exit_code = Exit::failed;
  }
  tell(options, problem, method, spec, result, drawn, points, console);
}

/// The run, or where it was stopped to go on later.
void run_or_stop(const RunOptions& options, Console& console) {
  options.picture.check();
  options.checkpoint.check(options.output, options.picture.file);
  const Problem problem = problem_of(options);
  try {
    run(options, problem, console);
  } catch (const InterruptedRun& at) {
    console.note(fmt::format("stopped at t = {} s; the same command goes on from {}",
                             short_number(problem.shown.time(at.t), 10), options.checkpoint.file));
    console.exit_code = Exit::interrupted;
  } catch (const StateNotSaved&) {
    throw InputError(without_checkpoints(options.method.make()));
  }
}

}  // namespace

void add_run(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "run", "Integrate one problem with one method",
      {"hmax run --problem liver_forced --method dop_853 --rtol 1e-13 --atol 1e-13 --t-end 10",
       "hmax run --problem liver_benchmark --material female_fat:heavy --method rk4 --h 0.05",
       "hmax run --mesh phantom --model fem_green --method linearly_implicit_euler --h 0.01 --t-end 0.2",
       // NOLINTNEXTLINE(bugprone-suspicious-missing-comma): it goes on in the next line
       "hmax run --mesh phantom --load tool --method linearly_implicit_euler --h 0.01 --t-end 0.6 --picture "
       "results/runs/tool.svg",
       "hmax run --mesh liver --load breathing --method symplectic_euler --h 0.001 --t-end 4 --output "
       "results/runs/breathing.pvd --every 0.1",
       "hmax run --problem liver_linear --set c=6 --y0 0.1,0 --method ode45 --rtol 1e-3 --atol 1e-6 "
       "--control matlab --output motion.csv --every 0.1"},
      run_or_stop);
  options.problem.add_to(command);
  options.method.add_to(command);
  add_number(command, "--h", options.h, "Fixed step size [s]");
  add_number(command, "--rtol", options.rtol,
             "Relative tolerance of an adaptive run, which needs --atol too; no default");
  add_number(command, "--atol", options.atol,
             "Absolute tolerance of an adaptive run, which needs --rtol too; no default");
  add_number(command, "--h0", options.h0,
             "First step of an adaptive run [s]; chosen from the right-hand side by default");
  add_number(command, "--h-max", options.h_max,
             "Longest step of an adaptive run [s]; a tenth of the span by default");
  add_control(command, options.control);
  add_text(
      command, "--jacobian", options.jacobian,
      "When an implicit method updates its Jacobian: auto, exact, every:K steps or frozen; auto by default",
      "POLICY");
  add_text(command, "--linear", options.linear,
           "Linear solver of implicit methods on sparse mechanical systems: auto, direct, cg, "
           "cg:TOLERANCE or cg:TOLERANCE,ITERATIONS; auto by default",
           "SOLVER");
  add_number(command, "--newton-tolerance", options.newton_tolerance,
             "Error tolerance of Newton's method at fixed steps, relative to the largest number of the "
             "state; the rounding error of the forces by default");
  add_text(command, "--newton-iterations", options.newton_iterations,
           "Limit of Newton's method for each stage; 50, adaptive 7 by default", "NUMBER");
  add_flag(command, "--full", options.full, "With --json and a mesh: print the whole end state");
  options.picture.add_to(
      command,
      "Draw the body at the end of the run; without a mesh the states over time and the orbit of one position");
  add_number(command, "--t-start", options.t_start,
             "Start time of a file of formulas [s]; its t0 by default");
  add_number(command, "--t-end", options.t_end,
             "End time [s], of a file of formulas also before the start; the problem's own by default");
  add_text(command, "--output", options.output,
           "Write the motion to a CSV file, or of a body to FILE.pvd for ParaView", "FILE");
  add_number(
      command, "--every", options.every,
      "Interval of the written points [s], between steps by the interpolant of the method or by cubics; every step by default");
  add_text(command, "--max-steps", options.max_steps,
           "Limit of steps; 1e9 fixed or 2e7 attempted adaptive steps by default", "NUMBER");
  options.checkpoint.add_to(command);
  options.device.add_to(command, "steps of a body");
  options.device.add_kinds_to(command);
  options.jobs = add_jobs_of_timed(command);
  add_force(command);
}

}  // namespace hmax
