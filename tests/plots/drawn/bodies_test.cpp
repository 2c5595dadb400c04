#include "plots/drawn/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.hpp"

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

/// The numbers of a text from a place on.
std::vector<double> numbers_from(const std::string& text, std::size_t at, std::size_t count) {
  std::vector<double> found;
  const char* next = text.c_str() + at;
  while (found.size() < count) {
    next += std::strcspn(next, "-.0123456789");
    char* end = nullptr;
    found.push_back(std::strtod(next, &end));
    next = end;
  }
  return found;
}

/// What the faces of a body take of the page [pixels].
struct OnPage {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9, area = 0, longest_side = 0;
  std::size_t faces = 0;
};
std::vector<OnPage> bodies_of(const std::string& svg) {
  std::vector<OnPage> bodies;
  const std::string group = "<g class=\"body\">";
  for (std::size_t at = svg.find(group); at != std::string::npos; at = svg.find(group, at + 1)) {
    OnPage& body = bodies.emplace_back();
    const std::string faces = svg.substr(at, svg.find("</g>", at) - at);
    for (std::size_t m = faces.find('M'); m != std::string::npos; m = faces.find('M', m + 1)) {
      if (faces.find('z', m) > faces.find('M', m + 1)) continue;  // a line
      const std::vector<double> n = numbers_from(faces, m, 6);
      ++body.faces;
      body.longest_side = std::max({body.longest_side, std::hypot(n[2], n[3]), std::hypot(n[4], n[5])});
      body.area += std::abs(n[2] * n[5] - n[3] * n[4]) / 2;
      for (const double x : {n[0], n[0] + n[2], n[0] + n[2] + n[4]}) {
        body.left = std::min(body.left, x);
        body.right = std::max(body.right, x);
      }
      for (const double y : {n[1], n[1] + n[3], n[1] + n[3] + n[5]}) {
        body.top = std::min(body.top, y);
        body.bottom = std::max(body.bottom, y);
      }
    }
  }
  return bodies;
}

BodyView box(double across, double up) {
  BodyView view = cube();
  for (SpacePoint& p : view.points) p = {10 * across * p[0], p[1], 10 * up * p[2]};
  return view;
}
const SpacePoint front{0, -1, 0};

TEST(Bodies, FillTheirColumnInTheirProportions) {
  for (const int columns : {1, 2}) {
    // Pages of 900 pixels with margins of 16 and gaps of 14.
    const double column = (900 - 2 * 16 + 14) / columns, left_of_second = columns == 1 ? 16 : 16 + column;
    const auto wide =
        bodies_of(bodies_svg({.towards = front, .columns = columns, .views = {box(1, 0.1), box(0.5, 0.1)}}));
    ASSERT_EQ(wide.size(), 2U);
    const double length = column - 14 - 8;
    EXPECT_NEAR(wide[0].left, 16 + 4, 0.2);
    EXPECT_NEAR(wide[0].right - wide[0].left, length, 0.2);
    EXPECT_NEAR(wide[0].bottom - wide[0].top, length / 10, 0.2);
    EXPECT_NEAR(wide[1].right - wide[1].left, length / 2, 0.2) << "one scale for both";
    EXPECT_NEAR(wide[1].left, left_of_second + 4 + length / 4, 0.2) << "in the middle of its column";
    EXPECT_EQ(wide[1].top > wide[0].bottom, columns == 1);
    const auto high =
        bodies_of(bodies_svg({.towards = front, .columns = columns, .views = {box(0.01, 1), box(0.01, 1)}}));
    EXPECT_NEAR(high[1].bottom - high[1].top, columns == 1 ? 470 : 0.95 * column, 0.2);
  }
}

TEST(Bodies, HaveAScaleBarOfTheLengthThatItSays) {
  for (const double size : {1e-3, 0.02, 0.3, 7.0}) {
    const std::string svg = bodies_svg({.towards = front, .views = {box(size, 0.1 * size)}});
    const std::size_t bar = svg.find("v6m0 -3h"), unit = svg.find(" mm</text>");
    ASSERT_NE(unit, std::string::npos);
    const double shown = std::stod(svg.substr(svg.rfind('>', unit) + 1)) / 1000,
                 pixels = numbers_from(svg, bar, 4)[3], left = numbers_from(svg, svg.rfind('M', bar), 1)[0];
    const double across = bodies_of(svg)[0].right - bodies_of(svg)[0].left;
    EXPECT_NEAR(pixels / across, shown / size, 1e-3) << size;
    EXPECT_NEAR(left + pixels, 900 - 16 - 4, 0.2) << size;
    EXPECT_GT(pixels, 40) << size;
    EXPECT_LE(pixels, 110) << size;
  }
}

TEST(Bodies, IncludeTheirToolsOfFiveRadii) {
  BodyView view = box(0.001, 0.001);
  view.tools = {{{0, 0, 0}, 0.01, {7, 0, 0}}};
  const std::string svg = bodies_svg({.towards = front, .views = {view}});
  const OnPage page = bodies_of(svg).at(0);
  // The ball to the left, a bar of 0.36 radii that ends at five, and room for 0.4 radii more.
  const double radius = (900 - 2 * 16 - 8) / 6.4;
  EXPECT_NEAR(page.left, 16 + 4, 0.01 * radius);
  EXPECT_NEAR(page.right - page.left, 6 * radius, 0.01 * radius);
  EXPECT_NEAR(page.bottom - page.top, 2 * radius, 0.01 * radius);
  view.tools[0].shaft = {0.001, 0, 0};
  EXPECT_EQ(bodies_svg({.towards = front, .views = {view}}), svg) << "of any length";
  // Leaning: four fifths of it are seen from the front, three fifths from above.
  view.tools[0].shaft = {0, 3, 4};
  for (SpacePoint& point : view.points) point[1] /= 100;  // inside of the ball
  for (const bool above : {false, true}) {
    const SpacePoint towards{0, above ? 0.0 : -1.0, above ? 1.0 : 0.0};
    const OnPage leaning = bodies_of(bodies_svg({.towards = towards, .views = {view}})).at(0);
    const double seen = above ? 0.6 : 0.8, high = 470 / (5 * seen + 1.4);
    EXPECT_NEAR(leaning.bottom - leaning.top, (5 * seen + 0.36 * (1.4 - seen) + 1) * high, 0.01 * high);
  }
}

TEST(Bodies, ShowForcesAsArrowsAlongThem) {
  const auto picture = [](const SpacePoint& direction, bool leaves = false) {
    BodyView view = box(1, 0.1);
    view.arrows = {{{0.5, 0, 0.05}, direction, leaves}};
    return bodies_svg({.towards = front, .views = {view}});
  };
  EXPECT_EQ(picture({1, 0, -1}), picture({70, 0, -70}));
  const OnPage body = bodies_of(picture({1, 0, -1})).at(0);
  const double x = (body.left + body.right) / 2, y = (body.top + body.bottom) / 2;
  for (const SpacePoint& direction : {SpacePoint{1, 0, -1}, {0, 0, 1}, {-3, 4, 0}, {-1, 20, 0}})
    for (const bool leaves : {false, true}) {
      const double length = std::hypot(direction[0], direction[1], direction[2]),
                   across = std::hypot(direction[0], direction[2]);
      const double dx = direction[0] / across, dy = -direction[2] / across;
      const std::string svg = picture(direction, leaves);
      const std::size_t shaft = svg.find("<path stroke=\"#ffffff\" stroke-width=\"5\" d=\"M"),
                        head = svg.find("stroke-width=\".8\" d=\"M", shaft);
      if (direction[1] > 10) {
        EXPECT_EQ(shaft, std::string::npos) << "away from the eye";
        continue;
      }
      const auto line = numbers_from(svg, svg.find('M', shaft), 4),
                 tip = numbers_from(svg, svg.find('M', head), 6);
      // 44 pixels, less what its length is seen shorter; the head 11 long and 0.84 of that wide.
      const double shown = 44 * std::max(0.4, across / length), from = leaves ? 0 : -shown,
                   to = leaves ? shown : 0;
      EXPECT_NEAR(line[0], x + from * dx, 0.15);
      EXPECT_NEAR(line[1], y + from * dy, 0.15);
      EXPECT_NEAR(line[2], x + (to - 8.8) * dx, 0.15);
      EXPECT_NEAR(line[3], y + (to - 8.8) * dy, 0.15);
      EXPECT_NEAR(tip[0], x + to * dx, 0.15);
      EXPECT_NEAR(tip[1], y + to * dy, 0.15);
      for (const std::size_t side : {2U, 4U}) {
        const double back_x = tip[side] - tip[0], back_y = tip[side + 1] - tip[1];
        EXPECT_NEAR(back_x * dx + back_y * dy, -11, 0.15);
        EXPECT_NEAR(back_x * dy - back_y * dx, side == 2 ? -4.62 : 4.62, 0.15);
      }
    }
}

TEST(Bodies, HaveTheTicksOfTheirColoursInProportion) {
  BodyView view = cube();
  view.values = {-1, 0, 0.5, 1, 1.5, 2, 2.5, 3};
  const auto ticks = [&](const BodyColours& colours) {
    const std::string svg = bodies_svg({.colours = colours, .views = {view}});
    std::map<double, double> found;  // place [pixels] of each number
    const std::string mark = "stroke=\"#606060\" stroke-width=\".8\" d=\"M";
    for (std::size_t at = svg.find(mark); at != std::string::npos; at = svg.find(mark, at + 1)) {
      const double x = numbers_from(svg, at + mark.size(), 1)[0];
      const std::size_t label = svg.find("</text>", at);
      const std::string text = svg.substr(svg.rfind('>', label) + 1, label - svg.rfind('>', label) - 1);
      found[std::stod(text.substr(text.find_first_of("-0123456789")))] = x;
    }
    return found;
  };
  const auto expect_even = [](const std::map<double, double>& found, double low, double high) {
    EXPECT_GE(found.size(), 3U);
    for (const auto& [value, x] : found)
      EXPECT_NEAR(x, 16 + 300 * (value - low) / (high - low), 0.06) << value;
    EXPECT_TRUE(found.contains(low) || found.begin()->first > low);
  };
  expect_even(ticks({.quantity = "z"}), -1, 3);
  expect_even(ticks({.quantity = "z", .diverging = true}), -3, 3);
  expect_even(ticks({.quantity = "z", .range = Range{0, 10}}), 0, 10);
}

TEST(Bodies, OfManyTrianglesKeepTheirShape) {
  // A ball of 470 pixels, whatever is joined of it.
  const OnPage page = bodies_of(bodies_svg({.views = {ball(300, 200)}})).at(0);
  const double circle = std::numbers::pi * 470 * 470 / 4;
  EXPECT_NEAR(page.right - page.left, 470, 10);
  EXPECT_NEAR(page.bottom - page.top, 470, 10);
  EXPECT_NEAR(page.area, circle, 0.05 * circle);
  // Sides of six pixels, or of twenty where they may be coarse, but for half of one that is not cut.
  const OnPage fine = bodies_of(bodies_svg({.views = {ball(20, 10)}})).at(0),
               coarse = bodies_of(bodies_svg({.views = {ball(20, 10)}, .coarse = true})).at(0);
  EXPECT_LT(fine.longest_side, 9.2);
  EXPECT_GT(coarse.longest_side, 20);
  EXPECT_LT(coarse.longest_side, 30.2);
  EXPECT_LT(coarse.faces, fine.faces / 4);
}

}  // namespace
}  // namespace hmax
