/// `hmax reproduce docket`: public reports of runs that failed, judged from their numbers.
#include <algorithm>

#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "cli/reproduce/parts.hpp"
#include "cli/reproduce/report_page.hpp"
#include "plots/pages/markdown_page.hpp"
#include "plots/pages/report.hpp"
#include "results/exports.hpp"
#include "results/json.hpp"
#include "studies/docket/docket.hpp"

namespace hmax {

namespace {

std::vector<TomlDocument> docket_documents(const std::vector<std::string>& files) {
  std::vector<TomlDocument> all;
  for (const std::string& file : files) all.push_back(read_toml(file));
  if (files.empty())
    for (const EmbeddedText& text : docket_texts())
      all.push_back(parse_toml(text.text, fmt::format("{}.toml", text.name)));
  return all;
}

/// The different words of a report, "step, none".
std::string docket_words(const DocketReport& report, std::string DocketRow::*word) {
  std::string words;
  std::vector<std::string> seen;
  for (const DocketRow& row : report.rows) {
    if (std::ranges::find(seen, row.*word) != seen.end()) continue;
    seen.push_back(row.*word);
    words += (words.empty() ? "" : ", ") + row.*word;
  }
  return words;
}

Json docket_group(const char* title, const char* about, const std::vector<DocketReport>& reports,
                  bool control) {
  Json listed = Json::array();
  for (const DocketReport& report : reports)
    if (report.control == control) {
      Json one = report;
      one["thread"] = report.name + " thread";
      for (const char* key : {"name", "link", "program", "version", "control", "right", "decisive"})
        one.erase(key);
      for (Json& row : one["rows"]) row.erase("right");
      listed.push_back(std::move(one));
    }
  return {{"group", title}, {"about", about}, {"reports", listed}};
}

void fill_docket(ReportPage& page, const std::vector<DocketReport>& reports) {
  Json index = Json::array(), wrong = Json::array();
  std::ptrdiff_t runs = 0, right_runs = 0, firm = 0, silent = 0;
  for (const bool control : {false, true})
    for (const DocketReport& report : reports) {
      if (report.control != control) continue;
      page.link(report.name, "#" + heading_anchor(report.title), report.title);
      page.link(report.name + " thread", report.link, fmt::format("{}, {}", report.program, report.version));
      index.push_back({HMAX_KEYS(report, name, program),
                       {"causes", docket_words(report, &DocketRow::cause)},
                       {"verdicts", docket_words(report, &DocketRow::verdict)},
                       HMAX_KEYS(report, right, decisive)});
      firm += report.right && report.decisive.empty() ? 1 : 0;
      silent += report.right && std::ranges::count(report.rows, "none", &DocketRow::verdict) ==
                                    std::ssize(report.rows)
                    ? 1
                    : 0;
      if (!report.right) wrong.push_back({HMAX_KEYS(report, name, discussed)});
      runs += std::ssize(report.rows);
      right_runs += std::ranges::count(report.rows, true, &DocketRow::right);
    }
  const auto count = std::ssize(reports), right = std::ranges::count(reports, true, &DocketReport::right);
  page.values = {{"count", count},
                 {"controls", std::ranges::count(reports, true, &DocketReport::control)},
                 {"right", right},
                 {"share", 100.0 * static_cast<double>(right) / static_cast<double>(count)},
                 {"firm", firm},
                 {"firm_share", 100.0 * static_cast<double>(firm) / static_cast<double>(count)},
                 {"silent", silent},
                 {"runs", runs},
                 {"right_runs", right_runs},
                 {"index", index},
                 {"wrong", wrong},
                 {"groups",
                  {docket_group("Reports", "Something that steps decide was the cause.", reports, false),
                   docket_group("Controls", "Steps were not the cause.", reports, true)}}};
}

}  // namespace

ReproducedPart reproduce_docket(const StudyOptions& options, Console& console) {
  const std::filesystem::path folder = options.folder;
  check_report_place(folder);
  const double started = elapsed_seconds();
  std::vector<DocketReport> reports;
  {
    Progress progress(console, "docket");
    const std::vector<TomlDocument> all = docket_documents(options.files);
    const auto watch = progress.watcher();
    for (const TomlDocument& document : all) {
      watch(static_cast<double>(reports.size()) / static_cast<double>(all.size()), document.name);
      reports.push_back(docket_report(document));
    }
  }
  ReportPage page("docket", folder);
  fill_docket(page, reports);
  const Json document = reports;
  page.write_numbers("docket.json", "reports", document);
  ReproducedPart part{.report = page.write(), .rows = page.values["runs"].get<std::int64_t>()};
  part.seconds = elapsed_seconds() - started;
  const auto right = std::ranges::count(reports, true, &DocketReport::right);
  part.document = {
      {"report", part.report.string()}, {"seconds", part.seconds}, {"right", right}, {"reports", document}};
  part.words = fmt::format("{} of {} reports are judged as their threads end.", right, reports.size());
  return part;
}

}  // namespace hmax
