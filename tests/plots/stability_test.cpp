#include "plots/stability.hpp"

#include <cmath>
#include <numbers>
#include <regex>

#include <gtest/gtest.h>

#include "core/numbers.hpp"
#include "plots/draw.hpp"

namespace hmax {
namespace {

/// A circle, counter-clockwise, or clockwise as a hole.
PlaneCurve circle(double x, double y, double radius, bool hole = false) {
  PlaneCurve points;
  for (int i = 0; i < 60; ++i) {
    const double angle = (hole ? -1 : 1) * std::numbers::pi * i / 30;
    points.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle)});
  }
  return points;
}

/// Pixels of a unit on the x axis over those of one on the y axis, as gnuplot will draw them.
double ratio_of_units(const std::string& script) {
  const auto number = [&](const std::string& before) {
    std::smatch match;
    if (!std::regex_search(script, match, std::regex(before + "([-+.0-9e]+)"))) return std::nan("");
    return std::stod(match[1]);
  };
  const double width = number("set terminal svg size "), height = number("set terminal svg size [0-9.]+,");
  const double across = (number("set rmargin at screen ") - number("set lmargin at screen ")) * width;
  const double up = (number("set tmargin at screen ") - number("set bmargin at screen ")) * height;
  const double re = number("set xrange \\[[-+.0-9e]+:") - number("set xrange \\[");
  const double im = number("set yrange \\[[-+.0-9e]+:") - number("set yrange \\[");
  return (across / re) / (up / im);
}

TEST(StabilityFigures, AUnitIsEquallyLongOnBothAxes) {
  const std::pair<Range, Range> rectangles[] = {
      {{-3, 1}, {-3, 3}}, {{-700, 30}, {-5, 5}}, {{-1, 1}, {-40, 40}}, {{-0.02, 0.01}, {-0.03, 0.01}}};
  for (const auto& [re, im] : rectangles)
    for (const int columns : {1, 2}) {
      const PlaneFrame frame = equal_frame(re, im, columns);
      EXPECT_LE(frame.re.low, re.low + 1e-3 * (re.high - re.low));
      EXPECT_GE(frame.im.high, im.high - 1e-3 * (im.high - im.low));
      const Figure figure{
          .panels = {region_panel({}, frame)}, .columns = columns, .panel_height = frame.height};
      EXPECT_NEAR(ratio_of_units(source_of(figure, "region").script), 1, 1e-3);
    }
}

TEST(StabilityFigures, AreAsHighAsTheirPlaneWithinLimits) {
  const double width = panel_width(1);
  const auto expect_frame = [](const PlaneFrame& frame, double re, double im, double height) {
    EXPECT_EQ(frame.height, std::lround(height));
    EXPECT_NEAR(frame.re.high - frame.re.low, re, 2e-3 * re);
    EXPECT_NEAR(frame.im.high - frame.im.low, im, 2e-3 * im);
  };
  expect_frame(equal_frame({-3, 1}, {-1, 1}, 1, 100, 1000), 4, 2, width / 2);
  // Too low and too high for the limits: the other axis shows more.
  expect_frame(equal_frame({-3, 1}, {-1, 1}, 1, 500, 1000), 4, 4 * 500 / width, 500);
  expect_frame(equal_frame({-3, 1}, {-1, 1}, 1, 100, 200), 2 * width / 200, 2, 200);
  const PlaneFrame wider = equal_frame({-3, 1}, {-1, 1}, 1, 100, 200);
  EXPECT_NEAR(wider.re.low + wider.re.high, -2, 1e-12) << "about the same middle";
}

TEST(StabilityFigures, AHoleIsLeftOutOfTheFill) {
  const RegionShape ring{.label = "ring", .loops = {circle(0, 0, 2), circle(0, 0, 1, true)}};
  const Panel panel = region_panel(ring, equal_frame({-3, 3}, {-3, 3}, 1));
  ASSERT_EQ(panel.fills.size(), 1U);
  EXPECT_EQ(panel.fills[0].loops.size(), 2U);
  // The two axes and the two rims, which close.
  ASSERT_EQ(panel.curves.size(), 4U);
  EXPECT_EQ(panel.curves[2].x.size(), 61U);
  EXPECT_EQ(panel.curves[2].x.front(), panel.curves[2].x.back());
  // One path: both loops closed, and back to the start of the first.
  const std::string data = source_of({.panels = {panel}}, "ring").data;
  const std::string fill = data.substr(0, data.find("\n\n"));
  EXPECT_EQ(std::count(fill.begin(), fill.end(), '\n'), 61 + 61 + 1);
  EXPECT_EQ(fill.substr(fill.rfind('\n') + 1), "2 0");
}

TEST(StabilityFigures, NoRimIsDrawnAlongTheFrame) {
  const PlaneFrame frame = equal_frame({-3, 3}, {-2, 2}, 1);
  const auto [left, right] = frame.re;
  const auto [bottom, top] = frame.im;
  const RegionShape half{.loops = {{{left, bottom}, {0, bottom}, {0, 0}, {0, top}, {left, top}}}};
  const Panel panel = region_panel(half, frame);
  ASSERT_EQ(panel.curves.size(), 3U);
  EXPECT_EQ(panel.curves[2].x, (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(panel.curves[2].y, (std::vector<double>{bottom, 0, top}));
}

TEST(StabilityFigures, SeveralRegionsDifferInColourAndDash) {
  const Panel panel =
      regions_panel({{"a", {circle(-1, 0, 1)}}, {"b", {circle(-1, 0, 2)}}}, equal_frame({-4, 4}, {-3, 3}, 1));
  // Two axes, two rims and the strokes of both.
  ASSERT_EQ(panel.curves.size(), 6U);
  EXPECT_TRUE(panel.fills.empty());
  EXPECT_NE(panel.curves[2].style.colour, panel.curves[3].style.colour);
  EXPECT_NE(panel.curves[2].style.dash, panel.curves[3].style.dash);
}

TEST(StabilityFigures, StrokesPointToTheStableSideOfARim) {
  const RegionShape outside{.label = "ring", .loops = {circle(0, 0, 2), circle(0, 0, 1, true)}};
  const Panel panel = regions_panel({outside}, equal_frame({-3, 3}, {-3, 3}, 1));
  ASSERT_EQ(panel.curves.size(), 6U);
  for (const std::size_t rim : {0U, 1U}) {
    const Curve& strokes = panel.curves[4 + rim];
    EXPECT_TRUE(strokes.strokes);
    EXPECT_TRUE(strokes.label.empty());
    EXPECT_EQ(strokes.style.colour, panel.curves[2 + rim].style.colour);
    ASSERT_GT(strokes.x.size(), 20U);
    for (std::size_t i = 0; i + 1 < strokes.x.size(); i += 2) {
      const double from = std::hypot(strokes.x[i], strokes.y[i]);
      const double to = std::hypot(strokes.x[i + 1], strokes.y[i + 1]);
      EXPECT_NEAR(from, rim == 0 ? 2 : 1, 0.01);
      EXPECT_EQ(to < from, rim == 0);
    }
  }
  EXPECT_EQ(panel.notes.size(), 1U);
  // Every stroke is a line of its own.
  const FigureSource source = source_of({.panels = {panel}}, "ring");
  const auto lines = [](const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
    return count;
  };
  EXPECT_GE(lines(source.data, "\n\n"), (panel.curves[4].x.size() + panel.curves[5].x.size()) / 2 - 2);
}

TEST(StabilityFigures, AFieldIsDeeperTheMoreItDampsAndTheMoreItAmplifies) {
  std::vector<FieldLevel> levels;
  for (const double level : {10.0, 2.0, 1.0, 0.5}) levels.push_back({level, {"", {circle(0, 0, level)}}});
  const Panel panel =
      field_panel(levels, {"spectral radius 1", {circle(0, 0, 1)}}, equal_frame({-3, 3}, {-3, 3}, 1));
  ASSERT_EQ(panel.fills.size(), 5U);
  EXPECT_EQ(panel.fills[0].label, "> 10");
  EXPECT_GT(panel.fills[0].shade, panel.fills[1].shade);
  EXPECT_GT(panel.fills[1].shade, panel.fills[2].shade);
  EXPECT_LT(panel.fills[3].shade, panel.fills[4].shade);
  EXPECT_NE(panel.fills[2].colour, panel.fills[3].colour);
  const std::string script = source_of({.panels = {panel}}, "field").script;
  EXPECT_NE(script.find("≤ 0.5"), std::string::npos);
}

TEST(StabilityFigures, AChartEndsWhereStepsAreUnstable) {
  const Panel one = oscillation_panel({{"", {0, 1, 2}, {2, 1, 0.5}}});
  ASSERT_EQ(one.fills.size(), 1U);
  EXPECT_EQ(one.fills[0].loops[0].size(), 5U);
  const Panel two = oscillation_panel({{"a", {0, 2}, {2, 1}}, {"b", {0, 2}, {infinity, infinity}}});
  EXPECT_TRUE(two.fills.empty());
  EXPECT_EQ(two.curves[1].label, "b: every ωh");
  ASSERT_EQ(two.notes.size(), 1U);
  EXPECT_NE(two.notes[0].find("left"), std::string::npos);  // of which side is stable
  // What never ends lies beyond the edge.
  EXPECT_GT(two.curves[1].x[0], two.x.range->high);
}

}  // namespace
}  // namespace hmax
