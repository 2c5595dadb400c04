/// hmax check: accuracy and work of every method against the committed baseline.
#include <filesystem>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "bench/timing/accuracy_suite.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "results/errors.hpp"

namespace hmax {

namespace {

using Json = nlohmann::ordered_json;

struct CheckOptions {
  std::string baseline, methods;
  bool update = false;
};

/// The baseline of the folder hmax is started in, or else of the folder it was built from.
std::filesystem::path baseline_file(const std::string& asked) {
  if (!asked.empty()) return asked;
  const std::filesystem::path here = "results/baseline/accuracy.csv";
  if (std::filesystem::exists(here)) return here;
  return std::filesystem::path(HMAX_SOURCE_DIR) / here;
}

Json to_json(const AccuracyComparison& comparison, const std::filesystem::path& file, bool updated) {
  Json changed = Json::array();
  for (const AccuracyChange& change : comparison.changed)
    changed.push_back(
        {{"row", change.row}, {"what", change.what}, {"before", change.before}, {"now", change.now}});
  return {{"compared", comparison.compared}, {"changed", changed},        {"missing", comparison.missing},
          {"added", comparison.added},       {"baseline", file.string()}, {"updated", updated}};
}

std::string for_people(const AccuracyComparison& comparison, const Console& console) {
  std::string text;
  TextTable table({"row", "what", "before", "now"});
  constexpr std::size_t most_lines = 40;
  for (std::size_t i = 0; i < std::min(most_lines, comparison.changed.size()); ++i) {
    const AccuracyChange& change = comparison.changed[i];
    table.add({change.row, change.what, change.before, change.now});
  }
  if (!comparison.changed.empty()) text += table.text(console);
  if (comparison.changed.size() > most_lines)
    text += fmt::format("... and {} more; --json shows them all\n", comparison.changed.size() - most_lines);
  const auto list = [&](const char* what, const std::vector<std::string>& rows) {
    if (rows.empty()) return;
    text += fmt::format("{} {}:", rows.size(), what);
    for (std::size_t i = 0; i < std::min<std::size_t>(8, rows.size()); ++i) text += "\n  " + rows[i];
    text += rows.size() > 8 ? "\n  ...\n" : "\n";
  };
  list("rows of the baseline were not run", comparison.missing);
  list("rows are not in the baseline", comparison.added);
  return text;
}

void check_accuracy(const CheckOptions& options, Console& console) {
  const std::filesystem::path file = baseline_file(options.baseline);
  if (options.update && !options.methods.empty())
    throw InputError("--update rewrites the whole baseline; remove --methods");
  std::vector<AccuracyRow> baseline;
  if (!options.update || std::filesystem::exists(file)) baseline = read_baseline(file);

  const AccuracyPlan plan = accuracy_plan(
      options.methods.empty() ? std::vector<std::string>{"all"} : parse_names("--methods", options.methods));
  if (!options.methods.empty()) {
    std::set<std::string> chosen;
    for (const AccuracyCase& one : plan.cases) chosen.insert(one.method.id);
    std::erase_if(baseline, [&](const AccuracyRow& row) { return !chosen.contains(row.method); });
  }
  const auto& interrupted = interrupt_flag();
  std::vector<AccuracyRow> rows;
  {
    Progress progress(console, "check");
    rows = run_accuracy_suite(plan, [&](double share, const std::string& name) {
      if (interrupted) throw Interrupted{};
      progress.update(share, name);
    });
  }
  const AccuracyComparison comparison = compare(baseline, rows);
  if (options.update) write_baseline(file, rows);
  if (console.json) {
    console.print_json(to_json(comparison, file, options.update));
  } else {
    std::string verdict = comparison.equal()
                              ? fmt::format("{} rows agree with {}", comparison.compared, file.string())
                              : fmt::format("{} rows compared, {} numbers changed, {} rows missing, {} added",
                                            comparison.compared, comparison.changed.size(),
                                            comparison.missing.size(), comparison.added.size());
    if (options.update) verdict += fmt::format("\n{} rows written to {}", rows.size(), file.string());
    const bool good = comparison.equal() || options.update;
    console.print(for_people(comparison, console) +
                  (good ? console.strong(verdict) : console.alarming(verdict)) + "\n");
    if (!good)
      console.print(
          "If the change is meant: hmax check --update, and commit the baseline with the reason.\n");
  }
  if (!comparison.equal() && !options.update) console.exit_code = Exit::failed;
}

}  // namespace

void add_check(CLI::App& app, Console& console) {
  CLI::App& command = add_command(
      app, console, "check",
      "Run the accuracy suite and compare it with the baseline; exit 1 when a row changed",
      {"hmax check", "hmax check --methods rk4,ode45 --json", "hmax check --update --baseline mine.csv"});
  auto options = std::make_shared<CheckOptions>();
  add_flag(command, "--update", options->update, "Rewrite the baseline and show the changes");
  add_text(command, "--methods", options->methods, "Only these ids, aliases or families", "A,B");
  add_text(command, "--baseline", options->baseline,
           "File of the baseline; results/baseline/accuracy.csv of the source folder by default", "FILE");
  add_force(command);
  add_jobs(command);
  set_callback(command, [options, &console] { check_accuracy(*options, console); });
}

}  // namespace hmax
