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
#include "plots/drawn/colour_map.hpp"
#include "tests/plots/text_search.hpp"

namespace hmax {
namespace {

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

/// Lightness, green to red, blue to yellow in OKLab, whose distances are those that the eye sees.
/// @source  [ottosson2020oklab]
SpacePoint oklab_of(const Rgb& colour) {
  SpacePoint x{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double c = colour[k] / 255;
    x[k] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  const auto [r, g, b] = x;
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

TEST(ColourMaps, GrowDarkerInEvenStepsToTheEye) {
  constexpr int steps = 200;
  std::vector<double> lengths;
  for (int k = 0; k < steps; ++k) {
    const SpacePoint p = oklab_of(colour_at(double(k) / steps)),
                     q = oklab_of(colour_at(double(k + 1) / steps));
    lengths.push_back(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    EXPECT_LT(q[0], p[0]) << k;
  }
  EXPECT_GT(std::ranges::min(lengths), 0.8 * std::ranges::max(lengths));
  EXPECT_EQ(hex_of(colour_at(-1)), hex_of(colour_at(0)));
  EXPECT_EQ(hex_of(colour_at(2)), "#43186b");
  EXPECT_EQ(hex_of({100, 200, 0}, 0.5), "#326400");
}

TEST(Cameras, SeeLengthsAsTheyAreAndZUp) {
  Camera camera({0.45, -1, 0.5});
  const SpacePoint p{0.3, -0.2, 0.7}, seen = camera.seen(p);
  EXPECT_NEAR(std::hypot(seen[0], seen[1], seen[2]), std::hypot(p[0], p[1], p[2]), 1e-15);
  EXPECT_NEAR(camera.seen({0, 0, 1})[0], 0, 1e-15);
  EXPECT_LT(camera.seen({0, 0, 1})[1], 0) << "up the page";
  EXPECT_GT(camera.seen({0, -1, 0})[2], 0);
  // From above, where z is no direction of the view.
  EXPECT_NEAR(Camera({0, 0, 1}).seen({0, 1, 0})[1], -1, 1e-15);
  camera.scale = 10;
  camera.x = 5;
  EXPECT_NEAR(camera.seen(p)[0], 5 + 10 * seen[0], 1e-14);
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

/// x to the right, z up, 10 pixels to a unit.
Camera from_the_front() {
  Camera camera({0, -1, 0});
  camera.scale = 10;
  return camera;
}

/// The text between the quotes of each attribute `name="..."`.
std::vector<std::string> attributes(const std::string& svg, const std::string& name) {
  std::vector<std::string> found;
  const std::string opening = " " + name + "=\"";
  for (std::size_t at = svg.find(opening); at != std::string::npos; at = svg.find(opening, at + 1)) {
    const std::size_t from = at + opening.size();
    found.push_back(svg.substr(from, svg.find('"', from) - from));
  }
  return found;
}

TEST(PaintedSurfaces, AreThreeSidesOfACubeInTheLight) {
  const BodyView view = cube();
  Camera camera({0.45, -1, 0.5});
  for (const double scale : {10.0, 1000.0}) {
    camera.scale = scale;
    const Surface seen = seen_by(camera, {view.points, view.triangles});
    const std::string svg = painted(seen, "a", edges_told_apart(seen));
    EXPECT_EQ(count(svg, "z\""), 6U) << "closed faces";
    const std::vector<std::string> fills = attributes(svg, "fill");
    const std::set<std::string> colours(fills.begin(), fills.end());
    EXPECT_EQ(colours.size(), 3U) << "each side in the light of its own";
    // Of a grey of d0, down to three quarters.
    EXPECT_GE(*colours.begin(), "#9c9c9b");
    EXPECT_LE(*colours.rbegin(), "#d0d0cf");
    EXPECT_EQ(svg.find("body edges") != std::string::npos, scale > 100) << "too small for edges";
  }
}

TEST(PaintedSurfaces, HaveGradientsWhereValuesOfPointsDiffer) {
  const Surface wide{.points = {{0, 0, 0}, {8, 0, 0}, {0, 0, 6}}, .triangles = {{0, 1, 2}}};
  const auto ends = [&](std::vector<double> shares) {
    Surface surface = wide;
    surface.shares = std::move(shares);
    const std::string svg = painted(seen_by(from_the_front(), surface), "a", false);
    EXPECT_EQ(attributes(svg, "fill").at(0), "url(#ag0)");
    return numbers_from(svg, svg.find("x1="), 8);  // x1="", y1="", x2="", y2="" and their digits
  };
  // Names have digits too: 1, x1, 1, y1, 2, x2, 2, y2.
  const auto right = ends({0, 1, 0});
  EXPECT_NEAR(right[7] - right[3], 0, 0.1);
  EXPECT_NEAR(right[5] - right[1], 80, 0.1);
  const auto up = ends({1, 1, 0.5});
  EXPECT_NEAR(up[3] - up[7], -60, 0.1) << "from the low value above to the high one below";
  // Lines of equal values are across: 80 and 60 pixels, the height of the triangle is 48.
  const auto across = ends({0, 1, 1});
  EXPECT_NEAR(std::hypot(across[5] - across[1], across[7] - across[3]), 48, 0.1);
  const auto fill_of = [&](std::vector<double> shares, bool smooth) {
    Surface surface = wide;
    surface.shares = std::move(shares);
    surface.smooth = smooth;
    return attributes(painted(seen_by(from_the_front(), surface), "a", false), "fill").at(0);
  };
  EXPECT_EQ(fill_of({0.5, 0.5, 0.5}, true), fill_of({0.5}, false));
  EXPECT_EQ(fill_of({NAN}, false), fill_of({}, true)) << "grey";
}

/// A ring whose near side hides a part of the far one.
Surface torus(int around, int along) {
  Surface ring;
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < along; ++k) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * k / along;
      const double out = 10 + 4 * std::cos(v);
      ring.points.push_back({out * std::cos(u), out * std::sin(u), 4 * std::sin(v)});
      const auto at = [&](int di, int dk) { return (i + di) % around * along + (k + dk) % along; };
      ring.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      ring.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  return ring;
}

/// What a point of the page shows of triangles: barycentric weights, all positive inside.
SpacePoint weights_at(const std::array<SpacePoint, 3>& p, double x, double y) {
  const auto area = [](double ax, double ay, double bx, double by) { return ax * by - ay * bx; };
  const double whole = area(p[1][0] - p[0][0], p[1][1] - p[0][1], p[2][0] - p[0][0], p[2][1] - p[0][1]);
  const double v = area(x - p[0][0], y - p[0][1], p[2][0] - p[0][0], p[2][1] - p[0][1]) / whole;
  const double w = area(p[1][0] - p[0][0], p[1][1] - p[0][1], x - p[0][0], y - p[0][1]) / whole;
  return {1 - v - w, v, w};
}

TEST(PaintedSurfaces, ShowWhatADepthBufferShows) {
  Camera camera({0.2, -1, 0.35});
  camera.scale = 8;
  const Surface ring = torus(40, 16), seen = seen_by(camera, ring);
  // The faces in the order of the text, found by their corners on the page.
  std::vector<std::array<SpacePoint, 3>> faces, in_text;
  for (const TriangleCorners& t : seen.triangles) {
    auto& face = faces.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) face[k] = seen.points[static_cast<std::size_t>(t[k])];
  }
  for (const std::string& d : attributes(painted(seen, "a", false), "d")) {
    const std::vector<double> n = numbers_from(d, 0, 6);
    in_text.push_back(*std::ranges::min_element(faces, {}, [&](const auto& p) {
      double away = 0;
      for (std::size_t k = 0; k < 3; ++k) away += std::hypot(p[k][0] - n[2 * k], p[k][1] - n[2 * k + 1]);
      return away;
    }));
  }
  ASSERT_EQ(in_text.size(), faces.size());
  int covered = 0, wrong = 0;
  for (double x = -112; x < 112; x += 2)
    for (double y = -80; y < 80; y += 2) {
      double nearest = -1e9, shown = -1e9;
      for (const auto& p : in_text) {
        const SpacePoint w = weights_at(p, x, y);
        if (std::ranges::min(w) < 0) continue;
        shown = w[0] * p[0][2] + w[1] * p[1][2] + w[2] * p[2][2];
        nearest = std::max(nearest, shown);
      }
      covered += nearest > -1e9;
      wrong += shown < nearest - 1;
    }
  EXPECT_GT(covered, 2000);
  EXPECT_EQ(wrong, 0);
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
  EXPECT_NE(svg.find("two &lt;cubes&gt;"), std::string::npos);
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
  EXPECT_EQ(bare.find(">at rest<"), std::string::npos);
  EXPECT_EQ(bare.find(">fixed<"), std::string::npos);
  view.rest = view.points;
  for (SpacePoint& p : view.points) p[2] *= 0.8;
  view.held = {0, 1, 2, 3};
  view.arrows = {{{0.05, 0.05, 0.08}, {0, 0, -1}, false}};
  const std::string svg = bodies_svg({.views = {view}});
  EXPECT_NE(svg.find("mask=\"url(#rest0m)\""), std::string::npos);
  EXPECT_EQ(count(svg, "r=\"2.4\""), 3U) << "one of the four is behind";
  EXPECT_NE(svg.find(">force<"), std::string::npos);
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

/// What the faces of a body take of the page [pixels].
struct OnPage {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9, area = 0;
  std::size_t faces = 0;
};
std::vector<OnPage> bodies_of(const std::string& svg) {
  std::vector<OnPage> bodies;
  const std::string group = "<g class=\"body";
  for (std::size_t at = svg.find(group); at != std::string::npos; at = svg.find(group, at + 1)) {
    OnPage& body = bodies.emplace_back();
    for (const std::string& face : attributes(svg.substr(at, svg.find("</g>", at) - at), "d")) {
      const std::vector<double> n = numbers_from(face, 0, 6);
      ++body.faces;
      body.area += std::abs((n[2] - n[0]) * (n[5] - n[1]) - (n[3] - n[1]) * (n[4] - n[0])) / 2;
      for (const std::size_t k : {0U, 2U, 4U}) {
        body.left = std::min(body.left, n[k]);
        body.right = std::max(body.right, n[k]);
        body.top = std::min(body.top, n[k + 1]);
        body.bottom = std::max(body.bottom, n[k + 1]);
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
  // The ball to the left, a bar that ends at five radii, and room for 0.4 radii more.
  const double radius = (900 - 2 * 16 - 8) / 6.4;
  const std::size_t ball = svg.find("<circle cx="), bar = svg.find("<path stroke=\"#80878e\"");
  EXPECT_NEAR(numbers_from(svg, ball, 3)[0], 16 + 4 + radius, 0.1);
  EXPECT_NEAR(numbers_from(svg, ball, 3)[2], radius, 0.1);
  const auto line = numbers_from(svg, svg.find(" d=", bar), 4);
  EXPECT_NEAR(line[2] - line[0], 4.1 * radius, 0.1);
  EXPECT_NEAR(line[3], line[1], 0.1);
  // The bar is 0.72 radii wide, the light on it 0.4.
  EXPECT_NEAR(numbers_from(svg, svg.find("width=", bar), 1)[0], 0.72 * radius, 0.1);
  const std::size_t light = svg.find("<path stroke=\"#aab1b8\"", bar);
  EXPECT_NEAR(numbers_from(svg, svg.find("width=", light), 1)[0], 0.4 * radius, 0.1);
  view.tools[0].shaft = {0.001, 0, 0};
  EXPECT_EQ(bodies_svg({.towards = front, .views = {view}}), svg) << "of any length";
}

TEST(Bodies, HideToolsThatComeFromBehind) {
  BodyView view = cube();
  view.tools = {{{0.05, 0.05, 0.1}, 0.01, {0, 0, 1}}};
  for (const bool below : {false, true}) {
    const std::string svg = bodies_svg({.towards = {0.45, -1, below ? -0.5 : 0.5}, .views = {view}});
    EXPECT_EQ(svg.find("<circle") < svg.find("<g class=\"body"), below);
  }
}

TEST(Bodies, HaveToolsBeforeTheFaceThatTheyTouch) {
  BodyView view = cube();
  // At the face towards the viewer, on a shaft that leads away from him.
  view.tools = {{{0.05, 0, 0.05}, 0.01, {0, 0.2, -1}}};
  const std::string svg = bodies_svg({.towards = {0.1, -1, 0.1}, .views = {view}});
  EXPECT_GT(svg.find("<circle"), svg.find("<g class=\"body"));
}

TEST(Bodies, HaveColoursForWhatIsSeenAlone) {
  BodyView view = cube();
  for (const SpacePoint& p : view.points) {
    const bool hidden = p[0] < 0.01 && p[1] > 0.09 && p[2] < 0.01;
    view.values.push_back(hidden ? 1000 : 100 * p[0]);
  }
  const std::string svg =
      bodies_svg({.colours = {.quantity = "z"}, .towards = {0.45, -1, 0.5}, .views = {view}});
  EXPECT_NE(svg.find(">≥ 10</text>"), std::string::npos) << "that there is more behind is told";
  EXPECT_EQ(svg.find("1000</text>"), std::string::npos);
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
      const std::size_t shaft = svg.find("<path stroke=\"#ffffff\" stroke-width=\"5\" d=\"M");
      if (direction[1] > 10) {
        EXPECT_EQ(shaft, std::string::npos) << "away from the eye";
        continue;
      }
      const auto line = numbers_from(svg, svg.find('M', shaft), 4);
      // 44 pixels, less what its length is seen shorter; the head 11 long.
      const double shown = 44 * std::max(0.4, across / length), from = leaves ? 0 : -shown,
                   to = leaves ? shown : 0;
      EXPECT_NEAR(line[0], x + from * dx, 0.15);
      EXPECT_NEAR(line[1], y + from * dy, 0.15);
      EXPECT_NEAR(line[2], x + (to - 11) * dx, 0.15);
      EXPECT_NEAR(line[3], y + (to - 11) * dy, 0.15);
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
  expect_even(ticks({.quantity = "z", .range = Range{0, 10}}), 0, 10);
}

TEST(Bodies, OfManyTrianglesKeepTheirShape) {
  // A ball of 470 pixels, whatever is joined of it.
  const OnPage page = bodies_of(bodies_svg({.views = {ball(300, 200)}})).at(0);
  const double circle = std::numbers::pi * 470 * 470 / 4;
  EXPECT_NEAR(page.right - page.left, 470, 10);
  EXPECT_NEAR(page.bottom - page.top, 470, 10);
  EXPECT_NEAR(page.area, circle, 0.05 * circle);
  // A tenth where they may be coarse.
  const OnPage coarse = bodies_of(bodies_svg({.views = {ball(300, 200)}, .coarse = true})).at(0);
  EXPECT_LT(coarse.faces, page.faces / 10);
  EXPECT_NEAR(coarse.area, circle, 0.05 * circle);
}

}  // namespace
}  // namespace hmax
