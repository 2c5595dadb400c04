#include "plots/curves.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.hpp"

namespace hmax {
namespace {

const std::vector<double>& column(const LabelledTable& labelled, const std::string& name) {
  const Table& table = labelled.table;
  const auto found = std::find(table.columns.begin(), table.columns.end(), name);
  const auto index = static_cast<std::size_t>(found - table.columns.begin());
  if (found == table.columns.end() || index >= table.values.size())
    throw InputError(fmt::format("the curve '{}' has no column '{}'; it has {}", labelled.label, name,
                                 fmt::join(table.columns, ", ")));
  return table.values[index];
}

Curve curve_of(const LabelledTable& labelled, const std::string& x, const std::string& y, int k) {
  const auto &xs = column(labelled, x), &ys = column(labelled, y);
  if (xs.size() != ys.size())
    throw InputError(fmt::format("the curve '{}' has {} values of '{}' but {} of '{}'", labelled.label,
                                 xs.size(), x, ys.size(), y));
  Curve curve{.label = labelled.label, .style = family_style(k)};
  for (std::size_t i = 0; i < xs.size() && std::isfinite(xs[i]) && std::isfinite(ys[i]); ++i) {
    curve.x.push_back(xs[i]);
    curve.y.push_back(ys[i]);
  }
  return curve;
}

/// Three significant digits, a rounding residue as 0, a true minus sign.
std::string number(double value) {
  if (std::abs(value) < 1e-12) value = 0;
  const std::string text = fmt::format("{:.3g}", value);
  return text[0] == '-' ? fmt::format("−{}", text.substr(1)) : text;
}

std::string eigenvalues_in_words(const std::array<std::complex<double>, 2>& lambda) {
  if (!are_conjugate(lambda))
    return fmt::format("λ = {}, {} 1/s", number(lambda[0].real()), number(lambda[1].real()));
  const std::string real = number(lambda[0].real());
  return fmt::format("λ = {}{}i 1/s", real == "0" ? "±" : real + " ± ", number(std::abs(lambda[0].imag())));
}

/// A column's name as the label of an axis: "a [m/s^2]" with a raised 2.
std::string axis_label(std::string name) {
  for (const auto& [plain, raised] : {std::pair{"^2", "²"}, std::pair{"^3", "³"}})
    for (std::size_t at = name.find(plain); at != std::string::npos; at = name.find(plain))
      name.replace(at, 2, raised);
  return name;
}

}  // namespace

bool are_conjugate(const std::array<std::complex<double>, 2>& eigenvalues) {
  return std::abs(eigenvalues[0].imag()) > 1e-7 * std::abs(eigenvalues[0]);
}

std::string type_in_words(std::string type) {
  std::replace(type.begin(), type.end(), '_', ' ');
  return type;
}

int marker_of(const std::string& type) {
  if (type == "stable_node") return 5;
  if (type == "unstable_node") return 4;
  if (type == "stable_focus") return 7;
  if (type == "unstable_focus") return 6;
  if (type == "centre") return 12;
  if (type == "saddle") return 2;
  return 3;
}

Panel series_panel(const std::string& title, const std::vector<LabelledTable>& tables, const std::string& x,
                   const std::string& y) {
  Panel panel{.title = title, .x = {axis_label(x)}, .y = {axis_label(y)}};
  for (std::size_t k = 0; k < tables.size(); ++k)
    panel.curves.push_back(curve_of(tables[k], x, y, static_cast<int>(k)));
  return panel;
}

Figure series_figure(const std::string& title, const std::vector<LabelledTable>& tables,
                     const std::vector<std::string>& ys, const std::string& x) {
  Figure figure{.title = title, .panel_height = ys.size() > 1 ? 200 : 320};
  for (const std::string& y : ys) figure.panels.push_back(series_panel("", tables, x, y));
  return figure;
}

Panel phase_panel(const PhasePlane& plane) {
  Panel panel{.title = plane.title,
              .x = {axis_label(plane.x), false, plane.x_range},
              .y = {axis_label(plane.v), false, plane.v_range}};
  const auto& arrows = plane.direction_field.values;
  if (!arrows.empty()) {
    if (arrows.size() != 4)
      throw InputError("a direction field has four columns: the point and the arrow centred on it");
    panel.arrows = {arrows[0], arrows[1], arrows[2], arrows[3]};
  }
  const std::array<std::string, 2> names{"x' = 0", "v' = 0"};
  const std::array<Style, 2> styles{Style{.colour = 7, .dash = 1, .marker = 0, .width = 1.4},
                                    Style{.colour = 7, .dash = 3, .marker = 0, .width = 1.8}};
  std::vector<Curve> nullclines;
  for (std::size_t component = 0; component < 2; ++component)
    for (const PlaneCurve& points : plane.nullclines[component]) {
      Curve curve{.label = "nullcline " + names[component], .style = styles[component]};
      for (const auto& [x, v] : points) {
        curve.x.push_back(x);
        curve.y.push_back(v);
      }
      nullclines.push_back(std::move(curve));
    }
  std::vector<Mark> starts;
  for (std::size_t k = 0; k < plane.orbits.size(); ++k) {
    Curve orbit = curve_of(plane.orbits[k], plane.x, plane.v, static_cast<int>(k));
    if (!orbit.x.empty())
      starts.push_back({orbit.x[0], orbit.y[0], {.colour = orbit.style.colour, .marker = 9}, "start"});
    panel.curves.push_back(std::move(orbit));
  }
  const auto shared = [&](const Mark& mark) { return mark.x == starts[0].x && mark.y == starts[0].y; };
  if (starts.size() > 1 && std::ranges::all_of(starts, shared)) {
    starts.resize(1);
    starts[0].style.colour = 6;  // of no orbit
  }
  panel.marks = std::move(starts);
  // Under the orbits in the drawing, after them in the key: first drawn is lowest, and the key follows the
  // drawing.
  panel.curves.insert(panel.curves.begin(), nullclines.begin(), nullclines.end());
  for (const RestPoint& point : plane.rest_points) {
    panel.marks.push_back(
        {point.x, point.v, {.colour = 6, .marker = marker_of(point.type)}, type_in_words(point.type)});
    panel.notes.push_back(fmt::format("{} at ({}, {}): {}", type_in_words(point.type), number(point.x),
                                      number(point.v), eigenvalues_in_words(point.eigenvalues)));
  }
  return panel;
}

Figure phase_figure(const std::string& title, const std::vector<PhasePlane>& planes) {
  Figure figure{
      .title = title, .columns = planes.size() > 1 ? 2 : 1, .panel_height = planes.size() > 1 ? 310 : 440};
  for (const PhasePlane& plane : planes) figure.panels.push_back(phase_panel(plane));
  return figure;
}

Figure work_figure(const std::string& title, const std::vector<WorkCurve>& curves,
                   const std::string& footer) {
  double most = 1;
  bool all_settle = true;
  for (const WorkCurve& curve : curves)
    for (std::size_t i = 0; i < curve.work.size(); ++i) {
      most = std::max(most, curve.work[i]);
      all_settle = all_settle && !std::isnan(curve.stiffness[i]);
    }
  // Room for the names, and for what the strip is called.
  const Axis work{.label = "work of a frame: iterations × substeps",
                  .logarithmic = true,
                  .range = Range{all_settle ? 0.8 : 0.3, 6 * most}};
  Panel stiffness{.title = "Stiffness",
                  .x = work,
                  .y = {.label = "stiffness shown over that entered [1]"},
                  .lost_label = "unsettled"};
  Panel damping{.title = "Damping", .x = work, .y = {.label = "added damping ratio of the slowest mode [1]"}};
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const WorkCurve& curve = curves[k];
    const Style style = family_style(static_cast<int>(k), true);
    Curve shown{.label = curve.label, .x = curve.work, .y = curve.stiffness, .style = style};
    for (std::size_t i = 0; i < curve.work.size(); ++i)
      if (std::isnan(curve.stiffness[i])) shown.lost.push_back(curve.work[i]);
    stiffness.curves.push_back(std::move(shown));
    damping.curves.push_back({.label = curve.label, .x = curve.work, .y = curve.damping, .style = style});
    const auto last = std::find_if(curve.damping.rbegin(), curve.damping.rend(),
                                   [](double value) { return std::isfinite(value); });
    if (last == curve.damping.rend()) continue;
    const auto at = static_cast<std::size_t>(curve.damping.rend() - last) - 1;
    damping.marks.push_back({curve.work[at], *last, style, "", curve.label, true});
    damping.marks.back().style.size = 0.6;  // as large as the points of the line
  }
  // Twice the substeps halve it.
  damping.y.logarithmic =
      std::all_of(damping.marks.begin(), damping.marks.end(), [](const Mark& mark) { return mark.y > 0; });
  return {.title = title, .panels = {stiffness, damping}, .columns = 2, .footer = footer};
}

}  // namespace hmax
