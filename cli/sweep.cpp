/// hmax sweep: problems x methods x steps or tolerances, measured into a store.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "bench/timing/dealt_sweep.hpp"
#include "bench/timing/sweep_file.hpp"
#include "catalogue/models/model.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/device_option.hpp"
#include "cli/shared/mpirun.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/shared/shown_text.hpp"
#include "cli/shared/work_limit.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/ranks/ranks.hpp"
#include "core/text/split.hpp"
#include "plots/draw.hpp"
#include "plots/steps.hpp"
#include "results/fingerprint.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

struct SweepOptions {
  std::string file, problems, materials, methods, tableaux, h, rtol, readings, control, y0, repeats,
      max_steps, shard, out, output;
  MeshOptions body;
  MatrixOptions own;
  std::vector<std::string> set;
  std::optional<double> atol, t_end;
  bool fixed = false, sampled = false, resume = false, publish = false, explore = false;
  DeviceChoice device;
  const CLI::Option* jobs = nullptr;
};

SweepRequest flags_of(const SweepOptions& options) {
  SweepRequest request;
  const auto names = [](const char* flag, const std::string& text, auto& value) {
    if (!text.empty()) value = parse_names(flag, text);
  };
  names("--problem", options.problems, request.problems);
  if (const std::string id = options.body.problem_id(); !id.empty()) {
    if (request.problems) throw InputError("--problem and --mesh are both given; choose one of them");
    request.problems = {id};
  }
  if (const std::string id = options.own.problem_id(); !id.empty()) {
    if (request.problems) throw InputError("--matrices and another model are both given; choose one of them");
    request.problems = {id};
  }
  request.unit = options.body.metres();
  names("--materials", options.materials, request.materials);
  names("--methods", options.methods, request.methods);
  names("--tableau", options.tableaux, request.tableaux);
  names("--readings", options.readings, request.readings);
  const auto numbers = [](const char* flag, const std::string& text, auto& value) {
    if (!text.empty()) value = parse_numbers(flag, text);
  };
  numbers("--h", options.h, request.h);
  numbers("--rtol", options.rtol, request.rtol);
  numbers("--y0", options.y0, request.y0);
  if (options.fixed || options.sampled) {
    if (request.readings)
      throw InputError("--readings and --fixed or --sampled say the same; give one of them");
    request.readings.emplace();
    if (options.fixed) request.readings->emplace_back(reading_names[0]);
    if (options.sampled) request.readings->emplace_back(reading_names[1]);
  }
  request.parameters = options.body.parameters(options.set, options.materials);
  for (const auto& parameter : options.own.parameters(options.set)) request.parameters.push_back(parameter);
  for (auto& parameter : parse_assignments("--set", options.set))
    request.parameters.push_back(std::move(parameter));
  request.atol = options.atol;
  request.t_end = options.t_end;
  if (!options.control.empty()) request.control = options.control;
  if (!options.repeats.empty()) request.repeats = parse_count("--repeats", options.repeats, 1);
  if (!options.max_steps.empty()) request.max_steps = parse_count("--max-steps", options.max_steps, 1);
  if (!options.out.empty()) request.out = options.out;
  return request;
}

/// @throws InputError  for what is not of fixed steps of hmax, measured in turn
void place_on_device(const SweepOptions& options, const SweepRequest& request, SweepSpec& spec) {
  const auto& readings = request.readings;
  options.device.check({{"--jobs", is_given(options.jobs)},
                        {"--explore", options.explore},
                        {"--rtol", request.rtol.has_value()},
                        {"--sampled", readings && std::ranges::find(*readings, "sampled") != readings->end()},
                        {"--tableau", request.tableaux.has_value()}});
  spec.sampled = false;
  spec.place = [&device = options.device](const std::vector<Problem>& problems, std::vector<Method>& methods,
                                          std::vector<LeftOut>& left_out) {
    static_cast<void>(device.place(problems, methods, left_out));
  };
}

/// What is swept.
/// @throws InputError  for what asks for times that exploring does not measure
SweepSpec spec_of(const SweepOptions& options, const SweepRequest& request) {
  SweepSpec spec = spec_from(request);
  if (options.device.is_gpu()) place_on_device(options, request, spec);
  if (is_given(options.jobs) && !options.explore)
    throw InputError("a sweep is measured on one thread; add --explore, or leave --jobs out");
  if (!options.explore) return spec;
  if (options.publish)
    throw InputError("--explore measures no times that are fit to publish; leave --publish out");
  if (!options.output.empty())
    throw InputError("--explore measures no times that are fit for figures; leave --output out");
  spec.explore = true;
  if (!request.repeats) spec.repeats = 1;
  return spec;
}

/// The store of a sweep, named after its file and its shard where nobody names it.
std::filesystem::path sweep_store_path(const SweepRequest& request, const std::string& sweep_file,
                                       const std::optional<Shard>& shard) {
  std::string plain = sweep_file.empty() ? "sweep" : std::filesystem::path(sweep_file).stem().string();
  if (shard) plain += fmt::format("_{}_of_{}", shard->index, shard->count);
  return store_path(request.out.value_or(plain));
}

/// Rows that belong to one sweep of one problem in one reading.
struct Group {
  std::string title;
  std::vector<const Row*> rows;
};

std::vector<Group> groups_of(const SweepPlan& plan, const std::vector<Row>& rows) {
  std::vector<Group> groups;
  for (const Row& row : rows) {
    std::string title = row.key.problem;
    if (!row.key.material.empty()) title += ":" + row.key.material;
    // Only where two problems of the sweep have the same name are their parameters what tells them apart.
    const auto same = [&](const Problem& p) {
      return p.id == row.key.problem && p.material == row.key.material;
    };
    if (std::ranges::count_if(plan.problems, same) > 1)
      title += " with " + row.key.parameters + ", y0 " + row.key.y0;
    title += ", " + row.key.mode;
    if (is_on_device(row)) title += " on " + row.key.device;
    if (row.key.mode == "sampled") title += " at " + in_words(Tolerances<double>{row.key.rtol, row.key.atol});
    if (groups.empty() || groups.back().title != title) groups.push_back({std::move(title), {}});
    groups.back().rows.push_back(&row);
  }
  return groups;
}

/// The fastest of the rows whose error is at most `error`; null when there is none.
const Row* fastest(const Group& group, double error) {
  const Row* best = nullptr;
  double best_time = 0;
  for (const Row* row : group.rows) {
    const double median = summarise(times_of(*row)).median;
    if (!(row->error_global <= error) || !(median > 0) || (best && median >= best_time)) continue;
    best = row;
    best_time = median;
  }
  return best;
}

/// The powers of ten between which the errors of a group are; those of more than the initial state, and than
/// 1, are of runs that have grown away.
struct Decades {
  int most, least;
};
Decades decades_of(const Group& group) {
  double least = infinity, most = 0;
  for (const Row* row : group.rows)
    if (row->error_global > 0 && std::isfinite(row->error_global)) {
      least = std::min(least, row->error_global);
      most = std::max(most, row->error_global);
    }
  if (most == 0) return {0, 0};
  double size = 1;
  for (const std::string_view part : split(group.rows.front()->key.y0, ","))  // "rest" of a body has none
    if (const auto y = to_number(part)) size = std::max(size, std::abs(*y));
  most = std::min(most, std::max(size, least));
  return {static_cast<int>(std::ceil(std::log10(most))), static_cast<int>(std::floor(std::log10(least)))};
}

/// The fastest row for each power of ten of the error; one that serves several is shown at the smallest.
/// Empty where no run has an error.
std::string fastest_table(const Group& group, const Console& console) {
  const Row& first = *group.rows.front();
  const bool adaptive = first.key.mode == "adaptive";
  TextTable table({"error at most", "fastest method", adaptive ? "tolerances" : "h [s]", "error",
                   fmt::format("{}{} [s]", first.explored ? "approximate " : "", name_of_time(first.key)),
                   "real-time factor"});
  const Decades decades = decades_of(group);
  bool is_empty = true;
  for (int decade = decades.most; decade >= decades.least; --decade) {
    const Row* best = fastest(group, std::pow(10.0, decade));
    if (!best || (decade > decades.least && best == fastest(group, std::pow(10.0, decade - 1)))) continue;
    const double median = summarise(times_of(*best)).median;
    is_empty = false;
    table.add(
        {fmt::format("1e{}", decade), best->key.method,
         adaptive ? in_words(Tolerances<double>{best->key.rtol, best->key.atol}) : short_number(best->key.h),
         short_number(best->error_global, 2), short_number(median, 3),
         short_number(best->key.t_end / median, 3)});
  }
  return is_empty ? "" : console.strong(group.title) + "\n" + table.text(console) + "\n";
}

bool failed(const Row& row) { return row.outcome != "reached_end"; }

/// "rk4, fixed, h = 2 s: diverged at t = 14 s", with the problem where there are several.
std::string words_of_failure(const SweepPlan& plan, const Row& row) {
  const RowKey& key = row.key;
  std::string text;
  if (plan.problems.size() > 1) text = key.problem + (key.material.empty() ? "" : ":" + key.material) + ", ";
  const std::string setting = key.mode == "adaptive" ? in_words(Tolerances<double>{key.rtol, key.atol})
                                                     : fmt::format("h = {} s", short_number(key.h));
  return text + fmt::format("{}, {}, {}: {} at t = {} s", key.method, key.mode, setting, row.outcome,
                            short_number(row.t_reached));
}

Json failures_json(const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& row : rows)
    if (failed(row)) {
      const bool fixed = row.key.mode == "fixed";
      list.push_back({HMAX_KEYS(row.key, problem, material, method, mode),
                      {"h", row.key.mode == "adaptive" ? Json() : Json(row.key.h)},
                      {"rtol", fixed ? Json() : Json(row.key.rtol)},
                      {"atol", fixed ? Json() : Json(row.key.atol)},
                      HMAX_KEYS(row, outcome, t_reached)});
    }
  return list;
}

/// The tolerances of a plan, [{mode, rtol, atol}].
Json tolerances_json(const SweepPlan& plan) {
  Json list = Json::array();
  for (const SweepBlock& block : plan.blocks) {
    if (!block.run.adaptive) continue;
    const Json one{{"mode", block.mode}, HMAX_KEYS(block.run, rtol, atol)};
    if (std::ranges::find(list, one) == list.end()) list.push_back(one);
  }
  return list;
}

Json tasks_json(const std::vector<DealtTask>& tasks) {
  Json list = Json::array();
  for (const DealtTask& task : tasks)
    list.push_back({HMAX_KEYS(task, rank, problem, rows, expected_seconds, seconds)});
  return list;
}

/// The rows that did not reach the end, the first of them one by one.
std::string words_of_failures(const SweepPlan& plan, const std::vector<Row>& rows, const std::string& store) {
  constexpr std::ptrdiff_t most_shown = 20;
  const std::ptrdiff_t count = std::ranges::count_if(rows, failed);
  if (count == 0) return {};
  std::string text = fmt::format("{} of them did not reach the end:\n", count);
  std::ptrdiff_t shown = 0;
  for (const Row& row : rows)
    if (failed(row) && ++shown <= most_shown) text += "  " + words_of_failure(plan, row) + "\n";
  if (count > most_shown)
    text += fmt::format("  and {} more; `hmax export {} --format csv` has them all\n", count - most_shown,
                        shell_word(store));
  return text;
}

std::string for_people(const SweepPlan& plan, const Store& store, const SweepSummary& summary,
                       const Console& console) {
  const std::vector<Row> rows = store.rows();
  std::string text;
  for (const Group& group : groups_of(plan, rows)) text += fastest_table(group, console);
  const auto subnormal = std::ranges::count_if(rows, [](const Row& row) { return row.subnormals > 0; });
  text +=
      fmt::format("{} rows in {}: {} measured in {} s, {} were there already\n", summary.rows,
                  store.file().string(), summary.measured, short_number(summary.seconds, 3), summary.skipped);
  text += words_of_failures(plan, rows, store.file().string());
  if (subnormal > 0)
    text +=
        fmt::format("{} of them met subnormal numbers, which can make a run many times slower\n", subnormal);
  if (!rows.empty() && is_on_device(rows.front()))
    text +=
        fmt::format("times of {}, {} MHz, {}, {} precision, without copies\n", rows.front().key.device,
                    short_number(rows.front().clock_mhz, 4), rows.front().driver, rows.front().key.precision);
  return text + fmt::format("\nAll of it: hmax export {} --format csv\n", shell_word(store.file().string()));
}

/// "sweep", and behind it which problem of a plan with several.
std::string figure_name(const SweepPlan& plan, std::size_t problem) {
  return plan.problems.size() == 1 ? "sweep" : fmt::format("sweep_{}", problem + 1);
}

/// One figure for each problem: cost and error over the step or, of a sweep over tolerances, over each other.
/// @returns the files, SVG
std::vector<std::string> draw_sweep(const SweepPlan& plan, const Store& store, const std::string& folder,
                                    Console& console) {
  std::vector<ShownMethod> shown;
  for (const Method& method : plan.methods) shown.push_back({.id = method.id, .order = method.order});
  const std::vector<Row> rows = store.rows();
  std::vector<std::string> files;
  for (std::size_t i = 0; i < plan.problems.size(); ++i) {
    const Problem& problem = plan.problems[i];
    std::vector<Row> own;
    for (const Row& row : rows)
      if (row.key.problem == problem.id && row.key.material == problem.material &&
          row.key.parameters == describe(problem.parameters) && row.key.y0 == start_in_words(problem))
        own.push_back(row);
    const bool over_steps =
        std::ranges::any_of(own, [](const Row& row) { return row.key.mode != "adaptive"; });
    Figure figure = over_steps ? step_figure(own, shown) : work_precision_figure(own, shown);
    figure.title = problem.id + (problem.material.empty() ? "" : " of " + problem.material);
    figure.footer = summary(store.sessions().back().fingerprint);
    std::string svg = drawn_svg(figure, folder, figure_name(plan, i), console);
    if (!svg.empty()) files.push_back(std::move(svg));
  }
  return files;
}

/// Warns of methods that are left out.
/// @throws InputError  for a sweep without end: sweeps may take days; what takes years is a mistake
void look_over(const SweepPlan& plan, Console& console) {
  warn_of_left_out(console, plan.left_out);
  constexpr double most_days = 30;
  double seconds = 0;
  for (const SweepBlock& block : plan.blocks) seconds += expected_cost(plan, block, block.methods);
  const auto rows = static_cast<double>(plan.rows());
  if (rows > 0)
    refuse_endless({.asked = "this sweep",
                    .count = rows,
                    .of = "rows",
                    .seconds_each = seconds / rows,
                    .most_seconds = most_days * 86400,
                    .remedy = "take a shorter --t-end or larger --h, or divide it with --shard"});
}

SweepRequest request_of(const SweepOptions& options) {
  const SweepRequest flags = flags_of(options);
  return options.file.empty() ? flags : merged(read_sweep(options.file), flags);
}

/// @throws InputError  for what asks for times where ranks that share a node measure none
void refuse_beside_ranks(const SweepOptions& options, const SweepPlan& plan, const Ranks& ranks) {
  if (is_given(options.jobs))
    throw InputError(
        "--jobs is of one process; leave it out, and start as many processes as there are cores");
  if (!are_times_rough(plan, ranks)) return;
  if (options.publish || !options.output.empty())
    throw InputError(fmt::format(
        "processes that share a node measure no times that are fit for {}; leave it out, or start one process a node "
        "(mpirun --map-by ppr:1:node)",
        options.publish ? "--publish" : "--output"));
}

Json document_of(const SweepPlan& plan, const Store& store, const std::filesystem::path& file,
                 const SweepSummary& summary, const std::vector<std::string>& figures) {
  const std::vector<Row> rows = store.rows();
  Json document{{"store", file.string()},
                HMAX_KEYS(summary, rows, measured, skipped, seconds, ranks),
                {"batches", summary.hands},
                {"hands", summary.hands},  // the old names
                {"distribution_seconds", summary.dealing_seconds},
                {"dealing_seconds", summary.dealing_seconds},
                {"tasks", tasks_json(summary.tasks)},
                {"tolerances", tolerances_json(plan)},
                {"interrupted", summary.interrupted},
                {"failed", failures_json(rows)},
                {"figures", figures},
                {"warnings", summary.warnings}};
  if (rows.empty() || !is_on_device(rows.front())) return document;
  // As `hmax run --device gpu` tells it.
  const Row& row = rows.front();
  document["device"] = row.key.device;
  document["clock_mhz"] = row.clock_mhz;
  document["driver"] = row.driver;
  document["precision"] = row.key.precision;
  return document;
}

void sweep(const SweepOptions& options, Console& console) {
  options.device.check({});
  // Processes that share a card would disturb one another's times.
  if (options.device.is_gpu() && options.shard.empty()) refuse_copies("hmax sweep --device gpu");
  // With --shard each process has a part and a store of its own.
  const std::unique_ptr<Ranks> ranks =
      options.shard.empty() && processes_started() > 1 ? open_ranks(processes_started()) : nullptr;
  // From here on Ctrl-C keeps the rows before the one at hand, also while a reference is computed.
  const auto& interrupted = interrupt_flag();
  const std::function<bool()> is_interrupted = [&] { return interrupted.load(); };
  if (ranks && ranks->rank() > 0)
    return help_sweep(
        *ranks, [&] { return plan_sweep(spec_of(options, request_of(options))); }, is_interrupted);
  std::optional<SweepDealer> dealer;
  if (ranks) dealer.emplace(*ranks);
  const SweepRequest request = request_of(options);
  const std::optional<Shard> shard = shard_from(options.shard);
  const SweepSpec spec = spec_of(options, request);
  const SweepPlan plan = shard ? shard_of(plan_sweep(spec), *shard) : plan_sweep(spec);
  if (ranks) refuse_beside_ranks(options, plan, *ranks);
  options.body.remark_scene(console);
  look_over(plan, console);
  const std::filesystem::path file = sweep_store_path(request, options.file, shard);
  if (options.publish) require_publishable_build();
  for (std::size_t i = 0; i < plan.problems.size(); ++i) check_figure(options.output, figure_name(plan, i));
  Store store = open_sweep_store(plan, file, options.resume);
  if (options.publish) mark_published(store);

  SweepSummary summary;
  {
    Progress progress(console, "sweep");
    const auto show = [&](const SweepProgress& p) { progress.update(p.fraction, p.what); };
    summary = dealer ? dealer->run(plan, store, show, is_interrupted)
                     : run_sweep(plan, store, show, is_interrupted);
  }
  for (const std::string& warning : summary.warnings) console.remark(warning);
  std::vector<std::string> figures;
  // A shard may have no row.
  if (!options.output.empty() && !summary.interrupted && summary.rows > 0)
    figures = draw_sweep(plan, store, options.output, console);
  if (console.json) {
    console.print_json(document_of(plan, store, file, summary, figures));
  } else if (!summary.interrupted) {
    console.print(for_people(plan, store, summary, console));
    for (const std::string& figure : figures) console.print(fmt::format("The figure: {}\n", figure));
  }
  if (summary.interrupted) {
    console.note(fmt::format("interrupted; {} of {} rows are in {}, --resume measures the rest", summary.rows,
                             plan.rows(), file.string()));
    console.exit_code = Exit::interrupted;
  }
}

/// How steps are chosen.
void add_step_options(CLI::App& command, SweepOptions& options) {
  add_text(command, "--h", options.h, "Step sizes [s]; the nine of the study by default", "NUMBERS");
  add_text(command, "--readings", options.readings,
           "What a step means: fixed, sampled or both; both by default", "A,B");
  add_flag(command, "--fixed", options.fixed, "Integrate with steps of h");
  add_flag(command, "--sampled", options.sampled,
           "Step adaptively and output every h, as MATLAB does for 0:h:T");
  add_text(command, "--rtol", options.rtol,
           "Tolerance of --sampled, or without --h the tolerances to sweep; 1e-6 by default", "NUMBERS");
  add_number(command, "--atol", options.atol, "Absolute tolerance; equal to --rtol by default");
  add_control(command, options.control);
}

}  // namespace

void add_sweep(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "sweep",
      "Measure CPU time and error over steps or tolerances; without options the study's own step sweep, "
      "which takes about a minute",
      {"hmax sweep --methods rk4,ode45 --h 0.1,0.01 --t-end 10 --out quick",
       "hmax sweep --problem liver_benchmark --materials all --methods rk4 --h 0.1 --fixed --out livers",
       "hmax sweep --methods ode23,ode45,dop_853 --rtol 1e-4,1e-6,1e-8 --out tolerances --output "
       "results/runs/tolerances",
       "hmax sweep --mesh phantom --model mass_spring --methods rk4,symplectic_euler --h 2e-3,1e-3 --fixed --t-end 0.2 "
       "--out phantom"},
      sweep);
  add_footer(command, "Under `mpirun -n N` the processes share the sweep, see docs/howto/cluster.md.");
  add_text(command, "file", options.file,
           "A sweep in a file, see docs/reference/sweep.md; flags go before it", "FILE.toml");
  add_text(command, "--problem,--problems", options.problems,
           "Ids of `hmax list problems`, or files of formulas", "A,B");
  options.body.add_to(command);
  options.own.add_to(command);
  add_text(command, "--materials,--material", options.materials, "Ids of `hmax list materials`, or all",
           "A,B");
  add_settings(command, options.set, options.y0);
  add_text(command, "--methods,--method", options.methods,
           "Ids, aliases or families of `hmax list methods`, or all; those of the study by default", "A,B");
  add_text(command, "--tableau", options.tableaux, "Files with explicit tableaux of your own", "A,B");
  add_step_options(command, options);
  add_number(command, "--t-end", options.t_end, "End time [s]; the problem's own by default");
  add_text(command, "--repeats", options.repeats,
           "Timed repetitions, at least 9, or 1 with --explore; 9, or 1 with --explore, by default",
           "NUMBER");
  add_shard(command, options.shard);
  add_text(command, "--max-steps", options.max_steps, "Steps allowed in a run; 1e9 by default", "NUMBER");
  add_text(
      command, "--out", options.out,
      "Name of the store under results/runs/, or a file that ends in .sqlite; sweep, or that of FILE.toml, by default",
      "NAME");
  add_text(
      command, "--output", options.output,
      "Draw cost and error into this folder: sweep.svg, .png and .pdf; of several problems sweep_1.svg and so on",
      "FOLDER");
  add_figure_style(command);
  add_force(command);
  add_flag(command, "--resume", options.resume, "Continue an interrupted sweep: measure the missing rows");
  add_flag(command, "--publish", options.publish,
           "Mark the store as fit to publish; refused for debug builds");
  add_flag(
      command, "--explore", options.explore,
      "Measure on all cores, many rows at once: the times are approximate, and no figure or comparison takes them");
  options.device.add_to(command, "fixed steps of bodies");
  options.jobs = add_jobs(command);
}

}  // namespace hmax
