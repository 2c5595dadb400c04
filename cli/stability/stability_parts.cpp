#include "cli/stability/stability_parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "analysis/amplification/part_amplification.hpp"
#include "cli/shared/console.hpp"
#include "cli/shared/options.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

/// "-3", "5i", "-0.5i"
Complex parse_fast(const std::string& text) {
  const bool imaginary = text.ends_with('i');
  const double value = parse_number("--fast", imaginary ? text.substr(0, text.size() - 1) : text);
  if (!std::isfinite(value) || std::abs(value) > 1e6)
    throw InputError(fmt::format(
        "--fast has {}, but z of the stiff part is a number of at most 1e6 like -10, or 5i on the "
        "imaginary axis",
        text));
  return imaginary ? Complex(0, value) : Complex(value, 0);
}

std::string words_of(Complex z) {
  return z.imag() != 0 ? short_number(z.imag()) + "i" : short_number(z.real());
}

bool is_split(const std::vector<PartRegion>& regions) {
  return regions.front().formula.method && regions.front().formula.method->needs_split;
}

/// No more of the window than the regions fill, but for islands.
PlaneWindow close_to(const std::vector<PartRegion>& regions, PlaneWindow window) {
  PlaneWindow close{0, 0, 0, 0};
  for (const PartRegion& region : regions) {
    const auto curves = region_boundary(region.formula.amplification->stable_at, window, 200);
    for (const RegionCurve& curve : curves) {
      if (curve.area() < 0.05 * curves.front().area()) continue;
      for (const Complex z : curve.points)
        close = {std::min(close.re_from, z.real()), std::max(close.re_to, z.real()),
                 std::min(close.im_from, z.imag()), std::max(close.im_to, z.imag())};
    }
  }
  const double margin = 0.08 * std::max(close.re_to - close.re_from, close.im_to - close.im_from);
  if (margin == 0) return window;
  return {close.re_from - margin, close.re_to + margin, close.im_from - margin, close.im_to + margin};
}

/// Where a slow part on the imaginary axis is stable beside a decay: over log10 of its rate.
Panel swing_beside_decay(const Formula& formula, int height, int cells) {
  std::map<double, SlowPolynomial> known;
  const StableAt inside = [&](Complex at) {
    auto [c, is_new] = known.try_emplace(at.real());
    if (is_new) c->second = in_slow(*formula.amplification, -std::pow(10.0, at.real()));
    return is_at_most_one(c->second, Complex(0, at.imag()));
  };
  PlaneWindow window{-2, 4, -12, 12};
  const std::vector<RegionCurve> coarse = region_boundary(inside, window, 120);
  double farthest = 0.5;
  for (const RegionCurve& curve : coarse)
    for (const Complex z : curve.points) farthest = std::max(farthest, z.imag());
  window.im_to = std::min(12.0, 1.15 * farthest);
  window.im_from = -window.im_to;
  const PlaneFrame frame{{window.re_from, window.re_to}, {0, window.im_to}, height};
  return region_panel(shape_of("", region_boundary(inside, window, cells)), frame,
                      {"log₁₀ of -z_fast, a stiff decay [1]", "z_slow / i, an oscillation [1]"});
}

}  // namespace

void PartsChoice::add_to(CLI::App& command) {
  add_text(
      command, "--fast", fast,
      "Of implicit-explicit methods: the region of the part that is not stiff beside a stiff part with these "
      "h lambda, like 0,-1,-10 or 5i",
      "NUMBERS");
  add_text(
      command, "--ratios", ratios,
      "Of linearly implicit methods: the region with a frozen Jacobian, for these ratios of lambda to its "
      "value in the Jacobian, like 1,1.5,2,4",
      "NUMBERS");
}

std::vector<PartRegion> part_regions(const Formula& formula, const PartsChoice& parts) {
  if (!parts.fast.empty() && !parts.ratios.empty())
    throw InputError("--fast and --ratios are two pictures; ask for one of them at a time");
  std::vector<PartRegion> regions;
  const auto add = [&](const std::string& label, Amplification amplification, Complex fast, double ratio) {
    Formula part{.id = label, .order = formula.order, .amplification = shared(std::move(amplification))};
    part.method = formula.method;
    regions.push_back({std::move(part), fast, ratio});
  };
  if (!parts.fast.empty()) {
    if (!formula.method || !formula.method->needs_split)
      throw InputError(
          fmt::format("{} takes all of f alike, and --fast is for methods that treat a stiff part of it "
                      "implicitly; choose one like imex_ark_324",
                      formula.id));
    for (const std::string& text : parse_names("--fast", parts.fast)) {
      const Complex fast = parse_fast(text);
      add("z_fast = " + words_of(fast), beside_stiff(formula.amplification, fast), fast, 1);
    }
    return regions;
  }
  // What foreign engines step with an old Jacobian is not known.
  if (!formula.method || !formula.method->linearly_implicit || formula.method->is_foreign())
    throw InputError(fmt::format(
        "{} does not step with a Jacobian that may be an old one, which --ratios is for; choose one "
        "like rosenbrock_23",
        formula.id));
  for (const double ratio : parse_numbers("--ratios", parts.ratios)) {
    if (!(ratio > 0 && ratio <= 1e6))
      throw InputError(
          fmt::format("--ratios has {}, but a ratio lies between 0 and 1e6, like 1.5", to_text(ratio)));
    add("z / z₀ = " + short_number(ratio), with_old_jacobian(formula.amplification, ratio), 0, ratio);
  }
  return regions;
}

PlaneWindow window_of(const std::vector<PartRegion>& regions, const PlaneLook& look) {
  if (look.window) return *look.window;
  if (!is_split(regions)) return {-14, 6, -8, 8};
  double farthest = 0;
  for (const PartRegion& region : regions) farthest = std::max(farthest, std::abs(region.fast));
  const double size = 6 + 2.2 * farthest;
  return close_to(regions, close_to(regions, {-size, size, -size, size}));
}

std::vector<Panel> panels_of(const Formula& formula, const std::vector<PartRegion>& regions,
                             const PlaneLook& look, int height) {
  const PlaneWindow window = window_of(regions, look);
  const PlaneFrame frame =
      equal_frame({window.re_from, window.re_to}, {window.im_from, window.im_to}, 2, height, height);
  const PlaneWindow framed{frame.re.low, frame.re.high, frame.im.low, frame.im.high};
  const auto shape = [&](const PartRegion& region, const std::string& label) {
    return shape_of(label, region_boundary(region.formula.amplification->stable_at, framed, look.cells));
  };
  std::vector<Panel> panels;
  if (is_split(regions)) {
    std::vector<RegionShape> shapes;
    for (const PartRegion& region : regions) shapes.push_back(shape(region, region.formula.id));
    panels.push_back(regions_panel(shapes, frame, {"Re z_slow [1]", "Im z_slow [1]"}));
    panels.back().title = formula.id;
    panels.push_back(swing_beside_decay(formula, height, look.cells));
    panels.back().title = formula.id + ": how far it may swing";
    return panels;
  }
  for (const PartRegion& region : regions) {
    panels.push_back(region_panel(shape(region, ""), frame));
    panels.back().title = fmt::format("{}, {}", formula.id, region.formula.id);
  }
  return panels;
}

NamedFigure picture_of(const Formula& formula, const std::vector<PartRegion>& regions,
                       const PlaneLook& look) {
  const bool split = is_split(regions);
  Figure figure{
      .title = split ? fmt::format("{}: where the rest of f is stable beside a stiff part z_fast", formula.id)
                     : fmt::format("{} with a frozen Jacobian that says z₀ for z = hλ", formula.id),
      .columns = regions.size() > 1 || split ? 2 : 1,
      .panel_height = split ? 400 : 300};
  figure.panels = panels_of(formula, regions, look, figure.panel_height);
  if (!split)
    for (std::size_t i = 0; i < regions.size(); ++i) figure.panels[i].title = regions[i].formula.id;
  else
    for (Panel& panel : figure.panels) panel.title.clear();
  return {std::move(figure),
          fmt::format("{}_{}", split ? "beside_stiff" : "old_jacobian", file_stem(formula.id))};
}

}  // namespace hmax
