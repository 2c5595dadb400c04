/// hmax check: accuracy and work of every method against the committed baseline.
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/timing/accuracy_suite.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/tableau_file.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/shared/shown_text.hpp"
#include "core/errors.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

struct CheckOptions {
  std::string baseline, methods, tableau;
  bool update = false;

  /// Whether methods are named, and not the whole suite is run.
  [[nodiscard]] bool chooses() const { return !methods.empty() || !tableau.empty(); }
  /// " --baseline mine.csv" and so on, as they were given.
  [[nodiscard]] std::string given() const {
    std::string text;
    for (const auto& [name, value] :
         {std::pair{"--methods", &methods}, {"--tableau", &tableau}, {"--baseline", &baseline}})
      if (!value->empty()) text += fmt::format(" {} {}", name, shell_word(*value));
    return text;
  }
};

/// The baseline of the folder hmax is started in, or else of the folder it was built from.
std::filesystem::path baseline_file(const std::string& asked) {
  if (!asked.empty()) return asked;
  std::filesystem::path here = "results/baseline/accuracy.csv";
  if (std::filesystem::exists(here)) return here;
  return std::filesystem::path(HMAX_SOURCE_DIR) / here;
}

Json to_json(const AccuracyComparison& comparison, const std::filesystem::path& file, bool updated) {
  Json changed = Json::array();
  for (const AccuracyChange& change : comparison.changed)
    changed.push_back({HMAX_KEYS(change, row, what, before, now)});
  return {{"compared", comparison.compared},
          {"changed", changed},
          HMAX_KEYS(comparison, missing, added),
          {"baseline", file.string()},
          {"updated", updated}};
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

/// @throws InputError  where --update would lose rows of the baseline of hmax, or mix it with methods of
/// users
void check_choices(const CheckOptions& options) {
  if (!options.update) return;
  if (!options.methods.empty()) throw InputError("--update rewrites the whole baseline; remove --methods");
  if (!options.tableau.empty() && options.baseline.empty())
    throw InputError(
        "--update with --tableau writes a baseline of your own; name its file, like --baseline mine.csv");
}

/// The cases of the chosen methods; what is left out is warned of.
AccuracyPlan plan_of(const CheckOptions& options, Console& console) {
  std::vector<std::string> names{"all"};
  if (options.chooses())
    names = options.methods.empty() ? std::vector<std::string>{} : parse_names("--methods", options.methods);
  std::vector<Method> own;
  if (!options.tableau.empty()) own.push_back(make_method(read_tableau(options.tableau)));
  AccuracyPlan plan = accuracy_plan(names, own);
  if (plan.cases.empty())
    throw InputError(fmt::format("nothing to check: {}; name methods of hmax's own",
                                 fmt::join(in_words(plan.left_out), "; ")));
  if (options.chooses()) warn_of_left_out(console, plan.left_out);
  return plan;
}

void check_accuracy(const CheckOptions& options, Console& console) {
  check_choices(options);
  const std::filesystem::path file = baseline_file(options.baseline);
  std::vector<AccuracyRow> baseline, others;
  std::error_code ignored;
  if (!options.update || std::filesystem::exists(file, ignored)) baseline = read_baseline(file);

  const AccuracyPlan plan = plan_of(options, console);
  if (options.chooses()) {
    std::set<std::string> chosen;
    for (const AccuracyCase& one : plan.cases) chosen.insert(one.method.id);
    const auto is_other = [&](const AccuracyRow& row) { return !chosen.contains(row.method); };
    std::ranges::copy_if(baseline, std::back_inserter(others), is_other);
    std::erase_if(baseline, is_other);
    if (baseline.empty() && !options.update)
      throw InputError(fmt::format(
          "'{}' has no rows of {}; write a baseline of its own with hmax check --tableau FILE.toml --baseline mine.csv --update",
          file.string(), fmt::join(chosen, ", ")));
  }
  const std::vector<AccuracyRow> rows = run_accuracy_suite(plan, Progress(console, "check").watcher());
  const AccuracyComparison comparison = compare(baseline, rows);
  if (options.update) {
    others.insert(others.end(), rows.begin(), rows.end());
    write_baseline(file, others);
  }
  if (console.json) {
    console.print_json(to_json(comparison, file, options.update));
  } else {
    std::string verdict = comparison.equal()
                              ? fmt::format("{} rows agree with {}", comparison.compared, file.string())
                              : fmt::format("{} rows compared, {} numbers changed, {} rows missing, {} added",
                                            comparison.compared, comparison.changed.size(),
                                            comparison.missing.size(), comparison.added.size());
    if (options.update) verdict += fmt::format("\n{} rows written to {}", others.size(), file.string());
    const bool good = comparison.equal() || options.update;
    console.print(for_people(comparison, console) +
                  (good ? console.strong(verdict) : console.alarming(verdict)) + "\n");
    if (!good)
      console.print(fmt::format(
          "If the change is meant: hmax check --update{}, and commit the baseline with the reason.\n",
          options.given()));
  }
  if (!comparison.equal() && !options.update) console.exit_code = Exit::failed;
}

}  // namespace

void add_check(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "check",
      "Run the accuracy suite and compare it with the baseline; exit 1 when a row changed",
      {"hmax check", "hmax check --methods rk4,ode45 --json", "hmax check --update --baseline mine.csv"},
      check_accuracy);
  add_flag(command, "--update", options.update, "Rewrite the baseline and show the changes");
  add_text(command, "--methods", options.methods, "Only these ids, aliases or families", "A,B");
  add_text(command, "--tableau", options.tableau,
           "Only the method of this file with an explicit tableau of your own, beside --methods", "FILE");
  add_text(command, "--baseline", options.baseline,
           "File of the baseline; results/baseline/accuracy.csv of the source folder by default", "FILE");
  add_force(command);
  add_jobs(command);
}

}  // namespace hmax
