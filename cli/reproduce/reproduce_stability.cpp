#include "cli/reproduce/reproduce_stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/families.hpp"
#include "limits/prediction.hpp"
#include "plots/draw.hpp"
#include "plots/pages/report.hpp"
#include "results/limits/limit_exports.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

bool has_gap(const LimitRow& row) { return row.is_observed() && std::isfinite(row.gap); }

/// For people: five digits.
std::string shown(double value) {
  if (std::isnan(value)) return "-";
  return std::isinf(value) ? "unbounded" : fmt::format("{:.5g}", value);
}

constexpr const char *linear_file = "limits.csv", *nonlinear_file = "nonlinear.csv";

/// The rows of a study as a store exports them.
void write_rows(const fs::path& file, const std::vector<StudyRow>& rows) {
  std::vector<LimitRow> limits;
  for (const StudyRow& row : rows) limits.push_back(row.limit);
  write_file(file, limits_to_csv(limits), limits_to_csv({}));
}

/// The families of methods that the figure tells apart, in the order of its colours, and their markers.
constexpr std::array<std::string_view, 6> groups{"explicit Runge-Kutta", "Adams", "positions and velocities",
                                                 "stabilised",           "peers", "others"};
constexpr std::array<int, 6> markers{6, 8, 4, 12, 10, 2};

std::string_view group_of(const std::string& id) {
  const Method method = find_method(id);
  if (method.is_foreign()) return "peers";
  const std::string_view words = family_of(method)->words;
  return std::ranges::find(groups, words) == groups.end() ? "others" : words;
}

/// Stabilised methods bear steps of a million seconds where the model is overdamped; they would leave no room
/// for the others.
constexpr double longest_shown = 100;

Figure predicted_vs_observed(const std::vector<StudyRow>& rows, const std::string& machine) {
  std::map<std::string_view, Curve> limits, gaps;
  double low = INFINITY, high = 0;
  for (const auto& [which, row] : rows) {
    if (!has_gap(row) || row.h_max > longest_shown) continue;
    const std::string_view group = group_of(row.method);
    limits[group].x.push_back(row.h_max);
    limits[group].y.push_back(row.observed);
    gaps[group].x.push_back(row.h_max);
    gaps[group].y.push_back(100 * std::max(std::abs(row.gap), 1e-7));
    low = std::min(low, row.h_max);
    high = std::max(high, row.h_max);
  }
  Figure figure{.title = "The largest stable step, predicted and observed"};
  figure.footer = machine;
  figure.panel_height = 330;
  Panel against{.title = "Every method on every linear model of the study"};
  against.x = {.label = "predicted h_max [s]", .logarithmic = true, .range = {{low / 1.5, high * 1.5}}};
  against.y = {.label = "observed h_max [s]", .logarithmic = true, .range = {{low / 1.5, high * 1.5}}};
  against.notes = {"limits up to 100 s; the stabilised methods' longer ones are in limits.csv"};
  against.curves.push_back({.label = "equal",
                            .x = {low / 1.5, high * 1.5},
                            .y = {low / 1.5, high * 1.5},
                            .style = {.colour = 7, .width = 1}});
  Panel difference{.title = "How far apart they are"};
  difference.x = against.x;
  difference.y = {.label = "|observed / predicted - 1| [%]", .logarithmic = true, .range = {{5e-6, 1}}};
  difference.curves.push_back({.label = "0.1 %, what is asked",
                               .x = {low / 1.5, high * 1.5},
                               .y = {0.1, 0.1},
                               .style = {.colour = 7, .dash = 1, .width = 1}});
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (auto* curves : {&limits, &gaps}) {
      const auto found = curves->find(groups[g]);
      if (found == curves->end()) continue;
      Curve curve = found->second;
      curve.label = groups[g];
      curve.line = false;
      curve.style = {.colour = static_cast<int>(g), .marker = markers[g], .width = 1};
      (curves == &limits ? against : difference).curves.push_back(std::move(curve));
    }
  }
  figure.panels = {against, difference};
  return figure;
}

/// One row a method, one column a material: what an engineer reads.
std::string material_table(const std::vector<LimitCase>& cases, const std::vector<StudyRow>& rows) {
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (cases[i].family == "benchmark liver") columns.push_back(i);
  std::string text = "| method |", rule = "| --- |";
  for (const std::size_t i : columns) {
    text += " " + cases[i].label + " |";
    rule += " ---: |";
  }
  text += "\n" + rule + "\n";
  std::vector<std::string> order;
  std::map<std::string, std::map<std::size_t, const LimitRow*>> of;
  for (const auto& [which, row] : rows) {
    if (!of.contains(row.method)) order.push_back(row.method);
    of[row.method][which] = &row;
  }
  for (const std::string& method : order) {
    const bool bounded = std::ranges::any_of(columns, [&](std::size_t i) {
      return of[method].contains(i) && of[method][i]->bound == name_of(Bound::stability);
    });
    if (!bounded) continue;
    text += "| " + markdown_text(method) + " |";
    for (const std::size_t i : columns)
      text += " " + (of[method].contains(i) ? shown(of[method][i]->h_max) : "-") + " |";
    text += "\n";
  }
  return text;
}

std::string nonlinear_table(const std::vector<LimitCase>& cases, const std::vector<StudyRow>& rows) {
  std::string text =
      "| case | method | at rest | small motion, observed | along the motion, least | at t | from the start, observed |\n"
      "| --- | --- | ---: | ---: | ---: | ---: | ---: |\n";
  for (const auto& [which, row] : rows) {
    const std::string at_rest = row.bound == name_of(Bound::model) ? "the model grows" : shown(row.h_max);
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", markdown_text(cases[which].label),
                        markdown_text(row.method), at_rest, shown(row.observed), shown(row.along_least),
                        std::isfinite(row.along_least) ? fmt::format("{:.3g}", row.along_at) : "-",
                        shown(row.from_start));
  }
  return text;
}

}  // namespace

LimitSummary summary_of(const std::vector<LimitCase>& cases, const std::vector<StudyRow>& rows) {
  LimitSummary summary;
  summary.rows = rows.size();
  for (const auto& [which, row] : rows) {
    if (!row.is_observed()) continue;
    ++summary.integrated;
    if (row.verdict != "confirmed") ++summary.disagreeing;
    if (!has_gap(row)) {
      ++summary.unbounded;
      continue;
    }
    ++summary.with_number;
    if (std::abs(row.gap) > summary.worst_gap) {
      summary.worst_gap = std::abs(row.gap);
      summary.worst = fmt::format("{} on {}", row.method, cases[which].label);
    }
  }
  return summary;
}

void check_limit_files(const fs::path& folder) {
  for (const char* file : {linear_file, nonlinear_file}) check_writable(folder / file, limits_to_csv({}));
}

fs::path reproduce_stability(const std::vector<LimitCase>& cases, const std::vector<StudyRow>& rows,
                             const std::vector<StudyRow>& nonlinear, const std::string& machine,
                             const fs::path& folder, const std::string& rows_link) {
  write_rows(folder / linear_file, rows);
  write_rows(folder / nonlinear_file, nonlinear);
  const LimitSummary summary = summary_of(cases, rows);
  std::vector<ReportSection> sections;
  sections.push_back(
      {.title = "Predicted and observed",
       .text = fmt::format(
           "{} pairs of method and model, of which {} were integrated with the code that they are about; the others have "
           "steps of their own or a model that grows. {} have a limit: the largest "
           "difference is {:.4f} % ({}). {} have none and were integrated at a million times the slowest time scale. "
           "{} disagree.\n\nEvery row with its eigenvalue: [limits.csv](limits.csv).",
           summary.rows, summary.integrated, summary.with_number, 100 * summary.worst_gap, summary.worst,
           summary.unbounded, summary.disagreeing),
       .figures = {draw(predicted_vs_observed(rows, machine), folder, "hmax_predicted_vs_observed")}});
  sections.push_back(
      {.title = "The largest stable step of the benchmark livers [s]",
       .text = "Light and heavy are the ends of the published range of masses. Methods that are stable "
               "at every step are left out.\n\n" +
               material_table(cases, rows)});
  sections.push_back(
      {.title = "Nonlinear and driven models: three predictions and two observations [s]",
       .text =
           "At rest: the limit of the model linearised at its equilibrium, and what a small motion about it shows. "
           "Along the motion: the least limit of the tangent k1 + 3 k3 x² along the motion from the published "
           "start, and when. From the start: the first step, sought upwards in strides of 0.01 to 2 %, whose run leaves "
           "three times the size of the true motion; windows of failures narrower than a stride may lie below it. The "
           "cubic spring stiffens with amplitude, so the motion passes "
           "points whose limit is below that at rest; it passes them quickly, so that the run often bears a longer "
           "step than the least of them, and now and then not even that one. 0: the mode is amplified by any step, which a "
           "short run need not show. A dash: no run tells it, because the model grows, the run is too short for steps of "
           "that length, or already the shortest step leaves the motion.\n\n" +
           nonlinear_table(cases, nonlinear) + "\nAll numbers: [nonlinear.csv](nonlinear.csv)."});
  return write_report("Step limits of the liver oscillators",
                      "`hmax reproduce stability` made this page. " + markdown_text(machine) +
                          (rows_link.empty() ? "" : "\n\n" + rows_link),
                      sections, folder);
}

}  // namespace hmax
