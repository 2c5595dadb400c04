#include "cli/reproduce/parts.hpp"

#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/timing/sweep.hpp"
#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "cli/reproduce/reproduce_oscillators.hpp"
#include "cli/reproduce/reproduce_stability.hpp"
#include "cli/reproduce/tissue_page.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/stability.hpp"
#include "core/errors.hpp"
#include "limits/documents/number_json.hpp"
#include "plots/pages/report.hpp"
#include "plots/pages/store_report.hpp"
#include "results/build_info.hpp"
#include "results/fingerprint.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

constexpr const char *self_exciting_store = "damping_minus_2.sqlite", *sweep_store = "step_sweep.sqlite",
                     *limit_store = "limits.sqlite";

/// Writes the page of all rows of stores in a folder.
void write_rows(const std::filesystem::path& folder, const std::vector<std::string>& stores,
                Console& console) {
  std::vector<ReportedStore> contents;
  for (const std::string& name : stores)
    contents.push_back(reported_store(Store::open_existing(folder / name), name));
  const StoreReport page = store_report(contents, build_info().version);
  const std::filesystem::path file = folder / "rows.html";
  write_file(file, page.html);
  if (page.left_out > 0)
    console.remark(fmt::format(
        "{} rows are left out of {}, since it would be larger than 5 MB; the stores have every row",
        page.left_out, file.string()));
}

/// What a shard has stored in a folder.
ReproducedPart stored_shard(const std::filesystem::path& folder, const std::vector<const char*>& stores,
                            std::size_t rows, double started) {
  std::vector<std::string> files;
  for (const char* store : stores) files.push_back((folder / store).string());
  const double seconds = elapsed_seconds() - started;
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
  spec.problems = {{"liver_forced", {.parameters = {{"c", -2}}}}};
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
  {
    Progress progress(console, task);
    count += run_shown_sweep(plan, store, file.string(), progress, console).measured;
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

}  // namespace

void tell_infinity(Json& value) {
  if (value.is_structured())
    for (auto& inner : value) tell_infinity(inner);
  else if (value.is_number_float())
    value = number_or_word(value.get<double>());
}

ReproducedPart reproduce_limits(const StudyOptions& options, Console& console) {
  const std::filesystem::path folder = options.folder;
  const std::optional<Shard> shard = shard_from(options.shard);
  check_report_place(folder);
  const double started = elapsed_seconds();
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
  if (interrupted) {
    const auto finished = static_cast<std::int64_t>(rows.size() + nonlinear.size());
    throw Interrupted::with_store((folder / limit_store).string(), finished);
  }
  if (shard) return stored_shard(folder, {limit_store}, rows.size() + nonlinear.size(), started);
  write_rows(folder, {limit_store}, console);
  const std::filesystem::path report =
      reproduce_stability(cases, rows, nonlinear, summary(fingerprint()), folder);
  const LimitSummary found = summary_of(cases, rows);
  const double seconds = elapsed_seconds() - started;
  Json document{{"report", report.string()}, {"seconds", seconds}};
  document.update(Json(found));
  return {.report = report,
          .rows = static_cast<std::int64_t>(found.rows),
          .seconds = seconds,
          .failed = found.disagreeing > 0,
          .document = document,
          .words = fmt::format(
              "{} pairs of method and model; {} limits within {:.4f} % of what integration shows, {} "
              "without limit, {} disagree.",
              found.rows, found.with_number, 100 * found.worst_gap, found.unbounded, found.disagreeing)};
}

ReproducedPart reproduce_tissue_part(const StudyOptions& options, Console& console) {
  options.device.check({});
  TissueOptions tissue = options.tissue;
  if (options.device.is_gpu() && !tissue.scale)
    throw InputError("--device gpu is for the costs of --scale; add it, or leave --device out");
  tissue.device = options.device.open();
  check_report_place(options.folder);
  const double started = elapsed_seconds();
  tissue.machine = summary(fingerprint());
  Json document = reproduce_tissue(options.folder, tissue, Progress(console, "tissue").watcher());
  const auto number = [&](const char* key) { return document[key].get<double>(); };
  ReproducedPart part{
      .report = document["report"].get<std::string>(),
      .rows = static_cast<std::int64_t>(document["particles"].size() + document["paths"].size() +
                                        document["sizes"].size()),
      .seconds = elapsed_seconds() - started,
      .failed = document["unsolved"] > 0,
      .words = fmt::format(
          "Finite elements cost {:.2g} times the forces and {:.2g} times the step of springs; under "
          "the same load the liver moves by {:.3g} mm with springs and {:.3g} mm with finite elements.",
          number("force_ratio"), number("step_ratio"), 1000 * number("deflection_springs"),
          1000 * number("deflection_elements"))};
  tell_infinity(document);
  part.document = std::move(document);
  return part;
}

ReproducedPart reproduce_oscillator_part(const StudyOptions& options, Console& console) {
  const std::filesystem::path folder = options.folder;
  const std::optional<Shard> shard = shard_from(options.shard);
  check_report_place(folder);
  const double started = elapsed_seconds();
  StudyRows rows;
  std::int64_t count = 0;
  rows.self_exciting = measured(self_exciting_sweep(), folder / self_exciting_store,
                                "timing the model with c = -2", console, rows.machine, count, shard);
  rows.published_model = measured(SweepSpec{}, folder / sweep_store, "timing the step sweep", console,
                                  rows.machine, count, shard);
  if (shard)
    return stored_shard(folder, {self_exciting_store, sweep_store},
                        rows.self_exciting.size() + rows.published_model.size(), started);
  write_rows(folder, {sweep_store, self_exciting_store}, console);
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
          .seconds = elapsed_seconds() - started,
          .document = {{"report", report.string()}, {"measured", count}},
          .words = fmt::format("{} rows measured, the others were there already.", count)};
}

}  // namespace hmax
