#include "plots/drawn/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "results/errors.hpp"

namespace hmax {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// A cube of 0.1 m, each side of two triangles.
BodyView cube() {
  BodyView view;
  for (int i = 0; i < 8; ++i) view.points.push_back({0.1 * (i & 1), 0.1 * (i >> 1 & 1), 0.1 * (i >> 2 & 1)});
  view.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return view;
}

/// A ball of radius 0.1 m by longitude and latitude, 2 * around * (along - 1) triangles.
BodyView ball(int around, int along) {
  BodyView view;
  for (int k = 0; k <= along; ++k)
    for (int i = 0; i < around; ++i) {
      const double polar = std::numbers::pi * k / along, angle = 2 * std::numbers::pi * i / around;
      view.points.push_back({0.1 * std::sin(polar) * std::cos(angle), 0.1 * std::sin(polar) * std::sin(angle),
                             0.1 * std::cos(polar)});
    }
  for (int k = 0; k < along; ++k)
    for (int i = 0; i < around; ++i) {
      const int j = (i + 1) % around, a = k * around + i, b = k * around + j, c = a + around, d = b + around;
      if (k > 0) view.triangles.push_back({a, c, b});
      if (k + 1 < along) view.triangles.push_back({b, c, d});
    }
  for (const SpacePoint& p : view.points) view.values.push_back(p[2]);
  return view;
}

double distance(const OkLab& p, const OkLab& q) {
  return std::hypot(p.lightness - q.lightness, p.a - q.a, p.b - q.b);
}

TEST(ColourMaps, TakeEqualStepsToTheEyeForEqualSteps) {
  for (const ColourMap* map : {&sequential_colours(), &diverging_colours()}) {
    constexpr int steps = 200;
    std::vector<double> lengths;
    for (int k = 0; k < steps; ++k)
      lengths.push_back(distance(map->at(double(k) / steps), map->at(double(k + 1) / steps)));
    std::ranges::sort(lengths);
    // The few that cut a corner of the way are shorter.
    EXPECT_GT(lengths[6], 0.999 * lengths.back());
    EXPECT_GT(lengths[0], 0.6 * lengths.back());
  }
  EXPECT_EQ(hex_of(sequential_colours().at(-1)), hex_of(sequential_colours().at(0)));
}

TEST(ColourMaps, GrowDarkerAllTheWayWhereAQuantityBeginsAtNothing) {
  double last = 2;
  for (int k = 0; k <= 100; ++k) {
    const double lightness = sequential_colours().at(k / 100.0).lightness;
    EXPECT_LT(lightness, last);
    last = lightness;
  }
}

TEST(ColourMaps, HexGoesToOkLabAndBack) {
  for (const char* hex : {"#000000", "#ffffff", "#0072b2", "#d55e00", "#010203"})
    EXPECT_EQ(hex_of(oklab_of(hex)), hex);
  const OkLab white = oklab_of("#ffffff");
  EXPECT_NEAR(white.lightness, 1, 1e-6);
  EXPECT_NEAR(white.a, 0, 1e-6);
  EXPECT_NEAR(white.b, 0, 1e-6);
}

TEST(Cameras, SeeLengthsAsTheyAreAndZUp) {
  const Camera camera({0.45, -1, 0.5});
  const SpacePoint p{0.3, -0.2, 0.7}, seen = camera.seen(p);
  EXPECT_NEAR(std::hypot(seen[0], seen[1], seen[2]), std::hypot(p[0], p[1], p[2]), 1e-15);
  EXPECT_NEAR(camera.seen({0, 0, 1})[0], 0, 1e-15);
  EXPECT_GT(camera.seen({0, 0, 1})[1], 0);
  EXPECT_GT(camera.seen({0, -1, 0})[2], 0);
  // From above, where z is no direction of the view.
  EXPECT_NEAR(Camera({0, 0, 1}).seen({0, 1, 0})[1], 1, 1e-15);
}

TEST(Painters, DrawThreeSidesOfACube) {
  const BodyView view = cube();
  const Camera camera({0.45, -1, 0.5});
  Painter painter(camera, {.scale = 1000});
  painter.add_surface({.points = view.points,
                       .triangles = view.triangles,
                       .shares = view.values,
                       .map = sequential_colours(),
                       .smooth = true},
                      1e6);
  const std::string svg = painter.svg();
  EXPECT_EQ(count(svg, "z"), 6U);  // closed faces
  std::set<std::string> colours;
  for (std::size_t at = svg.find("color="); at != std::string::npos; at = svg.find("color=", at + 1))
    colours.insert(svg.substr(at + 7, 7));
  EXPECT_EQ(colours.size(), 3U) << "each side in the light of its own";
}

TEST(Painters, PaintTheNearerFaceLater) {
  const std::vector<SpacePoint> points{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {1, -1, 0}, {0, -1, 1}};
  for (const bool turned : {false, true}) {
    std::vector<TriangleCorners> triangles{{0, 1, 2}, {3, 4, 5}};
    if (turned) std::swap(triangles[0], triangles[1]);
    const std::vector<double> shares{turned ? 1.0 : 0.0, turned ? 0.0 : 1.0};  // the nearer one is dark
    const Camera camera({0, -1, 0});
    Painter painter(camera, {.scale = 1});
    painter.add_surface({.points = points,
                         .triangles = triangles,
                         .shares = shares,
                         .map = sequential_colours(),
                         .smooth = false},
                        1e6);
    const std::string svg = painter.svg();
    const std::size_t first = svg.find("color=\"#") + 7, last = svg.rfind("color=\"#") + 7;
    EXPECT_GT(oklab_of(svg.substr(first, 7)).lightness, oklab_of(svg.substr(last, 7)).lightness);
  }
}

TEST(Bodies, StandBesideEachOtherOnOneScaleOfColours) {
  BodyView a = cube(), b = cube();
  a.title = "A & B";
  a.values.assign(a.points.size(), 1);
  b.values.assign(b.triangles.size(), 3);  // of triangles
  const std::string svg = bodies_svg({.title = "two <cubes>",
                                      .caption = "made of nothing",
                                      .colours = {.quantity = "displacement [mm]"},
                                      .columns = 2,
                                      .views = {a, b}});
  EXPECT_NE(svg.find("A &amp; B"), std::string::npos);
  EXPECT_NE(svg.find("two &lt;cubes>"), std::string::npos);
  EXPECT_EQ(count(svg, "displacement [mm]"), 1U);
  EXPECT_EQ(count(svg, "linearGradient id"), 1U);
  EXPECT_NE(svg.find(">1<"), std::string::npos);
  EXPECT_NE(svg.find(">3<"), std::string::npos);
  EXPECT_NE(svg.find("made of nothing"), std::string::npos);
  EXPECT_EQ(svg, bodies_svg({.title = "two <cubes>",
                             .caption = "made of nothing",
                             .colours = {.quantity = "displacement [mm]"},
                             .columns = 2,
                             .views = {a, b}}));
}

TEST(Bodies, SayWhenValuesGoBeyondTheScale) {
  BodyView view = cube();
  view.values = {0, 1, 2, 3, 4, 5, 6, 70};
  const std::string svg =
      bodies_svg({.colours = {.quantity = "energy density [J/m³]", .range = Range{0, 10}}, .views = {view}});
  EXPECT_NE(svg.find(">≥ 10<"), std::string::npos);
  EXPECT_EQ(svg.find("≤"), std::string::npos);
}

TEST(Bodies, ShowTheShapeAtRestTheSupportsTheForceAndTheTool) {
  BodyView view = cube();
  const std::string bare = bodies_svg({.views = {view}});
  EXPECT_EQ(bare.find("at rest"), std::string::npos);
  EXPECT_EQ(bare.find("held"), std::string::npos);
  view.rest = view.points;
  for (SpacePoint& p : view.points) p[2] *= 0.8;
  view.held = {0, 1, 2, 3};
  view.arrows = {{{0.05, 0.05, 0.08}, {0, 0, -1}, false}};
  const std::string svg = bodies_svg({.views = {view}});
  EXPECT_NE(svg.find("mask=\"url(#rest0m)\""), std::string::npos);
  EXPECT_EQ(count(svg, "r=\"2.4\""), 3U) << "one of the four is behind";
  EXPECT_NE(svg.find(">force<"), std::string::npos);
}

TEST(Painters, ShowATouchingBallBeforeWhatItTouchesAndBehindWhatIsBeforeIt) {
  const Camera camera({0, -1, 0});
  Painter painter(camera, {.scale = 1000});
  painter.add_tool({0, 0, 0}, 0.02, {0, 0, 0.1});
  const std::size_t alone = count(painter.svg(), "z");
  EXPECT_GT(alone, 500U);
  // A wall through its middle hides half of it, whose pieces are painted before those of the wall.
  const std::vector<SpacePoint> points{{-0.1, 0, -0.1}, {0.1, 0, -0.1}, {0, 0, 0.1}};
  const std::vector<TriangleCorners> triangles{{0, 1, 2}};
  const std::vector<double> dark{1};
  painter.add_surface({.points = points,
                       .triangles = triangles,
                       .shares = dark,
                       .map = sequential_colours(),
                       .smooth = false},
                      6);
  const std::string svg = painter.svg();
  const auto lightness_at = [&](std::size_t at) { return oklab_of(svg.substr(at + 7, 7)).lightness; };
  EXPECT_LT(lightness_at(svg.find("color=")), 0.4);
  EXPECT_GT(lightness_at(svg.rfind("color=")), 0.5);
}

TEST(Bodies, OfManyTrianglesStayBelowThreeMegabytesAndSaySo) {
  const BodyView small = ball(40, 20), large = ball(500, 300);
  const std::string few = bodies_svg({.colours = {.quantity = "z [m]"}, .views = {small}});
  const std::string many = bodies_svg({.colours = {.quantity = "z [m]"}, .views = {large}});
  EXPECT_EQ(few.find("fewer triangles"), std::string::npos);
  EXPECT_NE(many.find("Drawn with fewer triangles than it has."), std::string::npos);
  EXPECT_LT(few.size(), 3'000'000U);
  EXPECT_LT(many.size(), 3'000'000U);
  EXPECT_GT(many.size(), 300'000U);
}

TEST(Bodies, RefuseWhatDoesNotFit) {
  EXPECT_THROW(bodies_svg({}), InputError);
  BodyView view = cube();
  view.values = {1, 2, 3};
  EXPECT_THROW(bodies_svg({.views = {view}}), InputError);
  view.values.clear();
  view.rest = {{0, 0, 0}};
  EXPECT_THROW(bodies_svg({.views = {view}}), InputError);
  view.rest.clear();
  view.points[3][1] = NAN;
  EXPECT_THROW(bodies_svg({.views = {view}}), InputError);
}

}  // namespace
}  // namespace hmax
