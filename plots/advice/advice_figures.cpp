#include "plots/advice/advice_figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "results/numbers.hpp"

namespace hmax {

namespace {

constexpr int blue = 0, vermillion = 1, green = 2, sky_blue = 5, black = 6, grey = 7;

/// What rows are told apart by.
struct RowClass {
  const char* label;
  Style style;
};
constexpr std::size_t best = 0;
const std::array<RowClass, 4> classes{
    {{"recommended", {.colour = green, .marker = 13, .size = 1.3}},
     {"tie", {.colour = blue, .marker = 7}},
     {"suitable", {.colour = sky_blue, .marker = 6, .width = 1.5, .size = 1.1}},
     {"not suitable", {.colour = vermillion, .marker = 8, .size = 1.1}}}};

std::size_t class_of(const AdviceRecord& row) {
  for (std::size_t k = 0; k + 1 < classes.size(); ++k)
    if (row.verdict == classes[k].label) return k;
  return classes.size() - 1;
}

bool is_positive(double value) { return std::isfinite(value) && value > 0; }
double milliseconds(double seconds) { return 1e3 * seconds; }
double percent(double share) { return 100 * share; }

/// In the strip at the top: the run did not reach its end, or is off by more than the whole motion.
bool is_lost(const AdviceRecord& row) { return is_positive(row.frame_p50) && row.error > 1; }
bool is_shown(const AdviceRecord& row) {
  return is_positive(row.frame_p50) && is_positive(row.error) && !is_lost(row);
}

/// A range around positive values on a logarithmic axis.
Range around(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax(values);
  const double margin = std::max(1.25, std::pow(high / low, 0.06));
  return {low / margin, high * margin};
}

std::string short_number(double value) { return rounded_text(value, 3); }

/// The lines at tolerance and budget, and the corner where both are met.
void add_bounds(Panel& panel, double tolerance, double budget) {
  const Range &x = *panel.x.range, &y = *panel.y.range;
  panel.fills.push_back(
      {.loops = {{{x.low, y.low}, {budget, y.low}, {budget, tolerance}, {x.low, tolerance}}},
       .colour = green,
       .shade = 0.1});
  panel.curves.push_back({.label = fmt::format("tolerance {} %", short_number(tolerance)),
                          .x = {x.low, x.high},
                          .y = {tolerance, tolerance},
                          .style = {.colour = black, .dash = 1, .width = 1.2}});
  panel.curves.push_back({.label = fmt::format("budget {} ms", short_number(budget)),
                          .x = {budget, budget},
                          .y = {y.low, y.high},
                          .style = {.colour = black, .dash = 3, .width = 1.2}});
}

/// One curve of marks for each class but the best, which is a mark with a name.
void add_rows(Panel& panel, const std::vector<AdviceRecord>& rows) {
  for (std::size_t k = best + 1; k < classes.size(); ++k) {
    Curve curve{.label = classes[k].label, .style = classes[k].style, .line = false};
    for (const AdviceRecord& row : rows) {
      if (class_of(row) != k) continue;
      if (is_lost(row)) curve.lost.push_back(milliseconds(row.frame_p50));
      if (!is_shown(row)) continue;
      curve.x.push_back(milliseconds(row.frame_p50));
      curve.y.push_back(percent(row.error));
    }
    if (!curve.x.empty() || !curve.lost.empty()) panel.curves.push_back(std::move(curve));
  }
  for (const AdviceRecord& row : rows)
    if (class_of(row) == best && is_shown(row))
      panel.marks.push_back({.x = milliseconds(row.frame_p50),
                             .y = percent(row.error),
                             .style = classes[best].style,
                             .label = classes[best].label,
                             .name = row.words()});
}

}  // namespace

Figure advice_cost_figure(const AdviceKey& question, const std::vector<AdviceRecord>& rows,
                          const std::string& error_of) {
  const double tolerance = percent(question.tolerance), budget = milliseconds(question.budget);
  std::vector<double> times{budget}, errors{tolerance};
  for (const AdviceRecord& row : rows) {
    if (is_shown(row) || is_lost(row)) times.push_back(milliseconds(row.frame_p50));
    if (is_shown(row)) errors.push_back(percent(row.error));
  }
  Panel panel{.x = {"CPU time of a frame, median [ms]", true, around(times)},
              .y = {fmt::format("error, relative to the {} [%]", error_of), true, around(errors)},
              .grid = false,  // the tint would cover a part of it
              .notes = {"tinted: error within the tolerance, median within the budget"},
              .lost_label = "error above 100 %"};
  add_bounds(panel, tolerance, budget);
  add_rows(panel, rows);
  const auto missing =
      std::ranges::count_if(rows, [](const AdviceRecord& row) { return !is_shown(row) && !is_lost(row); });
  if (missing > 0)
    panel.notes.push_back(
        fmt::format("{} without a time or an error {} not shown", missing, missing == 1 ? "is" : "are"));
  return {.title = "Error and CPU time of each method", .panels = {std::move(panel)}, .panel_height = 380};
}

std::optional<Figure> advice_step_figure(const std::vector<AdviceRecord>& rows) {
  std::vector<const AdviceRecord*> limited;
  for (const AdviceRecord& row : rows)
    if (is_positive(row.h) && (is_positive(row.h_max) || is_positive(row.h_max_observed)))
      limited.push_back(&row);
  if (limited.empty()) return std::nullopt;
  Curve link{.style = {.colour = grey, .width = 1}, .strokes = true};
  Curve step{.label = "step h", .style = {.colour = blue, .marker = 7}, .line = false};
  Curve predicted{
      .label = "h_max predicted", .style = {.colour = vermillion, .marker = 12, .size = 1.5}, .line = false};
  Curve observed{
      .label = "h_max observed", .style = {.colour = black, .marker = 2, .size = 0.9}, .line = false};
  Panel panel{.x = {"step [ms]", true},
              .y = {.label = "method", .range = Range{0.4, static_cast<double>(limited.size()) + 0.6}}};
  const auto add = [](Curve& curve, double seconds, double at) {
    if (!is_positive(seconds)) return;
    curve.x.push_back(milliseconds(seconds));
    curve.y.push_back(at);
  };
  for (std::size_t i = limited.size(); i-- > 0;) {
    const AdviceRecord& row = *limited[i];
    panel.y.names.push_back(row.words());
    const auto at = static_cast<double>(panel.y.names.size());
    add(step, row.h, at);
    add(predicted, row.h_max, at);
    add(observed, row.h_max_observed, at);
    add(link, row.h, at);
    add(link, is_positive(row.h_max) ? row.h_max : row.h_max_observed, at);
  }
  panel.curves = {std::move(link), std::move(step), std::move(predicted), std::move(observed)};
  if (panel.curves.back().x.empty()) panel.curves.pop_back();
  const int height = 24 + 24 * static_cast<int>(limited.size());
  return Figure{.title = "Steps and their limits",
                .panels = {std::move(panel)},
                .panel_height = std::clamp(height, 72, 640)};
}

}  // namespace hmax
