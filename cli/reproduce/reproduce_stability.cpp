#include "cli/reproduce/reproduce_stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/families.hpp"
#include "cli/reproduce/report_page.hpp"
#include "limits/point/prediction.hpp"
#include "results/exports.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

bool has_gap(const LimitRow& row) { return row.is_observed() && std::isfinite(row.gap); }

constexpr const char *linear_file = "limits.csv", *nonlinear_file = "nonlinear.csv";

/// The rows of a study as a store exports them.
void write_rows(const fs::path& file, const std::vector<StudyRow>& rows) {
  std::vector<LimitRow> limits;
  for (const StudyRow& row : rows) limits.push_back(row.limit);
  write_file(file, rows_to_csv(limits), rows_to_csv<LimitRow>({}));
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

/// One row a method with a limit, one column a material.
void add_materials(Json& values, const std::vector<LimitCase>& cases, const std::vector<StudyRow>& rows) {
  values["materials"] = values["limits"] = Json::array();
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < cases.size(); ++i)
    if (cases[i].family == "benchmark liver") {
      columns.push_back(i);
      values["materials"].push_back(cases[i].label);
    }
  std::vector<std::string> order;
  std::map<std::string, std::map<std::size_t, const LimitRow*>> of;
  for (const auto& [which, row] : rows) {
    if (!of.contains(row.method)) order.push_back(row.method);
    of[row.method][which] = &row;
  }
  for (const std::string& method : order) {
    Json h_max = Json::array();
    bool bounded = false;
    for (const std::size_t i : columns) {
      const auto found = of[method].find(i);
      const bool there = found != of[method].end();
      h_max.push_back(there ? found->second->h_max : NAN);
      bounded = bounded || (there && found->second->bound == name_of(Bound::stability));
    }
    if (bounded) values["limits"].push_back({{"method", method}, {"h_max", h_max}});
  }
}

Json nonlinear_rows(const std::vector<LimitCase>& cases, const std::vector<StudyRow>& rows) {
  Json listed = Json::array();
  for (const auto& [which, row] : rows)
    listed.push_back({{"case", cases[which].label},
                      {"method", row.method},
                      {"grows", row.bound == name_of(Bound::model)},
                      {"at_rest", row.h_max},
                      HMAX_KEYS(row, observed, along_least),
                      {"along_at", std::isfinite(row.along_least) ? row.along_at : NAN},
                      {"from_start", row.from_start}});
  return listed;
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
  for (const char* file : {linear_file, nonlinear_file})
    check_writable(folder / file, rows_to_csv<LimitRow>({}));
}

fs::path reproduce_stability(const std::vector<LimitCase>& cases, const std::vector<StudyRow>& rows,
                             const std::vector<StudyRow>& nonlinear, const std::string& machine,
                             const fs::path& folder) {
  write_rows(folder / linear_file, rows);
  write_rows(folder / nonlinear_file, nonlinear);
  ReportPage page("stability", folder);
  page.values = summary_of(cases, rows);
  page.values["machine"] = machine;
  page.values["nonlinear"] = nonlinear_rows(cases, nonlinear);
  add_materials(page.values, cases, rows);
  page.link_to_rows();
  page.link(linear_file, linear_file);
  page.link(nonlinear_file, nonlinear_file);
  page.draw(predicted_vs_observed(rows, machine), "hmax_predicted_vs_observed");
  return page.write();
}

}  // namespace hmax
