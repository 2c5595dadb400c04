/// hmax precision: what an error costs, method against method.
#include "bench/timing/precision.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "bench/timing/reference.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/mpirun.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "core/process/temporary_folder.hpp"
#include "plots/draw.hpp"
#include "plots/steps.hpp"
#include "results/fingerprint.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

struct PrecisionOptions {
  ProblemChoice problem;
  std::string methods, rtol, h, control, repeats, shard, store, output;
  std::string error;
  std::optional<double> t_end, atol_over_rtol, budget;
};

/// The error that is asked for; by default that of the end of stiff problems, whose largest one is that of
/// jumps which come a little early or late.
ErrorOf error_of(const PrecisionOptions& options, const Problem& problem) {
  constexpr std::array<std::string_view, 3> words{"end", "max", "l2"};
  if (options.error.empty()) return problem.stiff ? ErrorOf::end : ErrorOf::largest;
  const std::string word = parse_choice("--error", options.error, words);
  return word == "end" ? ErrorOf::end : word == "max" ? ErrorOf::largest : ErrorOf::root_mean_square;
}

PrecisionSpec spec_of(const PrecisionOptions& options) {
  PrecisionSpec spec;
  ProblemChoice problem = options.problem;
  if (problem.empty()) problem.problem = SweepProblem{}.name;
  spec.problem = {.name = problem.id(), .settings = problem.settings()};
  if (options.methods.empty())
    throw InputError(
        "no methods are given; name them with --methods, like ode45,dop_853, or a family of `hmax list "
        "methods`");
  spec.methods = parse_names("--methods", options.methods);
  if (!options.rtol.empty()) spec.rtol = parse_numbers("--rtol", options.rtol);
  if (!options.h.empty()) spec.h = parse_numbers("--h", options.h);
  if (options.atol_over_rtol) spec.atol_over_rtol = *options.atol_over_rtol;
  if (!options.control.empty()) spec.control = controllers_from(options.control);
  if (!options.repeats.empty()) spec.repeats = static_cast<int>(parse_count("--repeats", options.repeats, 9));
  spec.t_end = options.t_end;
  if (options.budget) {
    spec.budget_s = *options.budget;
    if (!(spec.budget_s > 0)) throw InputError("--budget is a CPU time [s] and must be above 0");
  }
  // An option that no method would look at is a mistake.
  const std::vector<Method> methods = choose_methods(spec.methods, {});
  if (!spec.rtol.empty() && std::ranges::none_of(methods, &Method::adaptive))
    throw InputError(
        "--rtol is for methods with an error estimate, and none of these has one; give their steps with --h");
  if (!spec.h.empty() && std::ranges::all_of(methods, &Method::adaptive))
    throw InputError(
        "--h is for methods without an error estimate, and all of these have one; give their tolerances with "
        "--rtol");
  return spec;
}

/// The largest stable step of each method, where it is known.
using StepLimits = std::map<std::string, std::optional<double>>;

Json limit_of(const StepLimits& limits, const std::string& method) {
  const std::optional<double> h = limits.at(method);
  return !h ? Json() : std::isfinite(*h) ? Json(*h) : Json("unbounded");
}

Json to_json(const std::vector<Row>& rows, const StepLimits& limits, const std::string& error_of) {
  Json document = Json::array();
  for (const Row& row : rows) {
    const TimingSummary time = summarise(row.cpu_s);
    document.push_back({HMAX_KEYS(row.key, method, mode),
                        {"rtol", row.key.mode == "fixed" ? Json() : Json(row.key.rtol)},
                        {"atol", row.key.mode == "fixed" ? Json() : Json(row.key.atol)},
                        {"h", row.key.mode == "fixed" ? Json(row.key.h) : Json()},
                        HMAX_KEYS(row, outcome, error_global, error_end, error_l2),
                        {"error_of", error_of},
                        {"cpu_median_s", time.median},
                        {"cpu_q1_s", time.q1},
                        {"cpu_q3_s", time.q3},
                        HMAX_KEYS(row, rhs, steps),
                        {"h_stable", limit_of(limits, row.key.method)},
                        HMAX_KEYS(row, reference, reference_error, status)});
  }
  return document;
}

/// "atol = rtol" of adaptive rows; empty where there are none.
std::string words_of_atol(const std::vector<Row>& rows, double atol_over_rtol) {
  if (std::ranges::all_of(rows, [](const Row& row) { return row.key.mode == "fixed"; })) return {};
  return fmt::format("atol = {}rtol\n", atol_over_rtol == 1 ? "" : short_number(atol_over_rtol) + " ");
}

double value_of(const Row& row, ErrorOf which) {
  return which == ErrorOf::end ? row.error_end : which == ErrorOf::largest ? row.error_global : row.error_l2;
}

std::string for_people(const std::vector<Row>& rows, ErrorOf which, const Console& console) {
  TextTable table({"method", "rtol or h [s]", "error", "CPU time [s]", "rhs", "outcome"});
  for (const Row& row : rows) {
    const double error = value_of(row, which);
    table.add(
        {row.key.method,
         row.key.mode == "fixed" ? "h " + short_number(row.key.h) : "rtol " + short_number(row.key.rtol),
         std::isnan(error) ? "-" : short_number(error, 2), short_number(summarise(row.cpu_s).median, 3),
         std::to_string(row.rhs), row.outcome});
  }
  return table.text(console);
}

/// What a figure shows: the error that is asked for, where it is less than the solution.
std::vector<Row> useful(std::vector<Row> rows, ErrorOf which, double size) {
  for (Row& row : rows) row.error_global = value_of(row, which);
  std::erase_if(rows, [&](const Row& row) { return row.error_global > size; });
  return rows;
}

SweepPlan plan_of(const PrecisionOptions& options) {
  const std::optional<Shard> shard = shard_from(options.shard);
  if (shard && options.store.empty())
    throw InputError("--shard measures a part, whose rows would be lost; add --store FILE.sqlite");
  SweepPlan plan = plan_sweep(precision_sweep(spec_of(options)));
  return shard ? shard_of(std::move(plan), *shard) : plan;
}

/// A shard without rows, of more shards than blocks: its store is made all the same, so that a merge finds
/// it.
void say_empty(const PrecisionOptions& options, const SweepPlan& plan, Console& console) {
  open_sweep_store(plan, options.store, true);
  console.show(Json::array(),
               fmt::format("shard {} has nothing to measure; {} is empty\n", options.shard, options.store));
}

void precision(const PrecisionOptions& options, Console& console) {
  if (!options.store.empty() && options.shard.empty()) refuse_copies("hmax precision --store");
  check_figure(options.output, "precision");
  const SweepPlan plan = plan_of(options);
  if (plan.blocks.empty()) return say_empty(options, plan, console);
  options.problem.body.remark_scene(console);
  warn_of_left_out(console, plan.left_out);
  const TemporaryFolder temporary;
  Store store = open_sweep_store(
      plan,
      options.store.empty() ? temporary.path() / "precision.sqlite" : std::filesystem::path(options.store),
      !options.store.empty());
  StepLimits limits;
  std::optional<double> size;  // of the solution at the end
  {
    Progress progress(console, "precision");
    run_shown_sweep(plan, store, options.store, progress, console);
    progress.update(1, "limits of the step");
    const double t_end = plan.blocks.front().run.t_end;
    const Reference reference = make_reference(plan.problems.front(), t_end, [&] {
      if (!interrupt_flag()) return;
      throw options.store.empty() ? Interrupted{} : Interrupted::with_store(options.store, store.size());
    });
    size = reference.at(std::min(t_end, reference.valid_until)).cwiseAbs().maxCoeff();
    for (const Method& method : plan.methods)
      limits[method.id] = predicted_step_limit(method, plan.problems.front(), reference, t_end);
  }
  const std::vector<Row> rows = store.rows();
  const Problem& problem = plan.problems.front();
  const ErrorOf which = error_of(options, problem);
  const std::string words = error_in_words(problem, which);
  std::string drawn;
  if (!options.output.empty()) {
    std::vector<ShownMethod> shown;
    for (const Method& method : plan.methods)
      shown.push_back(
          {.id = method.id, .order = method.order, .stable_step = limits.at(method.id).value_or(0)});
    Figure figure = work_precision_figure(useful(rows, which, *size), shown, words);
    figure.footer = summary(store.sessions().back().fingerprint);
    const std::string svg = drawn_svg(figure, options.output, "precision", console);
    if (!svg.empty()) drawn = fmt::format("The figure: {}\n", svg);
  }
  console.show(to_json(rows, limits, words),
               fmt::format("{}\nerror: {}\n{}{}", for_people(rows, which, console), words,
                           words_of_atol(rows, options.atol_over_rtol.value_or(1)), drawn));
}

}  // namespace

void add_precision(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "precision",
      "Draw a work-precision diagram: CPU time and evaluations of f over the error; on liver_forced by default",
      {"hmax precision --problem liver_forced --methods ode45,dop_853 --rtol 1e-4,1e-8",
       "hmax precision --mesh phantom --methods rk4,newmark --h 1e-3,5e-4 --t-end 0.05",
       "hmax precision --problem liver_forced --methods explicit_runge_kutta --output "
       "results/runs/precision"},
      precision);
  options.problem.add_to(command);
  add_text(command, "--methods,--method", options.methods,
           "Ids, aliases or families of `hmax list methods`, or all", "A,B");
  add_text(command, "--rtol", options.rtol, "Tolerances of adaptive methods; 1e-3 to 1e-12 by default",
           "NUMBERS");
  add_text(command, "--h", options.h,
           "Step sizes of methods without error estimate [s]; 1/32 of the run and smaller by default",
           "NUMBERS");
  add_number(command, "--atol-over-rtol", options.atol_over_rtol,
             "Absolute over relative tolerance; 1 by default");
  add_text(
      command, "--error", options.error,
      "Error: end, at the end; max, the largest at any accepted step; l2, the root mean square over time; end for "
      "stiff problems, else max, by default",
      "NAME");
  add_number(command, "--budget", options.budget, "CPU time limit of a run [s]; 0.5 by default");
  add_control(command, options.control);
  add_number(command, "--t-end", options.t_end, "End time [s]; the problem's own by default");
  add_text(command, "--repeats", options.repeats, "Timed repetitions, at least 9; 9 by default", "NUMBER");
  add_shard(command, options.shard);
  add_text(command, "--store", options.store, "Keep the rows in this store, a file that ends in .sqlite",
           "FILE");
  add_text(command, "--output", options.output,
           "Draw the figure precision.svg, .png and .pdf into this folder", "FOLDER");
  add_force(command);
  add_figure_style(command);
}

}  // namespace hmax
