/// `hmax reproduce`: published studies done again, figure by figure.
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/timing/sweep.hpp"
#include "cli/reproduce/reproduce_oscillators.hpp"
#include "cli/reproduce/reproduce_stability.hpp"
#include "cli/reproduce/reproduce_tissue.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/stability.hpp"
#include "results/fingerprint.hpp"

namespace hmax {

namespace {

/// The damping of the study's text makes the model self-exciting: its amplitude grows without end and with it
/// the frequency of the cubic spring, so this sweep is short and keeps to the methods that are drawn.
SweepSpec self_exciting_sweep() {
  SweepSpec spec;
  spec.problems = {{"liver_forced", {.material = {}, .parameters = {{"c", -2}}, .y0 = {}}}};
  spec.methods = {"explicit_euler", "dormand_prince_54", "rosenbrock_23", "adams_pece", "trapezoidal"};
  spec.t_end = 10;
  return spec;
}

/// The rows of a sweep, measured unless the store has them already.
std::vector<Row> measured(const SweepSpec& spec, const std::filesystem::path& file, const std::string& task,
                          Console& console, std::string& machine, std::int64_t& count) {
  const SweepPlan plan = plan_sweep(spec);
  if (!can_resume(plan, file)) {
    std::filesystem::path old = file.parent_path() / (file.stem().string() + ".old.sqlite");
    // An older one is kept as well.
    for (int n = 2; std::filesystem::exists(old); ++n)
      old = file.parent_path() / fmt::format("{}.old{}.sqlite", file.stem().string(), n);
    std::filesystem::rename(file, old);
    console.remark(fmt::format("the sweep has changed since {} was measured; it is kept as {}", file.string(),
                               old.string()));
  }
  Store store = open_sweep_store(plan, file, true);
  const std::atomic<bool>& interrupted = interrupt_flag();
  {
    Progress progress(console, task);
    const SweepSummary done = run_sweep(
        plan, store, [&](const SweepProgress& p) { progress.update(p.fraction, p.what); },
        [&] { return interrupted.load(); });
    if (done.interrupted) throw Interrupted{};
    for (const std::string& warning : done.warnings) console.remark(warning);
    count += done.measured;
  }
  machine = summary(store.sessions().back().fingerprint);
  return store.rows();
}

/// Methods of the nonlinear table: one of each kind that has a limit.
constexpr std::array nonlinear_methods{"explicit_euler",    "rk2_heun",         "rk4",
                                       "dormand_prince_54", "dop_853",          "adams_bashforth_3",
                                       "abm_pece_3",        "symplectic_euler", "stormer_verlet",
                                       "central_difference"};

void stability_study(const std::filesystem::path& folder, Console& console) {
  const auto started = std::chrono::steady_clock::now();
  const auto& interrupted = interrupt_flag();
  const auto stop = [&] { return interrupted.load(); };
  const std::vector<LimitCase> cases = limit_cases();
  check_limit_files(folder);
  Store store = Store::open_or_create(folder / "limits.sqlite");
  const auto study = [&](const char* task, CaseKind kind, const std::vector<Method>& chosen) {
    Progress progress(console, task);
    return limit_study(
        cases, kind, chosen, &store, [&](double share) { progress.update(share); }, stop);
  };
  const std::vector<StudyRow> rows = study("predicting and verifying", CaseKind::linear, methods());
  std::vector<Method> chosen;
  for (const char* id : nonlinear_methods) chosen.push_back(find_method(id));
  const std::vector<StudyRow> nonlinear = study("nonlinear models", CaseKind::nonlinear, chosen);
  if (interrupted) throw Interrupted{};
  const std::filesystem::path report =
      reproduce_stability(cases, rows, nonlinear, summary(fingerprint()), folder);
  const LimitSummary found = summary_of(cases, rows);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  if (found.disagreeing > 0) console.exit_code = Exit::failed;
  if (console.json)
    return console.print_json({{"report", report.string()},
                               {"rows", found.rows},
                               {"with_number", found.with_number},
                               {"unbounded", found.unbounded},
                               {"disagreeing", found.disagreeing},
                               {"worst_gap", found.worst_gap},
                               {"worst", found.worst},
                               {"seconds", seconds}});
  console.print(fmt::format(
      "{} pairs of method and model; {} limits within {:.4f} % of what integration shows, {} without limit, {} "
      "disagree.\nOpen {}\n",
      found.rows, found.with_number, 100 * found.worst_gap, found.unbounded, found.disagreeing,
      report.string()));
}

nlohmann::ordered_json to_json(const TissueStudy& study) {
  nlohmann::ordered_json particles = nlohmann::ordered_json::array();
  for (const ParticleLimit& limit : study.particles)
    particles.push_back({{"damping", limit.damping},
                         {"method", limit.method},
                         {"h_max", number_or_word(1 / limit.rate)},
                         {"stiffest", limit.stiffest}});
  nlohmann::ordered_json paths = nlohmann::ordered_json::array();
  for (const PathLimit& limit : study.paths)
    paths.push_back({{"load", limit.load},
                     {"path", limit.path},
                     {"model", limit.model},
                     {"method", limit.method},
                     {"h_rest", number_or_word(limit.at_rest)},
                     {"h_min", number_or_word(limit.least)},
                     {"growing_share", limit.growing}});
  nlohmann::ordered_json sizes = nlohmann::ordered_json::array();
  for (const ScaleRow& row : study.sizes)
    sizes.push_back({{"mesh", row.mesh},
                     {"tetrahedra", row.tetrahedra},
                     {"dofs", row.dofs},
                     {"force", row.force},
                     {"stiffness", row.stiffness},
                     {"explicit_step", row.explicit_step},
                     {"implicit_step", row.implicit_step},
                     {"eigenvalue", row.eigenvalue},
                     {"import", row.import},
                     {"peak_memory", row.peak_memory}});
  return {{"report", study.report.string()},
          {"force_ratio", study.force_ratio},
          {"step_ratio", study.step_ratio},
          {"deflection_springs", study.deflection_springs},
          {"deflection_elements", study.deflection_elements},
          {"unsolved", study.unsolved},
          {"particles", particles},
          {"heaviest_particle", study.heaviest_particle},
          {"paths", paths},
          {"sizes", sizes}};
}

void tissue_study(const std::filesystem::path& folder, TissueOptions options, Console& console) {
  const auto& interrupted = interrupt_flag();
  TissueStudy study;
  {
    Progress progress(console, "tissue");
    options.machine = summary(fingerprint());
    study = reproduce_tissue(folder, options, [&](double share, const std::string& what) {
      if (interrupted) throw Interrupted{};
      progress.update(share, what);
    });
  }
  if (study.unsolved > 0) console.exit_code = Exit::failed;
  if (console.json) return console.print_json(to_json(study));
  console.print(fmt::format(
      "Finite elements cost {:.2g} times the forces and {:.2g} times the step of springs; under the same load the "
      "liver moves by {:.3g} mm with springs and {:.3g} mm with finite elements.\nOpen {}\n",
      study.force_ratio, study.step_ratio, 1000 * study.deflection_springs, 1000 * study.deflection_elements,
      study.report.string()));
}

void oscillator_study(const std::filesystem::path& output, Console& console) {
  StudyRows rows;
  std::int64_t count = 0;
  rows.self_exciting = measured(self_exciting_sweep(), output / "damping_minus_2.sqlite",
                                "timing the model with c = -2", console, rows.machine, count);
  rows.published_model = measured(SweepSpec{}, output / "step_sweep.sqlite", "timing the step sweep", console,
                                  rows.machine, count);
  std::filesystem::path report;
  {
    Progress progress(console, "drawing");
    double drawn = 0;
    report = reproduce_oscillators(rows, output, [&](const std::string& section) {
      progress.update(drawn / 9, section);
      ++drawn;
    });
  }
  if (console.json)
    console.print_json({{"report", report.string()}, {"measured", count}});
  else
    console.print(
        fmt::format("{} rows measured, the others were there already.\nOpen {}\n", count, report.string()));
}

void add_oscillator_study(CLI::App& reproduce, Console& console) {
  CLI::App& oscillators = add_command(reproduce, console, "oscillators",
                                      "Reproduce every figure and table of the liver oscillator study",
                                      {"hmax reproduce oscillators --output results/runs/oscillators"});
  auto folder = std::make_shared<std::string>("results/runs/oscillators");
  oscillators.add_option("--output", *folder, "Folder of the report and of its stores")
      ->capture_default_str();
  oscillators.footer(oscillators.get_footer() +
                     "\nWhat was measured before is kept in FOLDER/*.sqlite and not measured again.");
  add_force(oscillators);
  add_figure_style(oscillators);
  oscillators.callback([&console, folder] { oscillator_study(*folder, console); });
}

void add_stability_study(CLI::App& reproduce, Console& console) {
  CLI::App& stability =
      add_command(reproduce, console, "stability",
                  "Predict and observe the step limits of every method on every model of the study",
                  {"hmax reproduce stability --output results/runs/stability"});
  auto folder = std::make_shared<std::string>("results/runs/stability");
  stability.add_option("--output", *folder, "Folder of the report")->capture_default_str();
  add_force(stability);
  add_figure_style(stability);
  add_jobs(stability);
  stability.callback([&console, folder] { stability_study(*folder, console); });
}

void add_tissue_study(CLI::App& reproduce, Console& console) {
  CLI::App& tissue = add_command(reproduce, console, "tissue",
                                 "Compare springs with finite elements on the phantom and the liver",
                                 {"hmax reproduce tissue --output results/runs/tissue"});
  auto folder = std::make_shared<std::string>("results/runs/tissue");
  tissue.add_option("--output", *folder, "Folder of the report")->capture_default_str();
  auto options = std::make_shared<TissueOptions>();
  tissue.add_flag("--quick", options->quick,
                  "Step limits on the phantom instead of the liver and at a few points; takes seconds");
  tissue.add_flag("--scale", options->scale,
                  "Also costs of meshes of a thousand to a million tetrahedra; takes minutes and gigabytes");
  add_force(tissue);
  add_figure_style(tissue);
  tissue.callback([&console, folder, options] { tissue_study(*folder, *options, console); });
}

}  // namespace

void add_reproduce(CLI::App& app, Console& console) {
  CLI::App& reproduce =
      add_command(app, console, "reproduce", "Reproduce a published study",
                  {"hmax reproduce oscillators", "hmax reproduce stability", "hmax reproduce tissue"});
  reproduce.require_subcommand(1);
  add_oscillator_study(reproduce, console);
  add_stability_study(reproduce, console);
  add_tissue_study(reproduce, console);
}

}  // namespace hmax
