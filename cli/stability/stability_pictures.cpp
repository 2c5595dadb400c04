#include "cli/stability/stability_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/amplification/limits.hpp"
#include "cli/shared/console.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"

namespace hmax {

namespace {

bool steps_motion(const Formula& formula) { return static_cast<bool>(formula.amplification->of_oscillation); }

double unit_of(const Formula& formula, const PlaneLook& look) {
  return look.per_evaluation ? formula.evaluations : 1;
}

PlaneAxes axes_of(const PlaneLook& look) {
  if (!look.per_evaluation) return {};
  return {"Re hλ / evaluations of f [1]", "Im hλ / evaluations of f [1]"};
}

/// Whether the point is drawn as inside.
StableAt inside_of(const Formula& formula, const PlaneLook& look) {
  StableAt inside;
  if (look.view == PlaneView::order_star)
    inside = [R = formula.amplification->R](Complex z) { return !(std::abs(R(z) * std::exp(-z)) <= 1); };
  else
    inside = stable_at(*formula.amplification);
  if (!look.per_evaluation) return inside;
  return [inside, unit = unit_of(formula, look)](Complex z) { return inside(z * unit); };
}

PlaneFrame frame_of(const PlaneWindow& window, int columns, int least_height, int most_height) {
  return equal_frame({window.re_from, window.re_to}, {window.im_from, window.im_to}, columns, least_height,
                     most_height);
}

PlaneWindow window_of(const PlaneFrame& frame) {
  return {frame.re.low, frame.re.high, frame.im.low, frame.im.high};
}

Panel field_of(const Formula& formula, const PlaneLook& look, const PlaneFrame& frame) {
  constexpr std::array steps{100.0, 10.0, 5.0, 2.0, 1.0, 0.8, 0.6, 0.4, 0.2};
  const PlaneWindow window = window_of(frame);
  const std::vector<FieldLevel> levels = parallel_map(steps.size(), [&](std::size_t i) {
    const StableAt below = [&](Complex z) {
      return formula.amplification->spectral_radius(z * unit_of(formula, look)) <= steps[i];
    };
    return FieldLevel{steps[i], shape_of("", region_boundary(below, window, std::min(look.cells, 240)))};
  });
  return field_panel(levels, shape_of("spectral radius 1", curves_of(formula, look, window)), frame,
                     axes_of(look));
}

/// The first exit of undamped to twice critically damped oscillations.
OscillationLimit oscillation_limit(const Formula& formula) {
  OscillationLimit limit{.label = formula.id};
  constexpr int points = 200;
  for (int i = 0; i <= points; ++i) {
    const double zeta = 2.0 * i / points;
    limit.zeta.push_back(zeta);
    limit.omega_h.push_back(first_exit(formula.amplification->of_oscillation(MechanicalMode{1, 2 * zeta})));
  }
  return limit;
}

bool is_chart(const std::vector<Formula>& formulas, const PlaneLook& look) {
  return look.view == PlaneView::region && !look.per_evaluation && !look.window &&
         std::ranges::all_of(formulas, steps_motion);
}

/// The window of the look; where none is asked for and the region ends inside of the one that fits, no more
/// of that than is needed.
PlaneWindow close_window_of(const Formula& formula, const PlaneLook& look) {
  const PlaneWindow window = window_of(formula, look);
  // Steps of the code are too dear to be taken twice.
  if (look.window || look.view == PlaneView::order_star || formula.amplification->measured) return window;
  PlaneLook coarse = look;
  coarse.cells = 100;
  const std::vector<RegionCurve> curves = curves_of(formula, coarse, window);
  if (curves.empty() || std::ranges::any_of(curves, &RegionCurve::clipped)) return window;
  PlaneWindow close{0, 0, 0, 0};
  for (const RegionCurve& curve : curves)
    for (const Complex z : curve.points)
      close = {std::min(close.re_from, z.real()), std::max(close.re_to, z.real()),
               std::min(close.im_from, z.imag()), std::max(close.im_to, z.imag())};
  const double margin = 0.08 * std::max(close.re_to - close.re_from, close.im_to - close.im_from);
  return {close.re_from - margin, close.re_to + 1.5 * margin, close.im_from - margin, close.im_to + margin};
}

PlaneWindow united(const std::vector<Formula>& formulas, const PlaneLook& look) {
  const std::vector<PlaneWindow> windows =
      parallel_map(formulas.size(), [&](std::size_t i) { return close_window_of(formulas[i], look); });
  PlaneWindow all = windows.front();
  for (const PlaneWindow& window : windows)
    all = {std::min(all.re_from, window.re_from), std::max(all.re_to, window.re_to),
           std::min(all.im_from, window.im_from), std::max(all.im_to, window.im_to)};
  return all;
}

std::string sentence(const std::vector<Formula>& formulas, const PlaneLook& look, bool chart) {
  const std::string who =
      formulas.size() == 1 ? formulas.front().id : fmt::format("{} methods", formulas.size());
  if (look.view == PlaneView::field)
    return fmt::format("How much a step of {} amplifies y' = λy: the spectral radius over z = hλ", who);
  if (look.view == PlaneView::order_star)
    return fmt::format("Order star: where a step of {} amplifies more than y' = λy does", who);
  if (chart)
    return formulas.size() == 1
               ? fmt::format("The steps at which {} keeps an oscillation bounded", who)
               : "The largest stable step of an oscillation over its damping: stable to the left";
  return formulas.size() == 1
             ? fmt::format("The steps at which {} does not amplify y' = λy, z = hλ", who)
             : fmt::format("The stability regions of {}{}", who,
                           look.per_evaluation ? " for equal work" : ", z = hλ on equal scales");
}

std::string upto(double value) {
  return std::isinf(value) ? "unbounded" : value == 0 ? "none" : short_number(value, 4);
}

}  // namespace

RegionShape shape_of(const std::string& label, const std::vector<RegionCurve>& curves) {
  RegionShape shape{.label = label};
  for (const RegionCurve& curve : curves) {
    shape.loops.emplace_back();
    for (const auto z : curve.points) shape.loops.back().push_back({z.real(), z.imag()});
  }
  return shape;
}

void expect_look(const Formula& formula, const PlaneLook& look) {
  if (look.per_evaluation && formula.evaluations < 1)
    throw InputError(
        fmt::format("{} solves equations in its steps, and --per-evaluation counts evaluations of f only; "
                    "leave one of the two out",
                    formula.id));
  if (look.view == PlaneView::order_star && !formula.amplification->R)
    throw InputError(
        fmt::format("{} has no order star: it is for one-step methods, whose step on y' = λy is one number "
                    "R(z); choose one such as rk4 or radau_iia_5",
                    formula.id));
}

PlaneWindow window_of(const Formula& formula, const PlaneLook& look) {
  if (look.window) return *look.window;
  const double unit = unit_of(formula, look);
  PlaneWindow window = window_of(*formula.amplification);
  if (look.view == PlaneView::order_star) {
    // The fingers and the poles between them lie around the origin.
    const double size = std::clamp(1.2 * formula.order + 1, 3.0, 10.0);
    window = {-size, size, -size, size};
  }
  return {window.re_from / unit, window.re_to / unit, window.im_from / unit, window.im_to / unit};
}

std::vector<RegionCurve> curves_of(const Formula& formula, const PlaneLook& look, const PlaneWindow& window) {
  return region_boundary(inside_of(formula, look), window, look.cells);
}

Panel panel_of(const Formula& formula, const PlaneLook& look, int columns, int least_height, int most_height,
               int* height) {
  expect_look(formula, look);
  Panel panel;
  if (is_chart({formula}, look)) {
    OscillationLimit limit = oscillation_limit(formula);
    limit.label.clear();
    panel = oscillation_panel({limit});
    if (height != nullptr) *height = std::clamp(330, least_height, most_height);
  } else {
    const PlaneFrame frame = frame_of(close_window_of(formula, look), columns, least_height, most_height);
    panel = look.view == PlaneView::field
                ? field_of(formula, look, frame)
                : region_panel(shape_of("", curves_of(formula, look, window_of(frame))), frame, axes_of(look),
                               look.view == PlaneView::order_star ? 1 : 0);
    if (height != nullptr) *height = frame.height;
  }
  panel.title = formula.id;
  panel.notes = limits_in_words(formula);
  return panel;
}

NamedFigure picture_of(const std::vector<Formula>& formulas, const PlaneLook& look) {
  for (const Formula& formula : formulas) expect_look(formula, look);
  const std::string_view view = look.view == PlaneView::field        ? "field"
                                : look.view == PlaneView::order_star ? "order_star"
                                                                     : "region";
  const bool chart = is_chart(formulas, look), one = formulas.size() == 1;
  Figure figure{.title = sentence(formulas, look, chart)};
  if (one) {
    figure.panels.push_back(panel_of(formulas.front(), look, 1, 170, 520, &figure.panel_height));
    figure.panels.front().title.clear();
  } else if (look.view != PlaneView::region) {
    figure.columns = 2;
    figure.panel_height = 330;
    figure.panels = parallel_map(formulas.size(),
                                 [&](std::size_t i) { return panel_of(formulas[i], look, 2, 330, 330); });
  } else if (chart) {
    figure.panels.push_back(oscillation_panel(
        parallel_map(formulas.size(), [&](std::size_t i) { return oscillation_limit(formulas[i]); })));
    figure.panel_height = 400;
  } else {
    const PlaneFrame frame = frame_of(united(formulas, look), 1, 170, 560);
    const std::vector<RegionShape> shapes = parallel_map(formulas.size(), [&](std::size_t i) {
      return shape_of(formulas[i].id, curves_of(formulas[i], look, window_of(frame)));
    });
    figure.panels.push_back(regions_panel(shapes, frame, axes_of(look)));
    figure.panel_height = frame.height;
  }
  return {std::move(figure), fmt::format("{}{}{}", view, one ? "_" + file_stem(formulas.front().id) : "s",
                                         look.per_evaluation ? "_per_evaluation" : "")};
}

std::vector<std::string> limits_in_words(const Formula& formula) {
  const StabilityLimits limits = stability_limits(*formula.amplification);
  std::vector<std::string> lines;
  if (steps_motion(formula))
    lines.push_back(std::isinf(limits.imaginary)
                        ? "undamped: every ωh"
                        : fmt::format("undamped: up to ωh = {}", upto(limits.imaginary)));
  else if (upto(limits.imaginary_weak) != upto(limits.imaginary))
    lines.push_back(fmt::format("real axis {}, imaginary axis {} (|R| ≤ 1 + 1e-6 up to {})",
                                upto(limits.real), upto(limits.imaginary), upto(limits.imaginary_weak)));
  else
    lines.push_back(
        fmt::format("real axis {}, imaginary axis {}", upto(limits.real), upto(limits.imaginary)));
  std::string stable = limits.l_stable   ? "A- and L-stable"
                       : limits.a_stable ? "A-stable"
                       : limits.alpha_degrees && *limits.alpha_degrees > 0
                           ? fmt::format("A({})-stable", short_number(*limits.alpha_degrees, 4) + "°")
                           : "";
  if (!stable.empty() && !limits.l_stable && limits.at_infinity && std::isfinite(*limits.at_infinity))
    stable += fmt::format(", {} at infinity", short_number(*limits.at_infinity, 3));
  lines.push_back(stable.empty() ? fmt::format("order {}", formula.order)
                                 : fmt::format("order {}, {}", formula.order, stable));
  return lines;
}

std::string file_stem(const std::string& id) {
  std::string stem = id;
  std::ranges::replace_if(
      stem, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-'; }, '_');
  return stem;
}

}  // namespace hmax
