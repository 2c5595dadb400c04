/// `hmax reproduce`: published studies done again, figure by figure.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/reproduce/parts.hpp"
#include "cli/reproduce/report_page.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/mpirun.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "plots/figure.hpp"
#include "plots/pages/report.hpp"
#include "results/fingerprint.hpp"
#include "results/json.hpp"
#include "results/store.hpp"

namespace hmax {

namespace {

void show(const ReproducedPart& part, Console& console) {
  if (part.failed) console.exit_code = Exit::failed;
  console.show(
      part.document,
      part.words + "\n" + (part.report.empty() ? "" : fmt::format("Open {}\n", part.report.string())));
}

/// A part of `reproduce all`, in a folder of its own.
struct ReportPart {
  std::string name, title;
  ReproducedPart (*make)(const StudyOptions&, Console&);
};

const std::vector<ReportPart>& parts() {
  static const std::vector<ReportPart> all{
      {"oscillators", "The liver oscillator study", reproduce_oscillator_part},
      {"stability", "Step limits of every method on every model of that study", reproduce_limits},
      {"tissue", "Springs and finite elements, after the thesis on deformable organs", reproduce_tissue_part},
      {"real-time", "A liver in real time: what each setting makes of its material", reproduce_real_time},
      {"docket", "Public reports of runs that failed, judged from their numbers", reproduce_docket}};
  return all;
}

/// The parts of these names, all where there are none.
std::vector<ReportPart> chosen_parts(const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (std::ranges::find(parts(), name, &ReportPart::name) == parts().end())
      throw InputError(fmt::format(
          "there is no part '{}'; take some of oscillators, stability, tissue, real-time, docket", name));
  std::vector<ReportPart> chosen;
  for (const ReportPart& part : parts())
    if (names.empty() || std::ranges::find(names, part.name) != names.end()) chosen.push_back(part);
  return chosen;
}

/// What an earlier call of the same program with the same options has finished, kept as remarks of a store.
class FinishedParts {
 public:
  FinishedParts(const std::filesystem::path& folder, bool quick)
      : folder_(folder),
        store_(Store::open_or_create(folder / "parts.sqlite")),
        made_by_(fmt::format("{}{}{}", fingerprint().program, quick ? " quick" : "",
                             figure_style() == FigureStyle::slide ? " slide" : "")) {}

  std::optional<ReproducedPart> find(const std::string& name) const {
    const auto notes = store_.notes();
    const auto note = notes.find(key(name));
    if (note == notes.end()) return std::nullopt;
    const Json kept = Json::parse(note->second, nullptr, false);
    if (kept.is_discarded() || kept.value("made_by", "") != made_by_) return std::nullopt;
    ReproducedPart part{.report = folder_ / kept.value("report", ""),
                        .rows = kept.value("rows", std::int64_t{0}),
                        .seconds = kept.value("seconds", 0.0),
                        .failed = kept.value("failed", false),
                        .words = kept.value("words", "")};
    if (!std::filesystem::exists(part.report)) return std::nullopt;
    return part;
  }

  void keep(const std::string& name, const ReproducedPart& part) {
    store_.note(key(name), Json{{"made_by", made_by_},
                                {"report", part.report.lexically_proximate(folder_).generic_string()},
                                HMAX_KEYS(part, rows, seconds, failed, words)}
                               .dump());
  }

 private:
  static std::string key(const std::string& name) { return "part " + name; }
  std::filesystem::path folder_;
  Store store_;
  std::string made_by_;  ///< program and options
};

struct AllOptions {
  std::string folder = "results/runs/reproduced";
  std::vector<std::string> names;
  bool quick = false;
};

/// Links of the text lead to the texts of the parts; those of the page to the parts that the folder has. Of
/// others the words are left, and how to make the part.
void lead_to_parts(std::string& text, const std::filesystem::path& folder) {
  for (const ReportPart& part : parts()) {
    const std::regex link(fmt::format(R"(\[([^\]]*)\]\({}\.md#([^)]*)\))", part.name));
    const bool made = std::filesystem::exists(folder / part.name / "README.md");
    text = std::regex_replace(text, link,
                              made ? fmt::format("[$1]({}/README.md#$2)", part.name)
                                   : fmt::format("not made here; `--part {}` makes it: $1", part.name));
  }
}

void reproduce_all(const AllOptions& options, Console& console) {
  refuse_copies("hmax reproduce");
  const std::filesystem::path folder = options.folder;
  const std::vector<ReportPart> chosen = chosen_parts(options.names);
  check_report_place(folder);
  FinishedParts finished(folder, options.quick);
  ReportPage page("all", folder);
  Json shown = Json::array(), listed = Json::array();
  for (const ReportPart& part : chosen) {
    auto done = finished.find(part.name);
    if (!done) {
      done =
          part.make({.folder = (folder / part.name).string(), .tissue = {.quick = options.quick}}, console);
      finished.keep(part.name, *done);
    }
    if (done->failed) console.exit_code = Exit::failed;
    page.link(part.name, part.name + "/README.md", "The page");
    shown.push_back({{"title", part.title},
                     {"words", done->words},
                     {"part", part.name},
                     HMAX_KEYS(*done, rows, seconds)});
    listed.push_back(
        {{"part", part.name}, {"report", done->report.string()}, HMAX_KEYS(*done, rows, seconds)});
  }
  page.values = {{"machine", summary(fingerprint())}, {"quick", options.quick}, {"parts", shown}};
  std::string text = page.text();
  lead_to_parts(text, folder);
  const std::filesystem::path written = write_report(text, folder);
  console.show({{"report", written.string()}, {"parts", listed}}, fmt::format("Open {}\n", written.string()));
}

void add_all(CLI::App& reproduce, Console& console) {
  const auto [all, options] = add_command(
      reproduce, console, "all", "Reproduce both sources, with one page that links their parts",
      {"hmax reproduce all --quick", "hmax reproduce all --part oscillators,tissue"}, reproduce_all);
  show_default(add_text(all, "--output", options.folder, "Folder of the page and of the parts"));
  add_list(all, "--part", options.names,
           "Parts: oscillators, stability, tissue, real-time, docket; all by default", "A,B");
  add_flag(all, "--quick", options.quick,
           "The quick form of tissue and real-time: coarser meshes, fewer points");
  add_footer(all, "A part that the same program has finished in FOLDER is not made again.");
  add_force(all);
  add_figure_style(all);
  add_jobs(all);
}

/// One part alone.
std::pair<CLI::App&, StudyOptions&> add_study(CLI::App& reproduce, Console& console, const std::string& name,
                                              const std::string& description,
                                              const std::string& about_folder = "Folder of the report") {
  const auto make = std::ranges::find(parts(), name, &ReportPart::name)->make;
  const std::string folder = "results/runs/" + name;
  CLI::App& study = add_command(reproduce, console, name, description,
                                {fmt::format("hmax reproduce {} --output {}", name, folder)});
  const auto options = std::make_shared<StudyOptions>(StudyOptions{.folder = folder});
  show_default(add_text(study, "--output", options->folder, about_folder));
  add_force(study);
  if (make != reproduce_docket) add_figure_style(study);
  add_jobs(study);
  set_callback(study, [&console, options, make] {
    // Shards are made beside one another.
    if (options->shard.empty()) refuse_copies("hmax reproduce");
    show(make(*options, console), console);
  });
  return {study, *options};
}

void add_oscillator_studies(CLI::App& reproduce, Console& console) {
  const auto [oscillators, rows] = add_study(reproduce, console, "oscillators",
                                             "Reproduce every figure and table of the liver oscillator study",
                                             "Folder of the report and of its stores");
  add_shard(oscillators, rows.shard);
  add_footer(oscillators, "What was measured before is kept in FOLDER/*.sqlite and not measured again.");
  const auto [stability, limits] =
      add_study(reproduce, console, "stability",
                "Predict and observe the step limits of every method on every model of the study");
  add_shard(stability, limits.shard);
}

void add_tissue_study(CLI::App& reproduce, Console& console) {
  const auto [tissue, options] = add_study(
      reproduce, console, "tissue", "Compare springs with finite elements on the phantom and the liver");
  add_flag(tissue, "--quick", options.tissue.quick,
           "Step limits on the phantom instead of the liver and at a few points; takes seconds");
  add_flag(tissue, "--scale", options.tissue.scale,
           "Also costs of meshes of a thousand to a million tetrahedra; takes minutes and gigabytes");
  options.device.add_to(tissue, "explicit steps of --scale also");
}

void add_real_time_study(CLI::App& reproduce, Console& console) {
  const auto [study, options] =
      add_study(reproduce, console, "real-time",
                "Show what methods of simulators make of a liver at 60, 100 and 1000 Hz");
  add_flag(study, "--quick", options.tissue.quick, "The phantom at one rate; takes seconds");
}

void add_docket_study(CLI::App& reproduce, Console& console) {
  const auto [study, options] =
      add_study(reproduce, console, "docket", "Judge public reports of runs that failed from their numbers");
  add_list(study, "--files", options.files, "Reports of your own in place of those of hmax, TOML", "A,B");
}

}  // namespace

void add_reproduce(CLI::App& app, Console& console) {
  CLI::App& reproduce =
      add_command(app, console, "reproduce", "Reproduce a published study",
                  {"hmax reproduce all --quick", "hmax reproduce oscillators", "hmax reproduce stability",
                   "hmax reproduce tissue", "hmax reproduce real-time", "hmax reproduce docket"});
  require_subcommand(reproduce);
  add_all(reproduce, console);
  add_oscillator_studies(reproduce, console);
  add_tissue_study(reproduce, console);
  add_real_time_study(reproduce, console);
  add_docket_study(reproduce, console);
  add_slice(reproduce, console);
}

}  // namespace hmax
