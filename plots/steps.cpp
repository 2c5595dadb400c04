#include "plots/steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "core/errors.hpp"

namespace hmax {
namespace {

bool reached_end(const Row& row) { return row.outcome == "reached_end"; }

/// The rows of the shown methods in `mode`.
std::vector<Row> shown(const std::vector<Row>& rows, const std::string& mode,
                       const std::vector<ShownMethod>& methods) {
  std::vector<Row> kept;
  for (const Row& row : rows) {
    const bool wanted =
        row.key.mode == mode && std::any_of(methods.begin(), methods.end(),
                                            [&](const ShownMethod& m) { return m.id == row.key.method; });
    if (wanted) kept.push_back(row);
  }
  const auto differs = [&](const Row& row) {
    const RowKey &a = row.key, &b = kept.front().key;
    return a.problem != b.problem || a.material != b.material || a.parameters != b.parameters ||
           a.y0 != b.y0 || a.t_end != b.t_end || a.device != b.device || a.precision != b.precision;
  };
  if (std::any_of(kept.begin(), kept.end(), differs))
    throw InputError(
        "rows of several problems, parameters, end times or devices cannot share a figure; select those of "
        "one");
  if (std::any_of(kept.begin(), kept.end(), [](const Row& row) { return row.explored; }))
    throw InputError(
        "the times of explored rows cannot be drawn; measure them by `hmax sweep` without --explore");
  return kept;
}

struct Measured {
  double x, y, low, high;
};

/// One curve per method that has a row; `measure` says what is drawn of a row that reached its end,
/// `order_by` what the line follows, `lost_at` where a lost run is marked (NaN: nowhere).
std::vector<Curve> curves_of(const std::vector<Row>& rows, const std::vector<ShownMethod>& methods, bool bars,
                             const std::function<Measured(const Row&)>& measure,
                             const std::function<double(const Row&)>& order_by, bool mark_lost) {
  const std::vector<Style> styles = method_styles(methods);
  std::vector<Curve> curves;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    std::vector<const Row*> own;
    for (const Row& row : rows)
      if (row.key.method == methods[m].id) own.push_back(&row);
    if (own.empty()) continue;
    std::stable_sort(own.begin(), own.end(),
                     [&](const Row* a, const Row* b) { return order_by(*a) < order_by(*b); });
    Curve curve{.label = methods[m].label.empty() ? methods[m].id : methods[m].label, .style = styles[m]};
    for (const Row* row : own) {
      if (!reached_end(*row)) {
        if (mark_lost) curve.lost.push_back(row->key.h);
        continue;
      }
      const Measured point = measure(*row);
      curve.x.push_back(point.x);
      curve.y.push_back(point.y);
      if (!bars) continue;
      curve.low.push_back(point.low);
      curve.high.push_back(point.high);
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

double by_step(const Row& row) { return row.key.h; }

/// What the time of rows of one device is called.
std::string time_of(const std::vector<Row>& rows) {
  return std::string(name_of_time(rows.empty() ? RowKey{} : rows.front().key));
}

/// "CPU time of one run", or "Device time of one run on NVIDIA H200".
std::string title_of_time(const std::vector<Row>& rows) {
  if (rows.empty() || !is_on_device(rows.front())) return "CPU time of one run";
  return "Device time of one run on " + rows.front().key.device;
}

Measured run_time(const Row& row) {
  const TimingSummary time = summarise(times_of(row));
  return {row.key.h, time.median, time.q1, time.q3};
}

/// "diverged", or what happened in general when not all lost runs diverged.
std::string lost_label(const std::vector<Row>& rows) {
  const bool all_diverged = std::all_of(
      rows.begin(), rows.end(), [](const Row& row) { return reached_end(row) || row.outcome == "diverged"; });
  return all_diverged ? "diverged" : "did not reach the end";
}

std::string reading(const std::string& mode) {
  if (mode == "fixed") return "fixed: the step is h";
  if (mode == "sampled") return "sampled: steps by error control, output every h";
  return "adaptive: steps by error control";
}

/// Gives panels side by side one vertical scale, so that heights can be compared.
void share_range(std::vector<Panel>& panels) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const Panel& panel : panels)
    for (const Curve& curve : panel.curves)
      for (const double y : curve.y)
        if (std::isfinite(y) && y > 0) {
          low = std::min(low, y);
          high = std::max(high, y);
        }
  for (Panel& panel : panels)
    if (low < high) panel.y.range = Range{low / 2, high * 2};
}

void require_some(const std::vector<Row>& rows) {
  if (rows.empty())
    throw InputError("there is no stored row of the wanted methods and modes to draw; run hmax sweep first");
}

}  // namespace

std::vector<Style> method_styles(const std::vector<ShownMethod>& methods) {
  // From light to dark with the order: orange, purple, vermillion, green, blue, black; sky blue for variable
  // order.
  constexpr std::array by_order{5, 4, 3, 1, 2, 0, 7, 6, 6};
  constexpr std::array filled_then_open{7, 4, 9, 12, 5, 6, 13, 8};
  std::map<int, int> seen;
  std::vector<Style> styles;
  for (const ShownMethod& method : methods) {
    const int order = std::clamp(method.order, 0, static_cast<int>(by_order.size()) - 1);
    const int colour = by_order[static_cast<std::size_t>(order)];
    const int k = seen[colour]++;
    styles.push_back({.colour = colour,
                      .dash = k,
                      .marker = filled_then_open[static_cast<std::size_t>(k) % filled_then_open.size()],
                      .width = 1.5});
  }
  return styles;
}

Panel run_time_panel(const std::vector<Row>& rows, const std::string& mode,
                     const std::vector<ShownMethod>& methods) {
  const std::vector<Row> kept = shown(rows, mode, methods);
  return {.title = title_of_time(kept),
          .x = {"h [s]", true, {}},
          .y = {time_of(kept) + " [s]", true, {}},
          .curves = curves_of(kept, methods, true, run_time, by_step, true),
          .notes = {reading(mode)},
          .lost_label = lost_label(kept)};
}

Figure step_figure(const std::vector<Row>& rows, const std::vector<ShownMethod>& methods) {
  Figure figure{.title = "A smaller step costs time and buys accuracy until rounding takes over",
                .columns = 0};
  std::vector<Panel> errors;
  for (const std::string mode : {"fixed", "sampled"}) {
    const std::vector<Row> kept = shown(rows, mode, methods);
    if (kept.empty()) continue;
    const auto error = [](const Row& row) { return Measured{row.key.h, row.error_global, 0, 0}; };
    figure.panels.push_back(run_time_panel(rows, mode, methods));
    errors.push_back({.title = "Largest error of one run",
                      .x = {"h [s]", true, {}},
                      .y = {"largest error over all outputs", true, {}},
                      .curves = curves_of(kept, methods, false, error, by_step, true),
                      .notes = {reading(mode)},
                      .lost_label = lost_label(kept)});
    ++figure.columns;
  }
  share_range(figure.panels);
  share_range(errors);
  if (figure.columns == 1) figure.columns = 2;  // time and error side by side
  for (Panel& panel : errors) figure.panels.push_back(std::move(panel));
  if (figure.panels.empty()) require_some({});
  return figure;
}

Figure step_cost_figure(const std::vector<Row>& rows, const std::vector<ShownMethod>& methods) {
  const std::vector<Row> kept = shown(rows, "fixed", methods);
  require_some(kept);
  const auto per_step = [](const Row& row) {
    const TimingSummary time = summarise(times_of(row));
    const double scale = row.steps > 0 ? 1e9 / static_cast<double>(row.steps) : NAN;
    return Measured{row.key.h, time.median * scale, time.q1 * scale, time.q3 * scale};
  };
  return {.title = "The cost of a step over its size",
          .panels = {{.x = {"h [s]", true, {}},
                      .y = {time_of(kept) + " per step [ns]", true, {}},
                      .curves = curves_of(kept, methods, true, per_step, by_step, true),
                      .notes = {reading("fixed")},
                      .lost_label = lost_label(kept)}},
          .panel_height = 380};
}

namespace {

/// A line for each method that stability held back: the cost of a run of its largest stable steps, at what
/// its longest run without failure paid a step.
std::vector<Curve> stability_limits(const std::vector<Row>& rows, const std::vector<ShownMethod>& methods,
                                    const std::function<double(const Row&)>& cost) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const Row& row : rows)
    if (reached_end(row) && row.error_global > 0) {
      low = std::min(low, row.error_global);
      high = std::max(high, row.error_global);
    }
  const std::vector<Style> styles = method_styles(methods);
  std::vector<Curve> lines;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const Row* fewest = nullptr;
    for (const Row& row : rows)
      if (row.key.method == methods[m].id && reached_end(row) && row.steps > 0 &&
          (!fewest || row.steps < fewest->steps))
        fewest = &row;
    if (!fewest || !(methods[m].stable_step > 0) || !std::isfinite(methods[m].stable_step)) continue;
    const double least = fewest->key.t_end / methods[m].stable_step,
                 taken = static_cast<double>(fewest->steps);
    if (taken > 1.5 * least) continue;
    const double height = cost(*fewest) * least / taken;
    Style style = styles[m];
    style.dash = 3;
    style.marker = 0;
    lines.push_back(
        {.label = "least for stability", .x = {low, high}, .y = {height, height}, .style = style});
  }
  return lines;
}

}  // namespace

Figure work_precision_figure(const std::vector<Row>& rows, const std::vector<ShownMethod>& methods,
                             const std::string& error_words) {
  std::vector<Row> kept = shown(rows, "fixed", methods);
  for (Row& row : shown(rows, "adaptive", methods)) kept.push_back(std::move(row));
  require_some(kept);
  const auto follow = [](const Row& row) { return row.key.mode == "fixed" ? row.key.h : row.key.rtol; };
  const auto time = [](const Row& row) {
    const TimingSummary times = summarise(times_of(row));
    return Measured{row.error_global, times.median, times.q1, times.q3};
  };
  const auto evaluations = [](const Row& row) {
    return Measured{row.error_global, static_cast<double>(row.rhs), 0, 0};
  };
  std::vector<std::string> failures;
  for (const ShownMethod& method : methods) {
    std::string settings, outcome;
    for (const Row& row : kept)
      if (row.key.method == method.id && !reached_end(row)) {
        settings += fmt::format("{}{:.3g}", settings.empty() ? "" : ", ", follow(row));
        outcome = row.outcome + (row.key.mode == "fixed" ? " at h = " : " at rtol = ");
      }
    if (!settings.empty()) failures.push_back(fmt::format("{}: {}{}", method.id, outcome, settings));
  }
  const Axis error{error_words, true, {}};
  const auto with_limits = [&](std::vector<Curve> curves, const std::function<double(const Row&)>& cost) {
    for (Curve& limit : stability_limits(kept, methods, cost)) curves.push_back(std::move(limit));
    return curves;
  };
  return {.title = "What an error costs: " + kept.front().key.problem,
          .panels = {{.title = title_of_time(kept),
                      .x = error,
                      .y = {time_of(kept) + " [s]", true, {}},
                      .curves = with_limits(curves_of(kept, methods, true, time, follow, false),
                                            [](const Row& row) { return summarise(times_of(row)).median; }),
                      .notes = failures},
                     {.title = "Evaluations of f",
                      .x = error,
                      .y = {"evaluations", true, {}},
                      .curves = with_limits(curves_of(kept, methods, false, evaluations, follow, false),
                                            [](const Row& row) { return static_cast<double>(row.rhs); })}},
          .columns = 2,
          .panel_height = 380};
}

}  // namespace hmax
