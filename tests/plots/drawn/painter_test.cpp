#include "plots/drawn/painter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace hmax {
namespace {

/// x to the right, z up, 10 pixels to a unit.
const Camera camera({0, -1, 0});
constexpr Placement ten_to_one{.scale = 10};

using Points = std::vector<SpacePoint>;
using Triangles = std::vector<TriangleCorners>;

std::string painted(Painter& painter, const Points& points, const Triangles& triangles, double size,
                    const std::vector<double>& shares = {}, bool smooth = true) {
  painter.add_surface({.points = points,
                       .triangles = triangles,
                       .shares = shares,
                       .map = sequential_colours(),
                       .smooth = smooth},
                      size);
  return painter.svg();
}

/// One piece of a path, a face or a line, with its corners on the page [pixels].
struct Piece {
  std::string kind;  ///< "e", "o" or the colour of a face
  std::vector<std::array<double, 2>> corners;
};
std::vector<Piece> pieces_of(const std::string& svg) {
  std::vector<Piece> found;
  std::string kind;
  for (std::size_t at = 0; at < svg.size(); ++at) {
    if (svg.compare(at, 7, "class=\"") == 0) kind = svg.substr(at + 7, 1);
    if (svg.compare(at, 7, "color=\"") == 0) kind = svg.substr(at + 7, 7);
    if (svg[at] != 'M') continue;
    Piece piece{kind, {}};
    double x = 0, y = 0;
    const char* text = svg.c_str() + at;
    do {
      char* end = nullptr;
      x += std::strtod(text + 1, &end);
      y += std::strtod(end, &end);
      piece.corners.push_back({x, y});
      text = end;
    } while (*text == 'l' || *text == ' ');
    found.push_back(std::move(piece));
  }
  return found;
}

/// The lengths of the lines of a kind and the areas of the faces, one number for each [pixels].
struct Drawn {
  std::vector<double> areas, outlines, edges;
};
Drawn drawn(const std::string& svg) {
  Drawn found;
  for (const auto& [kind, p] : pieces_of(svg))
    if (p.size() == 3)
      found.areas.push_back(
          std::abs((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0])) /
          2);
    else
      (kind == "e" ? found.edges : found.outlines)
          .push_back(std::hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]));
  return found;
}
double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

/// A triangle of 80 x 60 pixels, of which 100 is the longest.
const Points wide{{0, 0, 0}, {8, 0, 0}, {0, 0, 6}};

TEST(PaintedSurfaces, AreCutIntoPiecesOfTheirSizeThatCoverThem) {
  for (const double size : {200.0, 50.0, 20.0, 7.0}) {
    Painter painter(camera, ten_to_one);
    const Drawn faces = drawn(painted(painter, wide, {{0, 1, 2}}, size));
    const double along = std::max(1.0, std::round(100 / size));
    EXPECT_EQ(faces.areas.size(), static_cast<std::size_t>(along * along)) << size;
    EXPECT_NEAR(sum(faces.areas), 80 * 60 / 2, 0.1 * 240 * along) << size;  // of a tenth of a pixel
    for (const double area : faces.areas) EXPECT_NEAR(area, 2400 / (along * along), 20) << size;
    EXPECT_TRUE(faces.outlines.empty());  // one triangle alone has nothing behind
  }
}

TEST(PaintedSurfaces, AreCutFinerUnderABallOnWhateverSide) {
  // Beside the box of the triangle, x from 0 to 8 and y from 0 to 6, by 1.04 and 1.06 radii of 1.
  for (const double away : {1.04, 1.06})
    for (const SpacePoint& centre : {SpacePoint{-away, 5, 3},
                                     {8 + away, 5, 3},
                                     {4, 5, -away},
                                     {4, 5, 6 + away},
                                     {8 + away / std::sqrt(2), 5, 6 + away / std::sqrt(2)}}) {
      Painter painter(camera, ten_to_one);
      painter.add_tool(centre, 1, {0, 0, 0});
      const std::size_t ball = drawn(painter.svg()).areas.size();
      const std::size_t pieces = drawn(painted(painter, wide, {{0, 1, 2}}, 50)).areas.size() - ball;
      // 100 pixels by 2 or by 50.
      EXPECT_EQ(pieces, away < 1.05 ? 2500U : 4U) << away << ": " << centre[0] << " " << centre[2];
    }
}

TEST(PaintedSurfaces, HaveTheColourOfTheShareInTheMiddleOfEachPiece) {
  const auto colour_of_all = [](double share) {
    Painter painter(camera, ten_to_one);
    const std::vector<Piece> all = pieces_of(painted(painter, wide, {{0, 1, 2}}, 1e6, {share}, false));
    EXPECT_EQ(all.size(), 1U);
    return all.at(0).kind;
  };
  Painter painter(camera, ten_to_one);
  const std::vector<Piece> pieces = pieces_of(painted(painter, wide, {{0, 1, 2}}, 20, {0, 1, 0.5}));
  ASSERT_EQ(pieces.size(), 25U);
  for (const Piece& piece : pieces) {
    double x = 0, up = 0;
    for (const auto& corner : piece.corners) {
      x += corner[0] / 3;
      up -= corner[1] / 3;
    }
    // Middles of pieces lie at fifteenths of the sides.
    EXPECT_EQ(piece.kind, colour_of_all((std::round(15 * x / 80) + std::round(15 * up / 60) / 2) / 15))
        << x << " " << up;
  }
}

/// A cube with sides of 10, each of two triangles.
Points cube_points() {
  Points points;
  for (int i = 0; i < 8; ++i) points.push_back({10.0 * (i & 1), 10.0 * (i >> 1 & 1), 10.0 * (i >> 2 & 1)});
  return points;
}
const Triangles cube_sides{{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                           {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

TEST(PaintedSurfaces, HaveTheirRimAsOutlineAndTheOthersAsEdges) {
  // Along (1, -1, 1) a cube is a regular hexagon: each of its edges is seen sqrt(2 / 3) long.
  const Camera corner({1, -1, 1});
  Painter painter(corner, ten_to_one);
  const Drawn cube = drawn(painted(painter, cube_points(), cube_sides, 30));
  const double edge = 100 * std::sqrt(2.0 / 3);
  EXPECT_NEAR(sum(cube.outlines), 6 * edge, 2);
  // Three edges to the corner in front, and the diagonals of three sides, of which one has length 100
  // sqrt(2): seen across.
  EXPECT_GT(sum(cube.edges), 3 * edge + 3 * 50);
  EXPECT_NEAR(sum(cube.areas), 3 * edge * edge * std::sqrt(3.0) / 2, 60);
  // So small that its triangles cannot be told apart.
  Painter small(corner, {.scale = 1});
  const Drawn cubelet = drawn(painted(small, cube_points(), cube_sides, 30));
  EXPECT_TRUE(cubelet.edges.empty());
  EXPECT_FALSE(cubelet.outlines.empty());
  EXPECT_NEAR(painted_area(cube_points(), cube_sides, corner, 10), 3 * edge * edge * std::sqrt(3.0) / 2,
              1e-9);
}

TEST(PaintedSurfaces, AreRoundedByTheLightWhereTheyAreBentLittle) {
  // Two triangles that meet at an angle: below 50 degrees the light goes over from one to the other.
  const auto colours = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const Points points{{0, 0, -5}, {0, 0, 5}, {-10, 0, 0}, {10 * std::cos(angle), 10 * std::sin(angle), 0}};
    Painter painter(camera, ten_to_one);
    const std::string svg = painted(painter, points, {{0, 1, 2}, {1, 0, 3}}, 10);
    std::set<std::string> found;
    for (const Piece& piece : pieces_of(svg))
      if (piece.kind[0] == '#') found.insert(piece.kind);
    return found.size();
  };
  EXPECT_EQ(colours(0), 1U);
  EXPECT_GT(colours(45), 4U);
  EXPECT_EQ(colours(55), 2U);
}

TEST(Tools, AreABallAndAShaftOfFiveRadii) {
  Painter painter(camera, ten_to_one);
  painter.add_tool({0, 0, 0}, 2, {10, 0, 0});
  double left = 1e9, right = -1e9, up = 1e9, down = -1e9;
  for (const Piece& piece : pieces_of(painter.svg()))
    for (const auto& [x, y] : piece.corners) {
      left = std::min(left, x);
      right = std::max(right, x);
      up = std::min(up, y);
      down = std::max(down, y);
    }
  EXPECT_NEAR(left, -20, 0.5);
  EXPECT_NEAR(right, 100, 0.5);
  EXPECT_NEAR(up, -20, 0.5);
  EXPECT_NEAR(down, 20, 0.5);
  // A shaft that does not leave the ball is not drawn: the half of the ball that is seen.
  Painter short_shaft(camera, ten_to_one), none(camera, ten_to_one);
  short_shaft.add_tool({0, 0, 0}, 2, {1.9, 0, 0});
  none.add_tool({0, 0, 0}, 2, {0, 0, 0});
  const double silhouette = std::numbers::pi * 20 * 20;
  EXPECT_NEAR(sum(drawn(short_shaft.svg()).areas), silhouette, 0.05 * silhouette);
  EXPECT_NEAR(sum(drawn(none.svg()).areas), silhouette, 0.05 * silhouette);
}

TEST(Dots, StandOnPointsOfFacesThatLookThisWay) {
  // A triangle that looks this way and one behind it that looks away share no point.
  const Points points{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {4, 1, 0}, {5, 1, 0}, {4, 1, 1}, {9, 0, 0}};
  Painter painter(camera, ten_to_one);
  painter.add_dots(points, {{0, 1, 2}, {3, 5, 4}}, {1, 2, 4, 6});
  EXPECT_EQ(painter.svg(),
            "<circle cx=\"10.0\" cy=\"0.0\" r=\"2.4\"/>\n<circle cx=\"0.0\" cy=\"-10.0\" r=\"2.4\"/>\n");
}

TEST(ShapePaths, AreOfTheFacesThatLookThisWay) {
  const Points points{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  EXPECT_EQ(shape_path(points, {{0, 1, 2}, {0, 2, 1}}, camera, {.scale = 10, .middle_x = 5, .middle_y = 7}),
            "M5.0 7.0L15.0 7.0 5.0 -3.0z");
}

}  // namespace
}  // namespace hmax
