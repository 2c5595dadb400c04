#include "plots/stability.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace hmax {

namespace {

/// The rim as curves of one label, cut where it runs along the edges of the frame.
void add_rim(const RegionShape& region, const PlaneFrame& frame, const Style& style, Panel& panel) {
  const double tolerance = 1e-9 * (frame.re.high - frame.re.low);
  const auto near = [&](double a, double b) { return std::abs(a - b) < tolerance; };
  const auto along_edge = [&](const auto& p, const auto& q) {
    return (near(p[0], q[0]) && (near(p[0], frame.re.low) || near(p[0], frame.re.high))) ||
           (near(p[1], q[1]) && (near(p[1], frame.im.low) || near(p[1], frame.im.high)));
  };
  for (const PlaneCurve& loop : region.loops) {
    const std::size_t n = loop.size();
    if (n < 2) continue;
    // From behind an edge, so that no piece is cut at the arbitrary start of the loop.
    std::size_t start = 0;
    while (start < n && !along_edge(loop[start], loop[(start + 1) % n])) ++start;
    Curve piece{.label = region.label, .style = style};
    const auto finish = [&] {
      if (piece.x.size() > 1) panel.curves.push_back(piece);
      piece.x.clear();
      piece.y.clear();
    };
    for (std::size_t k = 0; k < n; ++k) {
      const auto &p = loop[(start + k) % n], &q = loop[(start + k + 1) % n];
      if (along_edge(p, q)) {
        finish();
        continue;
      }
      if (piece.x.empty()) {
        piece.x.push_back(p[0]);
        piece.y.push_back(p[1]);
      }
      piece.x.push_back(q[0]);
      piece.y.push_back(q[1]);
    }
    finish();
  }
}

/// Short strokes from a rim into the region on its left, a pixel being `pixel` long.
Curve strokes_inside(const Curve& rim, double pixel) {
  constexpr double apart = 16, length = 6;  // pixels
  Curve strokes{.style = rim.style, .strokes = true};
  strokes.style.dash = 0;
  strokes.style.width = 0.9;
  double until = apart / 2;  // the next stroke, along the rim
  for (std::size_t i = 0; i + 1 < rim.x.size(); ++i) {
    const double dx = (rim.x[i + 1] - rim.x[i]) / pixel, dy = (rim.y[i + 1] - rim.y[i]) / pixel;
    const double way = std::hypot(dx, dy);
    for (; until < way; until += apart) {
      const double x = rim.x[i] + until / way * dx * pixel, y = rim.y[i] + until / way * dy * pixel;
      strokes.x.insert(strokes.x.end(), {x, x - length * pixel * dy / way});
      strokes.y.insert(strokes.y.end(), {y, y + length * pixel * dx / way});
    }
    until -= way;
  }
  return strokes;
}

/// The plane with its two axes, and nothing in it yet.
Panel empty_plane(const PlaneFrame& frame, const PlaneAxes& axes) {
  constexpr int grey = 7;
  const Style thin{.colour = grey, .width = 0.8};
  return {.x = {axes.re, false, frame.re},
          .y = {axes.im, false, frame.im},
          .curves = {{.x = {frame.re.low, frame.re.high}, .y = {0, 0}, .style = thin},
                     {.x = {0, 0}, .y = {frame.im.low, frame.im.high}, .style = thin}}};
}

}  // namespace

PlaneFrame equal_frame(Range re, Range im, int columns, int least_height, int most_height) {
  // A slide is wider than high.
  if (figure_style() == FigureStyle::slide) most_height = std::max(least_height, most_height * 5 / 8);
  const double width = panel_width(columns), across = re.high - re.low, up = im.high - im.low;
  const int height =
      std::clamp(static_cast<int>(std::lround(width * up / across)), least_height, most_height);
  const double unit = std::max(across / width, up / height);  // of the plane, a pixel
  const auto widened = [unit](Range range, double pixels) {
    const double middle = (range.low + range.high) / 2;
    return Range{middle - unit * pixels / 2, middle + unit * pixels / 2};
  };
  return {widened(re, width), widened(im, height), height};
}

Panel region_panel(const RegionShape& region, const PlaneFrame& frame, const PlaneAxes& axes, int colour) {
  Panel panel = empty_plane(frame, axes);
  panel.grid = false;
  panel.fills.push_back({.loops = region.loops, .colour = colour});
  add_rim(region, frame, {.colour = colour}, panel);
  return panel;
}

Panel regions_panel(const std::vector<RegionShape>& regions, const PlaneFrame& frame, const PlaneAxes& axes) {
  Panel panel = empty_plane(frame, axes);
  const auto axes_drawn = static_cast<std::ptrdiff_t>(panel.curves.size());
  panel.grid = false;
  for (std::size_t k = 0; k < regions.size(); ++k)
    add_rim(regions[k], frame, family_style(static_cast<int>(k)), panel);
  const double pixel = (frame.im.high - frame.im.low) / frame.height;
  const std::vector<Curve> rims(panel.curves.begin() + axes_drawn, panel.curves.end());
  for (const Curve& rim : rims) panel.curves.push_back(strokes_inside(rim, pixel));
  panel.notes = {"stable on the side of the strokes"};
  return panel;
}

Panel field_panel(const std::vector<FieldLevel>& levels, const RegionShape& boundary, const PlaneFrame& frame,
                  const PlaneAxes& axes) {
  constexpr int blue = 0, vermillion = 1, black = 6;
  Panel panel = empty_plane(frame, axes);
  panel.grid = false;
  const auto inside = std::ranges::count_if(levels, [](const FieldLevel& l) { return l.level <= 1; });
  const auto outside = static_cast<std::ptrdiff_t>(levels.size()) - inside;
  const auto [left, right] = frame.re;
  const auto [bottom, top] = frame.im;
  const auto amplifying = [&](std::ptrdiff_t k) {  // the k-th band from the outermost
    return 0.12 + 0.6 * static_cast<double>(outside - k) / static_cast<double>(outside + 1);
  };
  if (!levels.empty())
    panel.fills.push_back({.label = fmt::format("> {}", levels.front().level),
                           .loops = {{{left, bottom}, {right, bottom}, {right, top}, {left, top}}},
                           .colour = vermillion,
                           .shade = amplifying(0)});
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const auto place = static_cast<std::ptrdiff_t>(k);
    const bool damps = levels[k].level <= 1;
    panel.fills.push_back(
        {.label = fmt::format("≤ {}", levels[k].level),
         .loops = levels[k].region.loops,
         .colour = damps ? blue : vermillion,
         .shade = damps ? 0.1 + 0.75 * static_cast<double>(place - outside) / static_cast<double>(inside)
                        : amplifying(place + 1)});
  }
  add_rim(boundary, frame, {.colour = black}, panel);
  return panel;
}

Panel oscillation_panel(const std::vector<OscillationLimit>& limits) {
  double farthest = 0, most_zeta = 0;
  for (const OscillationLimit& limit : limits)
    for (std::size_t i = 0; i < limit.zeta.size(); ++i) {
      if (std::isfinite(limit.omega_h[i])) farthest = std::max(farthest, limit.omega_h[i]);
      most_zeta = std::max(most_zeta, limit.zeta[i]);
    }
  const double right = farthest > 0 ? 1.15 * farthest : 10;
  Panel panel{.x = {"ωh [1]", false, Range{0, right}},
              .y = {"damping ratio ζ [1]", false, Range{0, most_zeta > 0 ? most_zeta : 1}}};
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const OscillationLimit& limit = limits[k];
    const bool bounded =
        std::ranges::any_of(limit.omega_h, [](double omega_h) { return std::isfinite(omega_h); });
    Curve curve{.label = limit.label, .style = family_style(static_cast<int>(k))};
    if (!bounded && !curve.label.empty()) curve.label += ": every ωh";
    std::vector<std::array<double, 2>> stable{{0, 0}};
    for (std::size_t i = 0; i < limit.zeta.size(); ++i) {
      // Beyond the right edge where every step is stable.
      const double at = std::min(limit.omega_h[i], 1.5 * right);
      curve.x.push_back(at);
      curve.y.push_back(limit.zeta[i]);
      stable.push_back({std::min(at, right), limit.zeta[i]});
    }
    stable.push_back({0, most_zeta});
    if (limits.size() == 1) {
      panel.grid = false;
      panel.fills.push_back({.loops = {std::move(stable)}});
    }
    panel.curves.push_back(std::move(curve));
  }
  if (limits.size() > 1) panel.notes = {"stable to the left of a curve"};
  return panel;
}

}  // namespace hmax
