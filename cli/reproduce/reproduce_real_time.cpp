/// `hmax reproduce real-time`: methods of simulators at frame rates, and what they make of a material.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "cli/reproduce/parts.hpp"
#include "cli/reproduce/report_page.hpp"
#include "plots/pages/report.hpp"
#include "results/exports.hpp"
#include "results/fingerprint.hpp"
#include "results/json.hpp"
#include "studies/real_time.hpp"

namespace hmax {

namespace {

std::vector<RealTimeRow> rows_at(double rate, const std::vector<RealTimeRow>& rows) {
  std::vector<RealTimeRow> chosen;
  std::ranges::copy_if(rows, std::back_inserter(chosen),
                       [&](const RealTimeRow& row) { return row.rate == rate; });
  return chosen;
}

/// The families in their first order, each with a colour and a marker of its own.
Style style_of(const std::string& family, const std::vector<RealTimeRow>& rows) {
  constexpr std::array<int, 6> markers{7, 5, 9, 13, 6, 4};
  std::vector<std::string> seen;
  for (const RealTimeRow& row : rows)
    if (std::ranges::find(seen, row.family) == seen.end()) seen.push_back(row.family);
  const auto k = static_cast<int>(std::ranges::find(seen, family) - seen.begin());
  return {.colour = k, .marker = wrapped(markers, k), .width = 1};
}

/// Rows as numbered points over the time of a frame, one panel.
/// @param named  whether a row is far enough from the others to have its number
Panel panel_of(double rate, const std::vector<RealTimeRow>& rows, const std::string& label,
               double RealTimeRow::*value, Axis axis, bool (*named)(const RealTimeRow&)) {
  Panel panel{.title = fmt::format("{:g} Hz: {}", rate, label),
              .x = {.label = "99 % of frames within [ms]", .logarithmic = true},
              .y = std::move(axis)};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = 100 * rows[i].*value;
    if (!(rows[i].frame_p99 > 0) || !(y > 0) || !std::isfinite(y)) continue;
    panel.marks.push_back({.x = 1000 * rows[i].frame_p99,
                           .y = y,
                           .style = style_of(rows[i].family, rows),
                           .label = rows[i].family,
                           .name = named(rows[i]) ? std::to_string(i + 1) : ""});
  }
  return panel;
}

/// A vertical line at the length of a frame.
void add_deadline(Panel& panel, double rate) {
  double low = INFINITY, high = 0;
  for (const Mark& mark : panel.marks) {
    low = std::min(low, mark.y);
    high = std::max(high, mark.y);
  }
  panel.curves.push_back({.label = "a frame",
                          .x = {1000 / rate, 1000 / rate},
                          .y = {low, high},
                          .style = {.colour = 7, .dash = 1, .width = 1.2}});
}

Figure figure_of(const RealTimeQuestion& question, const std::vector<RealTimeRow>& rows,
                 const std::string& machine) {
  Figure figure{.title = "What a frame's time buys: error, and how much of the stiffness is left",
                .columns = 2,
                .footer = "numbers are those of the tables; one thread, " + machine};
  for (const double rate : question.rates) {
    const std::vector<RealTimeRow> own = rows_at(rate, rows);
    for (Panel panel :
         {panel_of(rate, own, "error while it is pressed", &RealTimeRow::error_pressed,
                   {.label = "error [%]", .logarithmic = true}, [](const RealTimeRow&) { return true; }),
          panel_of(rate, own, "stiffness shown", &RealTimeRow::stiffness_shown,
                   {.label = "stiffness shown [%]", .range = {{0, 125}}},
                   [](const RealTimeRow& row) { return std::abs(row.stiffness_shown - 1) > 0.01; })}) {
      add_deadline(panel, rate);
      figure.panels.push_back(std::move(panel));
    }
  }
  return figure;
}

/// Some of the fields of a row: those that the text has places for.
Json chosen(const RealTimeRow& row, std::initializer_list<const char*> fields) {
  const Json all = row;
  Json some;
  for (const char* field : fields) some[field] = all.at(field);
  return some;
}

Json shown_row(const RealTimeRow& row) {
  return chosen(row, {"method", "steps", "stiffness_shown", "damping_added", "stiffness_ceiling",
                      "error_pressed", "error_grasped", "frame_p99", "missed", "frames"});
}

/// The row with the least error of those that are on time; null where there is none.
Json best_of(const std::vector<RealTimeRow>& rows) {
  const RealTimeRow* best = nullptr;
  for (const RealTimeRow& row : rows)
    if (row.frames > 0 && row.missed == 0 && std::isfinite(row.error_pressed) &&
        (!best || row.error_pressed < best->error_pressed))
      best = &row;
  return best ? chosen(*best, {"method", "error_pressed", "stiffness_shown", "frame_p99"}) : Json();
}

void fill(ReportPage& page, const RealTimeQuestion& question, const std::vector<RealTimeRow>& rows) {
  page.values["rates"] = page.values["remarks"] = Json::array();
  for (const double rate : question.rates) {
    Json listed = Json::array();
    const std::vector<RealTimeRow> own = rows_at(rate, rows);
    for (std::size_t i = 0; i < own.size(); ++i) {
      Json row = shown_row(own[i]);
      row["number"] = i + 1;
      if (!own[i].status.empty())
        page.values["remarks"].push_back({{"number", i + 1}, {"rate", rate}, {"status", own[i].status}});
      listed.push_back(std::move(row));
    }
    const Json best = best_of(own);
    page.values["rates"].push_back({{"rate", rate},
                                    {"frame", 1 / rate},
                                    {"rows", listed},
                                    {"best", best},
                                    {"all_late", best.is_null()}});
  }
}

}  // namespace

ReproducedPart reproduce_real_time(const StudyOptions& options, Console& console) {
  const std::filesystem::path folder = options.folder;
  check_report_place(folder);
  const double started = elapsed_seconds();
  const bool quick = options.tissue.quick;
  RealTimeQuestion question;
  if (quick) {
    question.body = "phantom";
    question.rates = {60};
    question.frames = 30;
    question.ceilings_up_to = 0;
  }
  const std::vector<RealTimeRow> rows =
      real_time_study(question, real_time_candidates(), Progress(console, "real time").watcher());
  const std::string machine = summary(fingerprint());
  ReportPage page("real_time", folder);
  page.values = {{"machine", machine}, {"quick", quick}, HMAX_KEYS(question, body, material)};
  fill(page, question, rows);
  page.draw(figure_of(question, rows, machine), "real_time");
  Json document = rows;
  tell_infinity(document);
  page.write_numbers("real_time.json", "rows", document);
  ReproducedPart part{.report = page.write(), .rows = std::ssize(rows)};
  part.seconds = elapsed_seconds() - started;
  part.document = {{"report", part.report.string()}, {"seconds", part.seconds}, {"rows", document}};
  const auto soft =
      std::ranges::count_if(rows, [](const RealTimeRow& row) { return row.stiffness_shown < 0.95; });
  part.words = fmt::format("{} settings at {} rates; {} of them show less than 95 % of the stiffness.",
                           real_time_candidates().size(), question.rates.size(), soft);
  return part;
}

}  // namespace hmax
