/// Bodies that move, made up for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <vector>

#include "plots/pages/body_scene.hpp"

namespace hmax {

/// The surface of a bar of 0.3 m x 0.06 m x 0.06 m along x: `n` cells in its width, five times as many in its
/// length.
inline BodyScene made_bar(int n) {
  BodyScene bar;
  std::map<std::array<int, 3>, std::int32_t> known;
  const auto point = [&](const std::array<int, 3>& cell) {
    const auto [at, is_new] = known.try_emplace(cell, static_cast<std::int32_t>(bar.points.size()));
    if (is_new) bar.points.push_back({0.06 * cell[0] / n, 0.06 * cell[1] / n, 0.06 * cell[2] / n});
    return at->second;
  };
  const std::array<int, 3> cells{5 * n, n, n};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, cells[axis]}) {
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i < cells[u]; ++i)
        for (int j = 0; j < cells[v]; ++j) {
          const auto corner = [&](int a, int b) {
            std::array<int, 3> cell{};
            cell[axis] = side;
            cell[u] = i + a;
            cell[v] = j + b;
            return point(cell);
          };
          const std::int32_t p = corner(0, 0), q = corner(1, 0), r = corner(1, 1), s = corner(0, 1);
          if (side == 0) bar.triangles.insert(bar.triangles.end(), {{p, r, q}, {p, s, r}});
          if (side != 0) bar.triangles.insert(bar.triangles.end(), {{p, q, r}, {p, r, s}});
        }
    }
  for (std::size_t i = 0; i < bar.points.size(); ++i)
    if (bar.points[i][0] == 0) bar.held.push_back(static_cast<std::int32_t>(i));
  return bar;
}

/// A shape that bends the bar upwards, or sideways.
inline std::vector<SpacePoint> made_shape(const std::vector<SpacePoint>& points, double waves,
                                          std::size_t axis) {
  std::vector<SpacePoint> shape;
  for (const SpacePoint& p : points) {
    const double angle = waves * std::numbers::pi * p[0] / 0.3,
                 slope = std::sin(angle) * waves * std::numbers::pi / 0.3;
    SpacePoint u{-slope * (p[axis] - 0.03), 0, 0};
    u[axis] = 1 - std::cos(angle);
    shape.push_back(u);
  }
  return shape;
}

/// The bar held at one end as it swings down and up, with its energy density and two modes. Its last point is
/// inside, a corner of the element of the second mode.
inline BodyScene made_scene(int n, int frames) {
  BodyScene scene = made_bar(n);
  scene.title = "A bar under gravity";
  scene.points.push_back({0.06, 0.03, 0.03});
  const auto inside = static_cast<std::int32_t>(scene.points.size() - 1);
  scene.caption = "fem_neo_hookean, 3 kPa, dormand_prince_54 with an error of 1 %.";
  const std::vector<SpacePoint> bent = made_shape(scene.points, 0.5, 2);
  for (int k = 0; k < frames; ++k) {
    const double t = frames > 1 ? 1.2 * k / (frames - 1) : 0;
    const double down = -0.02 * (1 - std::cos(11 * t) * std::exp(-1.2 * t));
    scene.motion.t.push_back(t);
    auto& moved = scene.motion.displacements.emplace_back(bent);
    auto& energy = scene.motion.energy_density.emplace_back();
    for (std::size_t i = 0; i < bent.size(); ++i) {
      for (double& x : moved[i]) x *= down;
      energy.push_back(
          4e6 * std::pow(down * (scene.points[i][2] - 0.03) / 0.03 * (1 - scene.points[i][0] / 0.3), 2));
    }
  }
  scene.modes = {{.words = "slowest mode: it takes longest to come to rest",
                  .frequency = 1.751,
                  .shape = bent,
                  .owner_words = ""},
                 {.words = "fastest mode: it limits explicit steps",
                  .frequency = 812.4,
                  .shape = made_shape(scene.points, 3, 1),
                  .owner = {scene.triangles[9][0], scene.triangles[9][1], scene.triangles[9][2], inside},
                  .owner_words = "tetrahedron 12 has 35 % of its energy"}};
  return scene;
}

/// A page with `figure`, with variables of style and a theme as the pages of hmax have them.
inline std::string made_page(const std::string& figure, std::string_view style, std::string_view script) {
  const std::string dark =
      "color-scheme:dark;--page:#15181b;--ink:#ececec;--faint:#b0b4b8;--line:#3f464c;--soft:#1f2428;--link:#7cc4f2}\n";
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\">\n<title>t</title>\n<style>\n"
         ":root{--page:#fff;--ink:#1c1c1c;--faint:#595959;--line:#d0d0d0;--soft:#f4f5f6;--link:#005a8f}\n"
         "@media (prefers-color-scheme:dark){:root:not([data-theme=light]){" +
         dark + "}\n:root[data-theme=dark]{" + dark +
         "*{box-sizing:border-box}body{margin:0 auto;max-width:1180px;padding:1rem;background:var(--page);color:var(--ink);"
         "font:16px/1.5 sans-serif}\n" +
         std::string(style) + "</style>\n</head>\n<body>\n<main>\n" + figure + "</main>\n<script>\n" +
         std::string(script) + "</script>\n</body>\n</html>\n";
}

}  // namespace hmax
