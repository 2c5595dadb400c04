/// hmax static: where a body comes to rest under a load, and how fast each method finds it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "analysis/statics/static_solution.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/support_advice.hpp"
#include "catalogue/models/equilibria/tool_report.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "cli/bodies/body_picture.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/bodies/static_comparison.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/parallel_for.hpp"
#include "core/text/counted.hpp"
#include "limits/documents/model_json.hpp"
#include "limits/documents/number_json.hpp"
#include "plots/draw.hpp"
#include "problems/tissue/body.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

struct StaticOptions {
  ProblemChoice problem;
  std::optional<double> load_scale, tolerance, inner_tolerance, relaxation;
  std::string solver, linear, output, iterations, load_steps, frames, per_frame;
  bool no_line_search = false;
  std::string compare;
  PictureChoice picture;
  const CLI::Option* jobs = nullptr;
};

/// @throws InputError  for what is no count, and for more than anybody waits for
int count_of(std::string_view name, const std::string& text) {
  constexpr std::int64_t most = 1'000'000;
  const std::int64_t count = parse_count(name, text, 1);
  if (count > most)
    throw InputError(fmt::format("{} is {}, but a million is the most; give fewer", name, text));
  return static_cast<int>(count);
}

StaticSettings settings_of(const StaticOptions& options) {
  StaticSettings settings;
  constexpr std::array<std::string_view, 3> solvers{"newton", "modified_newton", "linear"};
  const std::string solver =
      parse_choice("--solver", options.solver.empty() ? solvers[0] : options.solver, solvers);
  for (const StaticMethod each : {StaticMethod::linear, StaticMethod::newton, StaticMethod::modified_newton})
    if (name_of(each) == solver) settings.method = each;
  constexpr std::array<std::string_view, 3> inner{"direct", "sor", "cg"};
  const std::string linear =
      parse_choice("--linear", options.linear.empty() ? inner[0] : options.linear, inner);
  for (const InnerSolver each : {InnerSolver::direct, InnerSolver::sor, InnerSolver::conjugate_gradients})
    if (name_of(each) == linear) settings.inner = each;
  if (!options.iterations.empty()) settings.iterations = count_of("--iterations", options.iterations);
  if (!options.load_steps.empty()) settings.load_steps = count_of("--load-steps", options.load_steps);
  settings.tolerance = options.tolerance.value_or(settings.tolerance);
  settings.inner_tolerance = options.inner_tolerance;
  settings.relaxation = options.relaxation.value_or(settings.relaxation);
  settings.line_search = !options.no_line_search;
  return settings;
}

double scale_of(const StaticOptions& options) { return options.load_scale.value_or(1); }

/// "force=0.5 support=0.1, load x 3".
std::string describe_acting(const Problem& problem, double load_scale) {
  return describe_acting(problem) + (load_scale == 1 ? "" : fmt::format(", load x {}", to_text(load_scale)));
}

void print_frames(const StaticOptions& options, const Problem& problem, const StaticModel& model,
                  const StaticSettings& settings, Console& console) {
  int frames = 100, each = 1;
  if (!options.frames.empty()) frames = count_of("--frames", options.frames);
  if (!options.per_frame.empty()) each = count_of("--pseudo-dynamic", options.per_frame);
  const OneThread alone;
  const auto rows = pseudo_dynamic(model, settings, frames, each, thread_cpu_seconds);
  double worst = std::numeric_limits<double>::quiet_NaN(), seconds = 0, lost = 0;
  for (const StaticFrame& row : rows) {
    if (std::isnan(row.error) && lost == 0) lost = row.load;
    worst = std::fmax(worst, row.error);
    seconds = std::max(seconds, row.seconds);
  }
  const bool unloaded = rows.empty();
  const bool bounded = unloaded || (rows.size() == static_cast<std::size_t>(frames) && std::isfinite(worst) &&
                                    std::isfinite(rows.back().residual) && lost == 0);
  const std::string status =
      unloaded  ? "nothing loads the body beyond the rounding of its forces, and it stays at rest"
      : bounded ? ""
      : lost != 0
          ? fmt::format(
                "from {} of the load on no equilibrium was found to hold the frames against; take a smaller "
                "load, or look at it with `hmax static` alone",
                short_number(lost, 3))
          : "the frames diverged; take more frames or more iterations a frame";
  if (!bounded) console.exit_code = Exit::failed;
  if (console.json) {
    const auto known = [](double error) { return std::isnan(error) ? Json() : Json(error); };
    Json list = Json::array();
    for (const StaticFrame& row : rows) {
      list.push_back({HMAX_KEYS(row, load, residual), {"error", known(row.error)}, {"seconds", row.seconds}});
      if (std::isnan(row.error)) list.back()["status"] = "no equilibrium was found to hold the frame against";
    }
    return console.print_json({{"problem", problem.id},
                               {"load_scale", scale_of(options)},
                               {"outcome", bounded ? "converged" : "not_converged"},
                               {"status", status},
                               {"iterations_per_frame", each},
                               {"largest_error", known(worst)},
                               {"longest_frame_seconds", seconds},
                               {"frames", list}});
  }
  TextTable table({"load", "residual", "error", "time"});
  const std::size_t step = std::max<std::size_t>(1, rows.size() / 10);
  for (std::size_t i = step - 1; i < rows.size(); i += step)
    table.add({short_number(rows[i].load, 3), short_number(rows[i].residual, 3),
               short_number(rows[i].error, 3),
               fmt::format("{} ms", short_number(1000 * rows[i].seconds, 3))});
  console.print(
      fmt::format("{} with {}\n{} frames with {} of {} each\n\n{}\nlargest error {}, longest "
                  "frame {} ms\n",
                  problem.id, describe_acting(problem, scale_of(options)), frames, counted(each, "iteration"),
                  name_of(settings.method), table.text(console), short_number(worst, 3),
                  short_number(1000 * seconds, 3)));
  if (!status.empty()) console.print(status + "\n");
}

Json stable_json(const StaticSolution& solution) { return json_or_null(solution.stable); }

/// Every solver on the same equilibrium: a table, and the figure of their residuals.
void print_comparison(const StaticOptions& options, const Problem& problem, const StaticModel& model,
                      StaticSettings settings, Console& console) {
  check_figure_files(options.compare, "residuals");
  if (!options.relaxation) settings.relaxation = best_relaxation(model, settings);
  const std::vector<StaticWay> ways = all_ways(model, settings);
  const std::string iterations = iterations_in_words(settings);
  const FigureFiles figure = draw(
      residual_figure(
          ways, fmt::format("{}: residuals of static solvers", problem.id),
          fmt::format("{}; {}; {}", problem.note, describe_acting(problem, scale_of(options)), iterations)),
      options.compare, "residuals");
  if (std::ranges::none_of(ways, [](const StaticWay& way) { return way.solution.converged; }))
    console.exit_code = Exit::failed;
  Json list = Json::array();
  TextTable table({"solver", "linear", "iterations", "residual", "time", "outcome"});
  for (const StaticWay& way : ways) {
    const StaticSolution& solution = way.solution;
    const std::string outcome(outcome_of(problem, solution));
    const double residual = solution.history.back().residual;
    list.push_back({{"solver", name_of(way.method)},
                    {"linear", name_of(way.inner)},
                    {"outcome", outcome},
                    {"status", status_of(problem, solution)},
                    {"stable", stable_json(solution)},
                    {"iterations", solution.iterations},
                    {"residual", residual},
                    {"seconds", way.seconds()}});
    table.add({std::string(name_of(way.method)), std::string(name_of(way.inner)),
               std::to_string(solution.iterations), short_number(residual, 3),
               fmt::format("{} ms", short_number(1000 * way.seconds(), 3)), outcome});
  }
  const std::string file = figure.base.string() + ".svg";
  if (console.json)
    return console.print_json({{"problem", problem.id},
                               {"load_scale", scale_of(options)},
                               {"relaxation", settings.relaxation},
                               {"linear_tolerance", json_or_null(settings.inner_tolerance)},
                               {"ways", list},
                               {"figure", figure.drawn() ? Json(file) : Json()}});
  console.print(fmt::format(
      "{} with {}\n{}\n{}{}\n\n{}", problem.id, describe_acting(problem, scale_of(options)), problem.note,
      iterations, options.relaxation ? "" : ", the best for the stiffness at rest", table.text(console)));
  std::string notes;
  for (const StaticWay& way : ways)
    if (const std::string status = status_of(problem, way.solution); !status.empty())
      notes += fmt::format("{}, {}: {}\n", name_of(way.method), name_of(way.inner), status);
  if (!notes.empty()) console.print("\n" + notes);
  if (figure.drawn())
    console.print(fmt::format("\nThe figure: {}\n", file));
  else
    console.remark(figure.problem);
}

/// The body in equilibrium.
BodyPicture picture_of(const StaticOptions& options, const Problem& problem, const StaticSettings& settings,
                       const StaticSolution& solution, const std::string& outcome) {
  const BodyValue value = options.picture.value();
  const char* no_equilibrium = outcome == "inverted"  ? "equilibrium with inverted elements, "
                               : outcome == "buckles" ? "unstable equilibrium, "
                                                      : "no equilibrium, ";
  BodyPicture picture{.title = fmt::format("{}{}: {}{} mm at most", title_of(problem.id),
                                           problem.material.empty() ? "" : " of " + problem.material,
                                           outcome != "converged"           ? no_equilibrium
                                           : solution.stable.value_or(true) ? ""
                                                                            : "unstable equilibrium, ",
                                           short_number(1000 * largest_displacement(solution.q), 3)),
                      .caption = fmt::format("{}; {}. Static equilibrium by {}, {}, in {}.", problem.note,
                                             describe_acting(problem, scale_of(options)),
                                             name_of(settings.method), name_of(settings.inner),
                                             counted(solution.history.back().load_steps, "load step")),
                      .views = {body_view(*problem.body, equilibrium_time(problem), solution.q, value)}};
  picture.colours = colours_of(value, picture.views);
  return picture;
}

/// Throws when an option has no say in what is asked for.
void refuse_ignored(const StaticOptions& options) {
  const bool compares = !options.compare.empty();
  const bool frames = !options.per_frame.empty() || !options.frames.empty();
  const bool iterative = compares || (!options.linear.empty() && options.linear != "direct");
  const bool linear = options.solver == "linear";
  const bool steps = !options.load_steps.empty(), iterations = !options.iterations.empty();
  if (!compares) refuse_style_without_figure("--compare FOLDER");
  if ((compares || frames) && is_given(options.jobs))
    throw InputError(
        "--compare, --pseudo-dynamic and --frames compare times of one thread; leave --jobs out");
  if (compares && frames)
    throw InputError("--compare and --pseudo-dynamic or --frames are both given; choose one of them");
  constexpr const char* runs_all = "cannot be combined with --compare, which runs every solver; remove it";
  constexpr const char* one_system =
      "cannot be combined with --solver linear, which solves one system; remove it, or take newton";
  struct Ignored {
    bool here;  ///< where the option has no say
    const char* option;
    bool given;
    const char* why;
  };
  const Ignored all[]{
      {compares, "--solver", !options.solver.empty(), runs_all},
      {compares, "--linear", !options.linear.empty(), runs_all},
      {compares, "--output", !options.output.empty(),
       "writes the residuals of one solver; --compare has its data beside the figure, so leave --output out"},
      {frames, "--output", !options.output.empty(),
       "writes the residuals of one equilibrium; leave it out, or --pseudo-dynamic and --frames"},
      {frames && linear, "--solver linear", true,
       "solves one system, and frames iterate; take newton or modified_newton"},
      {frames, "--load-steps", steps, "cannot be combined with frames, each is a load step; give --frames"},
      {frames, "--iterations", iterations, "cannot be combined with frames; give --pseudo-dynamic NUMBER"},
      {frames, "--no-line-search", options.no_line_search, "is always on in frames; remove it"},
      {!iterative, "--linear-tolerance", options.inner_tolerance.has_value(),
       "is of iterative linear solvers, and direct has none; leave it out, or take --linear sor or cg"},
      {!compares && options.linear != "sor", "--relaxation", options.relaxation.has_value(),
       "is of sor alone; leave it out, or take --linear sor"},
      {linear, "--load-steps", steps, one_system},
      {linear, "--iterations", iterations, one_system},
      {linear, "--tolerance", options.tolerance.has_value(), one_system},
      {linear, "--no-line-search", options.no_line_search, one_system}};
  for (const auto& [here, option, given, why] : all)
    if (here && given) throw InputError(fmt::format("{} {}", option, why));
}

/// What a command with these options cannot do with a body.
void refuse_unsuited(const StaticOptions& options, const Problem& problem) {
  require_body(problem, "and hmax static is for those; name one with --mesh");
  if (problem.body->steady_from() != equilibrium_time(problem))
    throw InputError("this load changes with time and has no equilibrium; take gravity, press, pull or tool");
  const bool frames = !options.per_frame.empty() || !options.frames.empty();
  if (has_tool(problem) && (options.load_scale || frames || !options.compare.empty()))
    throw InputError(
        "--load-scale, --compare, --pseudo-dynamic and --frames are for loads that are forces, and a tool moves; leave "
        "them out, or choose its depth with --set depth=");
  if (has_tool(problem) && options.solver == "linear")
    throw InputError("--solver linear has no contact, which --load tool needs; take newton");
  constexpr double most = 1e30;  // as of other values: squares of forces must stay numbers
  if (!(std::abs(scale_of(options)) <= most))
    throw InputError(fmt::format("--load-scale is {} but must be a number between -1e30 and 1e30",
                                 to_text(scale_of(options))));
  if (!options.output.empty()) {
    form_of(options.output, {{".csv", "the history of residuals"}});
    check_writable(options.output);
  }
  if (options.picture.wanted()) options.picture.check(*problem.body);
  if ((frames || !options.compare.empty()) && options.picture.wanted())
    throw InputError("a picture shows one equilibrium; leave --pseudo-dynamic, --frames and --compare out");
}

/// @throws InputError  for a body that moves freely: there is no equilibrium by which to judge solvers
void refuse_unheld(const Problem& problem, double load_scale) {
  const StaticSolution first =
      found_equilibrium(problem, load_scale, {.method = StaticMethod::linear}, [] { return 0.0; });
  if (first.singular) throw InputError(cause_of(problem, first));
}

/// The outcome of the command without --compare and --frames.
struct StaticAnswer {
  const Problem& problem;
  const StaticSettings& settings;
  StaticSolution solution;
  double load_scale, seconds;          ///< CPU time of one thread, elapsed time where --jobs is given [s]
  std::optional<std::size_t> threads;  ///< that --jobs has asked for
  std::string outcome{}, status{};
  double least_volume, energy;
  std::optional<ToolReport> tool{};
  std::optional<SuggestedSupport> suggested_support{};
};

StaticAnswer answer_of(const Problem& problem, const StaticModel& model, const StaticSettings& settings,
                       double scale, std::optional<std::size_t> threads, Console& console) {
  const ThreadLimit limit(threads.value_or(1));
  const auto clock = threads ? elapsed_seconds : thread_cpu_seconds;
  const double start = clock();
  StaticSolution solution = [&] {
    Progress progress(console, "static");
    StaticSettings shown = settings;
    shown.seen = [&](const StaticIterate& iterate) {
      const double near =
          std::log(std::max(iterate.residual, settings.tolerance)) / std::log(settings.tolerance);
      progress.update((iterate.load_step - 1 + std::clamp(near, 0.0, 1.0)) / iterate.load_steps,
                      fmt::format("load step {} of {}, residual {}", iterate.load_step, iterate.load_steps,
                                  short_number(iterate.residual, 3)));
    };
    return beyond_inversion(problem, scale, shown, clock, found_equilibrium(problem, scale, shown, clock));
  }();
  const double seconds = clock() - start, t = equilibrium_time(problem);
  StaticAnswer answer{.problem = problem,
                      .settings = settings,
                      .solution = std::move(solution),
                      .load_scale = scale,
                      .seconds = seconds,
                      .threads = threads,
                      .least_volume = 0,
                      .energy = 0};
  answer.outcome = outcome_of(problem, answer.solution);
  answer.status =
      scale == 1 ? status_without_equilibrium(problem, answer.solution) : status_of(problem, answer.solution);
  answer.least_volume = problem.body->least_volume(t, answer.solution.q).first;
  answer.energy = model.energy(answer.solution.q);
  answer.tool = tool_report(problem, t, answer.solution.q);
  if (scale == 1) answer.suggested_support = suggested_support(problem);
  return answer;
}

Table history_of(const StaticAnswer& answer) {
  Table table;
  table.notes = {{"problem", answer.problem.id},
                 {"parameters", describe_acting(answer.problem, answer.load_scale)},
                 {"solver", std::string(name_of(answer.settings.method))},
                 {"linear", std::string(name_of(answer.settings.inner))}};
  table.columns = {"iteration", "load step", "residual", "time [s]", "inner iterations"};
  table.values.resize(table.columns.size());
  for (std::size_t i = 0; i < answer.solution.history.size(); ++i) {
    const StaticIterate& row = answer.solution.history[i];
    const double values[]{static_cast<double>(row.iteration), static_cast<double>(row.load_step),
                          row.residual, row.seconds, static_cast<double>(row.inner)};
    for (std::size_t k = 0; k < table.columns.size(); ++k) table.values[k].push_back(values[k]);
  }
  return table;
}

Json json_of(const StaticAnswer& answer, const std::string& picture) {
  const Problem& problem = answer.problem;
  Json residuals = Json::array(), times = Json::array();
  for (const StaticIterate& row : answer.solution.history) {
    residuals.push_back(row.residual);
    times.push_back(row.seconds);
  }
  Json document{{"problem", problem.id},
                {"material", json_or_null(problem.material)},
                {"parameters", parameters_json(problem.parameters)},
                {"load_scale", answer.load_scale},
                {"solver", name_of(answer.settings.method)},
                {"linear", name_of(answer.settings.inner)},
                HMAX_KEYS(answer, outcome, status),
                {"stable", stable_json(answer.solution)},
                {"iterations", answer.solution.iterations},
                {"residuals", residuals},
                {"times", times},
                {"seconds", answer.seconds},
                {"max_displacement", largest_displacement(answer.solution.q)},
                HMAX_KEYS(answer, energy, least_volume),
                {"suggested_support", suggested_support_json(answer.suggested_support)},
                {"body", body_json(problem)},
                {"picture", json_or_null(picture)}};
  if (answer.threads) document["threads"] = *answer.threads;
  if (answer.tool) document["tool"] = answer.tool->json();
  return document;
}

/// Where no equilibrium was found, the status says whether the support is the cause.
std::string words_of_support(const StaticAnswer& answer) {
  return answer.suggested_support && answer.outcome == "converged"
             ? in_words(*answer.suggested_support) + "\n"
             : "";
}

std::string words_of(const StaticAnswer& answer, const Console& console) {
  constexpr std::size_t all = 40, ends = 10;  // of a long history the first and the last rows are shown
  const std::vector<StaticIterate>& history = answer.solution.history;
  const std::string time =
      answer.threads ? fmt::format("elapsed ({})", counted(*answer.threads, "thread")) : "time";
  TextTable table({"iteration", "load step", "residual", time, "inner iterations"});
  for (std::size_t i = 0; i < history.size(); ++i) {
    const StaticIterate& row = history[i];
    if (history.size() > all && i > ends && i + ends < history.size()) {
      if (i == ends + 1) table.add({"...", "", "", "", ""});
      continue;
    }
    table.add({std::to_string(row.iteration), std::to_string(row.load_step), short_number(row.residual, 3),
               fmt::format("{} ms", short_number(1000 * row.seconds, 3)), std::to_string(row.inner)});
  }
  return fmt::format(
      "{} with {}\n{}\n{}, {}\n\n{}\n{}{}\nlargest displacement {} mm, potential energy {} J\n{}{}",
      answer.problem.id, describe_acting(answer.problem, answer.load_scale), body_in_words(answer.problem),
      name_of(answer.settings.method), name_of(answer.settings.inner), table.text(console), answer.outcome,
      answer.status.empty() ? "" : ": " + answer.status,
      short_number(1000 * largest_displacement(answer.solution.q), 5), short_number(answer.energy, 5),
      answer.tool ? "tool: " + answer.tool->words() + "\n" : "", words_of_support(answer));
}

void solve(const StaticOptions& options, Console& console) {
  options.picture.check();
  refuse_ignored(options);
  const Problem problem = options.problem.make();
  options.problem.remark_idle(console, problem);
  refuse_unsuited(options, problem);
  const double scale = scale_of(options);
  const StaticModel model = static_model(problem, scale);
  const StaticSettings settings = settings_of(options);
  const bool frames = !options.per_frame.empty() || !options.frames.empty(),
             compares = !options.compare.empty();
  if (frames || compares) refuse_unheld(problem, scale);
  remark_unusual(console, problem);
  if (compares) return print_comparison(options, problem, model, settings, console);
  if (frames) return print_frames(options, problem, model, settings, console);

  const StaticAnswer answer = answer_of(problem, model, settings, scale, given_jobs(options.jobs), console);
  if (answer.outcome != "converged") console.exit_code = Exit::failed;
  if (!options.output.empty()) write_csv(options.output, history_of(answer));
  if (options.picture.wanted())
    options.picture.write(picture_of(options, problem, settings, answer.solution, answer.outcome));
  if (answer.solution.converged && !answer.solution.stable.value_or(true)) console.remark(answer.status);
  if (answer.solution.converged) warn_of_tool(console, problem, equilibrium_time(problem), answer.solution.q);
  console.show(json_of(answer, options.picture.wanted() ? options.picture.file : ""),
               words_of(answer, console));
}

}  // namespace

void add_static(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "static", "Solve for the static equilibrium of a body on a mesh under a load",
      {"hmax static --mesh liver --model fem_green --material liver:male_normal --load gravity",
       "hmax static --mesh phantom --load press --load-scale 0.5 --solver modified_newton --linear sor",
       "hmax static --mesh liver --load press --set force=0.5 --picture results/runs/pressed_liver.svg",
       "hmax static --mesh phantom --load press --compare results/runs/static",
       "hmax static --mesh phantom --load press --pseudo-dynamic 1 --frames 50 --json"},
      solve);
  options.problem.add_to(command);
  add_number(command, "--load-scale", options.load_scale, "Factor of the load; 1 by default");
  add_text(command, "--solver", options.solver,
           "Solver: newton, modified_newton or linear; newton by default", "NAME");
  add_text(command, "--linear", options.linear, "Linear solver: direct, sor or cg; direct by default",
           "NAME");
  add_text(command, "--load-steps", options.load_steps,
           "Number of load steps; 1, then 10, or 20 along the path of a tool, by default", "NUMBER");
  add_text(command, "--iterations", options.iterations,
           "Limit of iterations in each load step; 1000 by default", "NUMBER");
  add_number(command, "--tolerance", options.tolerance,
             "Tolerance of the residual, relative to the load; 1e-9 by default");
  add_number(command, "--linear-tolerance", options.inner_tolerance,
             "Tolerance of sor and cg; as Newton's method needs, else 1e-4, by default");
  add_number(
      command, "--relaxation", options.relaxation,
      "Relaxation factor of sor, between 0 and 2; 1.5, with --compare the best for the stiffness at rest, by default");
  add_flag(command, "--no-line-search", options.no_line_search, "Newton's method without line search");
  add_text(
      command, "--pseudo-dynamic", options.per_frame,
      "Increase the load frame by frame with this number of iterations in each, and show the error of the frames",
      "NUMBER");
  add_text(command, "--frames", options.frames, "Number of frames; 100 by default", "NUMBER");
  add_text(command, "--output", options.output, "Write the history of residuals to a CSV file", "FILE");
  add_text(command, "--compare", options.compare,
           "Solve with every solver and draw residuals against iterations and time into this folder",
           "FOLDER");
  options.picture.add_to(command, "Draw the body in equilibrium and at rest");
  options.jobs = add_jobs_of_timed(command);
  add_force(command);
  add_figure_style(command);
}

}  // namespace hmax
