#include "cli/reproduce/parts.hpp"

#include <array>
#include <chrono>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/timing/sweep.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "cli/reproduce/reproduce_oscillators.hpp"
#include "cli/reproduce/reproduce_stability.hpp"
#include "cli/reproduce/reproduce_tissue.hpp"
#include "cli/reproduce/rows_page.hpp"
#include "cli/stability/stability.hpp"
#include "plots/pages/report.hpp"
#include "results/fingerprint.hpp"

namespace hmax {

namespace {

constexpr const char *self_exciting_store = "damping_minus_2.sqlite", *sweep_store = "step_sweep.sqlite",
                     *limit_store = "limits.sqlite";

double seconds_since(std::chrono::steady_clock::time_point started) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

/// Writes the page of all rows. @returns a link to it, as Markdown
std::string link_to_rows(const std::filesystem::path& folder, const std::vector<std::string>& stores,
                         Console& console) {
  const RowsPage page = write_rows_page(folder, stores);
  if (page.left_out > 0)
    console.remark(fmt::format(
        "{} rows are left out of {}, since it would be larger than 5 MB; the stores have every row",
        page.left_out, page.file.string()));
  return page.link;
}

/// What a shard has stored in a folder.
ReproducedPart stored_shard(const std::filesystem::path& folder, const std::vector<const char*>& stores,
                            std::size_t rows, std::chrono::steady_clock::time_point started) {
  std::vector<std::string> files;
  for (const char* store : stores) files.push_back((folder / store).string());
  const double seconds = seconds_since(started);
  return {.rows = static_cast<std::int64_t>(rows),
          .seconds = seconds,
          .document = {{"stores", files}, {"rows", rows}, {"seconds", seconds}},
          .words = fmt::format("{} rows of this shard are in {}; merge them with those of the other shards",
                               rows, fmt::join(files, ", "))};
}

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
                          Console& console, std::string& machine, std::int64_t& count,
                          std::optional<Shard> shard) {
  const SweepPlan plan = shard_of(plan_sweep(spec), shard.value_or(Shard{}));
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
    if (done.interrupted) throw Interrupted::with_store(file.string());
    for (const std::string& warning : done.warnings) console.remark(warning);
    count += done.measured;
  }
  // A shard may have no row.
  if (const std::vector<Session> sessions = store.sessions(); !sessions.empty())
    machine = summary(sessions.back().fingerprint);
  return store.rows();
}

/// Methods of the nonlinear table: one of each kind that has a limit.
constexpr std::array nonlinear_methods{"explicit_euler",    "rk2_heun",         "rk4",
                                       "dormand_prince_54", "dop_853",          "adams_bashforth_3",
                                       "abm_pece_3",        "symplectic_euler", "stormer_verlet",
                                       "central_difference"};

nlohmann::ordered_json to_json(const ThighStudy& study) {
  const auto array = [](const auto& items, const auto& row) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const auto& item : items) rows.push_back(row(item));
    return rows;
  };
  using Json = nlohmann::ordered_json;
  return {
      {"points", study.truth.points()},
      {"forces", value_count(study.data)},
      {"fits", array(study.cases,
                     [](const ThighCase& each) -> Json {
                       return {{"skin", each.skin},
                               {"unknowns", each.fit.values.size()},
                               {"converged", each.fit.converged},
                               {"overall_error", each.overall},
                               {"within_5_percent", each.recovery.within},
                               {"largest_error", each.recovery.largest_error},
                               {"covered", each.recovery.covered}};
                     })},
      {"covered", study.covered},
      {"starts", array(study.starts,
                       [](const ThighStarts& each) -> Json {
                         return {{"misfit", each.misfit == Misfit::logarithmic ? "logarithmic" : "relative"},
                                 {"factor_a", each.of_a},
                                 {"factor_b", each.of_b},
                                 {"starts", each.starts},
                                 {"found", each.found}};
                       })},
      {"tasks", array(study.tasks,
                      [](const ThighTask& each) -> Json {
                        return {{"forces", each.name}, {"springs", each.springs}, {"network", each.network}};
                      })},
      {"limits", array(study.limits,
                       [](const ThighLimit& each) -> Json {
                         return {{"method", each.method},
                                 {"h_rest", number_or_word(each.at_rest)},
                                 {"h_pressed", number_or_word(each.pressed)}};
                       })},
      {"stable_mass", number_or_word(study.stable_mass)},
      {"constant_jacobian_depth", number_or_word(study.constant_depths.minCoeff())}};
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
          {"thigh", to_json(study.thigh)},
          {"sizes", sizes}};
}

}  // namespace

ReproducedPart reproduce_limits(const std::filesystem::path& folder, Console& console,
                                std::optional<Shard> shard) {
  check_report_place(folder);
  const auto started = std::chrono::steady_clock::now();
  const auto& interrupted = interrupt_flag();
  const auto stop = [&] { return interrupted.load(); };
  const std::vector<LimitCase> cases = limit_cases();
  check_limit_files(folder);
  Store store = Store::open_or_create(folder / limit_store);
  const auto study = [&](const char* task, CaseKind kind, const std::vector<Method>& chosen) {
    Progress progress(console, task);
    return limit_study(
        cases, kind, chosen, &store, [&](double share) { progress.update(share); }, stop,
        shard.value_or(Shard{}));
  };
  const std::vector<StudyRow> rows = study("predicting and verifying", CaseKind::linear, methods());
  std::vector<Method> chosen;
  for (const char* id : nonlinear_methods) chosen.push_back(find_method(id));
  const std::vector<StudyRow> nonlinear = study("nonlinear models", CaseKind::nonlinear, chosen);
  if (interrupted) throw Interrupted::with_store((folder / limit_store).string());
  if (shard) return stored_shard(folder, {limit_store}, rows.size() + nonlinear.size(), started);
  const std::filesystem::path report = reproduce_stability(
      cases, rows, nonlinear, summary(fingerprint()), folder, link_to_rows(folder, {limit_store}, console));
  const LimitSummary found = summary_of(cases, rows);
  const double seconds = seconds_since(started);
  return {.report = report,
          .rows = static_cast<std::int64_t>(found.rows),
          .seconds = seconds,
          .failed = found.disagreeing > 0,
          .document = {{"report", report.string()},
                       {"rows", found.rows},
                       {"with_number", found.with_number},
                       {"unbounded", found.unbounded},
                       {"disagreeing", found.disagreeing},
                       {"worst_gap", found.worst_gap},
                       {"worst", found.worst},
                       {"seconds", seconds}},
          .words = fmt::format(
              "{} pairs of method and model; {} limits within {:.4f} % of what integration shows, {} "
              "without limit, {} disagree.",
              found.rows, found.with_number, 100 * found.worst_gap, found.unbounded, found.disagreeing)};
}

ReproducedPart reproduce_tissue_part(const std::filesystem::path& folder, TissueOptions options,
                                     Console& console) {
  check_report_place(folder);
  const auto started = std::chrono::steady_clock::now();
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
  return {.report = study.report,
          .rows = static_cast<std::int64_t>(study.particles.size() + study.paths.size() + study.sizes.size()),
          .seconds = seconds_since(started),
          .failed = study.unsolved > 0,
          .document = to_json(study),
          .words = fmt::format(
              "Finite elements cost {:.2g} times the forces and {:.2g} times the step of springs; under "
              "the same load the liver moves by {:.3g} mm with springs and {:.3g} mm with finite "
              "elements.",
              study.force_ratio, study.step_ratio, 1000 * study.deflection_springs,
              1000 * study.deflection_elements)};
}

ReproducedPart reproduce_oscillator_part(const std::filesystem::path& folder, Console& console,
                                         std::optional<Shard> shard) {
  check_report_place(folder);
  const auto started = std::chrono::steady_clock::now();
  StudyRows rows;
  std::int64_t count = 0;
  rows.self_exciting = measured(self_exciting_sweep(), folder / self_exciting_store,
                                "timing the model with c = -2", console, rows.machine, count, shard);
  rows.published_model = measured(SweepSpec{}, folder / sweep_store, "timing the step sweep", console,
                                  rows.machine, count, shard);
  if (shard)
    return stored_shard(folder, {self_exciting_store, sweep_store},
                        rows.self_exciting.size() + rows.published_model.size(), started);
  rows.rows_link = link_to_rows(folder, {sweep_store, self_exciting_store}, console);
  std::filesystem::path report;
  {
    Progress progress(console, "drawing");
    double drawn = 0;
    report = reproduce_oscillators(rows, folder, [&](const std::string& section) {
      progress.update(drawn / 12, section);
      ++drawn;
    });
  }
  return {.report = report,
          .rows = static_cast<std::int64_t>(rows.published_model.size() + rows.self_exciting.size()),
          .seconds = seconds_since(started),
          .document = {{"report", report.string()}, {"measured", count}},
          .words = fmt::format("{} rows measured, the others were there already.", count)};
}

}  // namespace hmax
