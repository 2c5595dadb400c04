#include "plots/drawn/painter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

namespace hmax {

namespace {

SpacePoint operator+(const SpacePoint& a, const SpacePoint& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
SpacePoint operator-(const SpacePoint& a, const SpacePoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
SpacePoint operator*(double s, const SpacePoint& a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const SpacePoint& a, const SpacePoint& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
SpacePoint cross(const SpacePoint& a, const SpacePoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
SpacePoint unit(const SpacePoint& a) {
  const double length = std::sqrt(dot(a, a));
  return length > 0 ? (1 / length) * a : SpacePoint{0, 0, 1};
}

/// Twice the area of a triangle as seen, positive when it looks this way.
double facing(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

constexpr double beside_ball = 2;  // pixels of the side of a piece that may border on a ball

const OkLab grey{0.86, 0, 0.004}, metal{0.80, -0.004, -0.012};

/// A matt colour under a light from the upper left with a bright sky; a little gloss.
/// @param normal  of length 1, as the camera sees it
OkLab lit(const OkLab& colour, const SpacePoint& normal, double gloss) {
  static const SpacePoint light = unit({-0.5, 0.75, 0.8}), half = unit(light + SpacePoint{0, 0, 1});
  const double lambert = std::clamp((dot(normal, light) + 0.35) / 1.35, 0.0, 1.0);
  const double bright = 0.72 + 0.28 * lambert;
  const double shine = gloss * std::pow(std::max(0.0, dot(normal, half)), 28);
  return {std::min(1.0, bright * colour.lightness + shine), (bright - 0.5 * shine) * colour.a,
          (bright - 0.5 * shine) * colour.b};
}

/// Corner normals: the mean, weighted with area, over the triangles at the point that are not bent too far
/// from this one.
std::vector<std::array<SpacePoint, 3>> corner_normals(const std::vector<SpacePoint>& seen,
                                                      const std::vector<TriangleCorners>& triangles) {
  constexpr double least_cosine = 0.64;
  std::vector<SpacePoint> normals(triangles.size());
  std::vector<std::vector<std::int32_t>> at(seen.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    normals[t] = cross(seen[static_cast<std::size_t>(b)] - seen[static_cast<std::size_t>(a)],
                       seen[static_cast<std::size_t>(c)] - seen[static_cast<std::size_t>(a)]);
    for (const std::int32_t corner : triangles[t])
      at[static_cast<std::size_t>(corner)].push_back(static_cast<std::int32_t>(t));
  }
  std::vector<std::array<SpacePoint, 3>> corners(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const SpacePoint own = unit(normals[t]);
    for (std::size_t i = 0; i < 3; ++i) {
      SpacePoint sum{};
      for (const std::int32_t other : at[static_cast<std::size_t>(triangles[t][i])]) {
        const SpacePoint& normal = normals[static_cast<std::size_t>(other)];
        if (dot(unit(normal), own) >= least_cosine) sum = sum + normal;
      }
      corners[t][i] = unit(sum);
    }
  }
  return corners;
}

std::vector<SpacePoint> seen_by(const Camera& camera, const std::vector<SpacePoint>& points) {
  std::vector<SpacePoint> seen(points.size());
  std::ranges::transform(points, seen.begin(), [&](const SpacePoint& p) { return camera.seen(p); });
  return seen;
}

template <class T>
const T& at(const std::vector<T>& values, std::int32_t i) {
  return values[static_cast<std::size_t>(i)];
}

bool looks_this_way(const std::vector<SpacePoint>& seen, const TriangleCorners& t) {
  return facing(at(seen, t[0]), at(seen, t[1]), at(seen, t[2])) > 0;
}

}  // namespace

Camera::Camera(const SpacePoint& towards) : towards_(unit(towards)) {
  const bool vertical = std::abs(towards_[2]) > 0.999;
  right_ = unit(cross(vertical ? SpacePoint{0, 1, 0} : SpacePoint{0, 0, 1}, towards_));
  up_ = cross(towards_, right_);
}

SpacePoint Camera::seen(const SpacePoint& p) const { return {dot(right_, p), dot(up_, p), dot(towards_, p)}; }

void Painter::add_face(const std::array<SpacePoint, 3>& seen, const OkLab& colour) {
  Item item{.depth = (seen[0][2] + seen[1][2] + seen[2][2]) / 3, .kind = Kind::face, .at = {}, .colour = {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [x, y] = placement_.at(seen[i]);
    item.at[i] = {static_cast<float>(x), static_cast<float>(y)};
  }
  const std::string hex = hex_of(colour);
  std::copy_n(hex.begin(), std::min(hex.size(), item.colour.size() - 1), item.colour.begin());
  items_.push_back(item);
}

void Painter::add_line(const SpacePoint& from, const SpacePoint& to, Kind kind, double size) {
  const double length =
      placement_.scale * std::hypot(to[0] - from[0], to[1] - from[1], 0.5 * (to[2] - from[2]));
  const int pieces = std::clamp(static_cast<int>(std::ceil(length / (1.5 * size))), 1, 60);
  // In front of the pieces of faces that it borders on.
  const double lift = 1.2 * size / placement_.scale;
  for (int k = 0; k < pieces; ++k) {
    const SpacePoint p = from + (double(k) / pieces) * (to - from);
    const SpacePoint q = from + (double(k + 1) / pieces) * (to - from);
    Item item{.depth = (p[2] + q[2]) / 2 + lift, .kind = kind, .at = {}, .colour = {}};
    const auto a = placement_.at(p), b = placement_.at(q);
    item.at[0] = {static_cast<float>(a[0]), static_cast<float>(a[1])};
    item.at[1] = {static_cast<float>(b[0]), static_cast<float>(b[1])};
    items_.push_back(item);
  }
}

bool Painter::near_ball(const std::array<SpacePoint, 3>& seen) const {
  return std::ranges::any_of(balls_, [&](const Ball& ball) {
    double low_x = seen[0][0], high_x = low_x, low_y = seen[0][1], high_y = low_y;
    for (const SpacePoint& p : seen) {
      low_x = std::min(low_x, p[0]);
      high_x = std::max(high_x, p[0]);
      low_y = std::min(low_y, p[1]);
      high_y = std::max(high_y, p[1]);
    }
    const double away_x = ball.seen[0] - std::clamp(ball.seen[0], low_x, high_x);
    const double away_y = ball.seen[1] - std::clamp(ball.seen[1], low_y, high_y);
    return std::hypot(away_x, away_y) < 1.05 * ball.radius;
  });
}

/// Cuts a triangle that looks this way into n^2 pieces, each of one colour.
void Painter::add_pieces(const PaintedSurface& surface, std::size_t t, const std::array<SpacePoint, 3>& x,
                         const std::array<SpacePoint, 3>& normals, int n) {
  const TriangleCorners& corners = surface.triangles[t];
  const auto share_at = [&](double u, double v, double w) -> double {
    if (surface.shares.empty()) return NAN;
    if (!surface.smooth) return surface.shares[t];
    return u * at(surface.shares, corners[0]) + v * at(surface.shares, corners[1]) +
           w * at(surface.shares, corners[2]);
  };
  const auto piece = [&](std::array<int, 2> p, std::array<int, 2> q, std::array<int, 2> r) {
    const auto point = [&](std::array<int, 2> k) {
      const double v = double(k[0]) / n, w = double(k[1]) / n;
      return (1 - v - w) * x[0] + v * x[1] + w * x[2];
    };
    const double v = (p[0] + q[0] + r[0]) / (3.0 * n), w = (p[1] + q[1] + r[1]) / (3.0 * n), u = 1 - v - w;
    const SpacePoint normal = unit(u * normals[0] + v * normals[1] + w * normals[2]);
    const double share = share_at(u, v, w);
    add_face({point(p), point(q), point(r)},
             lit(std::isnan(share) ? grey : surface.map.at(share), normal, 0.07));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      piece({i, j}, {i + 1, j}, {i, j + 1});
      if (i + j + 1 < n) piece({i + 1, j}, {i + 1, j + 1}, {i, j + 1});
    }
}

/// The outline, between a triangle that looks this way and one that does not, and if `wired` the other edges
/// too.
void Painter::add_sides(std::vector<Side> sides, const std::vector<SpacePoint>& seen, bool wired,
                        double size) {
  std::ranges::sort(sides);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    int front = 0, back = 0;
    for (; end < sides.size() && sides[end].a == sides[i].a && sides[end].b == sides[i].b; ++end)
      ++(sides[end].front ? front : back);
    const SpacePoint &p = at(seen, sides[i].a), &q = at(seen, sides[i].b);
    if (front == 1 && back == 1)
      add_line(p, q, Kind::outline, size);
    else if (front > 1 && wired)
      add_line(p, q, Kind::edge, size);
    i = end;
  }
}

void Painter::add_surface(const PaintedSurface& surface, double size) {
  const std::vector<SpacePoint> seen = seen_by(camera_, surface.points);
  const auto normals = corner_normals(seen, surface.triangles);
  std::vector<Side> sides;
  double drawn_length = 0, drawn = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const TriangleCorners& corners = surface.triangles[t];
    const std::array<SpacePoint, 3> x{at(seen, corners[0]), at(seen, corners[1]), at(seen, corners[2])};
    const bool front = facing(x[0], x[1], x[2]) > 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int32_t a = corners[i], b = corners[(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), front});
    }
    if (!front) continue;
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const SpacePoint side = x[(i + 1) % 3] - x[i];
      longest = std::max(longest, placement_.scale * std::hypot(side[0], side[1]));
    }
    drawn_length += longest;
    ++drawn;
    const double fine = near_ball(x) ? std::min(size, beside_ball) : size;
    add_pieces(surface, t, x, normals[t], std::clamp(static_cast<int>(std::lround(longest / fine)), 1, 90));
  }
  constexpr double told_apart = 13;  // pixels
  add_sides(std::move(sides), seen, drawn > 0 && drawn_length / drawn > told_apart, size);
}

/// Quadrilaterals between rings of points, which go round an axis, in metal.
void Painter::add_round(const std::vector<std::vector<SpacePoint>>& rings, const SpacePoint& centre,
                        const SpacePoint& axis) {
  for (std::size_t k = 0; k + 1 < rings.size(); ++k)
    for (std::size_t i = 0; i < rings[k].size(); ++i) {
      const std::size_t j = (i + 1) % rings[k].size();
      const SpacePoint a = camera_.seen(rings[k][i]), b = camera_.seen(rings[k][j]),
                       c = camera_.seen(rings[k + 1][j]), d = camera_.seen(rings[k + 1][i]);
      // Away from the axis, or from the centre where there is none.
      const SpacePoint middle = 0.25 * (rings[k][i] + rings[k][j] + rings[k + 1][i] + rings[k + 1][j]);
      const SpacePoint out = middle - centre;
      const SpacePoint normal = camera_.seen(unit(out - dot(out, axis) * axis));
      const OkLab colour = lit(metal, normal, 0.22);
      for (const auto& face : {std::array{a, b, c}, std::array{a, c, d}})
        if (facing(face[0], face[1], face[2]) > 0) add_face(face, colour);
    }
}

void Painter::add_tool(const SpacePoint& centre, double radius, const SpacePoint& shaft) {
  balls_.push_back({camera_.seen(centre), radius});
  const double length = std::sqrt(dot(shaft, shaft));
  const SpacePoint axis = unit(shaft);
  const SpacePoint side =
      unit(cross(axis, std::abs(axis[2]) < 0.9 ? SpacePoint{0, 0, 1} : SpacePoint{1, 0, 0}));
  const SpacePoint other = cross(axis, side);
  const auto ring = [&](double height, double r, int around) {
    std::vector<SpacePoint> points;
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      points.push_back(centre + height * axis + r * std::cos(angle) * side + r * std::sin(angle) * other);
    }
    return points;
  };
  std::vector<std::vector<SpacePoint>> ball, bar;
  // Small pieces, since a surface may cut the ball anywhere.
  constexpr int along = 36, around = 56;
  for (int k = 0; k <= along; ++k) {
    const double angle = std::numbers::pi * (double(k) / along - 0.5);
    ball.push_back(ring(radius * std::sin(angle), radius * std::cos(angle), around));
  }
  constexpr int pieces = 14, sides = 20;
  for (int k = 0; k <= pieces; ++k)
    bar.push_back(ring(std::lerp(0.9 * radius, length, double(k) / pieces), 0.36 * radius, sides));
  bar.push_back(ring(length, 0, sides));
  add_round(ball, centre, {0, 0, 0});
  if (length > radius) add_round(bar, centre, axis);
}

void Painter::add_dots(const std::vector<SpacePoint>& points, const std::vector<TriangleCorners>& triangles,
                       const std::vector<std::int32_t>& which) {
  const std::vector<SpacePoint> seen = seen_by(camera_, points);
  std::vector<bool> visible(points.size(), false);
  for (const TriangleCorners& t : triangles)
    if (looks_this_way(seen, t))
      for (const std::int32_t corner : t) visible[static_cast<std::size_t>(corner)] = true;
  for (const std::int32_t i : which) {
    if (!visible[static_cast<std::size_t>(i)]) continue;
    const SpacePoint& p = at(seen, i);
    const auto [x, y] = placement_.at(p);
    Item item{.depth = p[2] + 16 / placement_.scale, .kind = Kind::dot, .at = {}, .colour = {}};
    item.at[0] = {static_cast<float>(x), static_cast<float>(y)};
    items_.push_back(item);
  }
}

std::string Painter::svg() const {
  std::vector<std::size_t> order(items_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return items_[i].depth; });
  std::string text;
  text.reserve(64 * items_.size());
  std::optional<Kind> open;  // what the path that is being written is of
  std::array<char, 8> colour{};
  for (const std::size_t i : order) {
    const Item& item = items_[i];
    const auto& p = item.at;
    const bool continues = open == item.kind && (item.kind != Kind::face || item.colour == colour);
    if (open && !continues) {
      text += "\"/>\n";
      open.reset();
    }
    if (item.kind == Kind::dot) {
      text += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.4\"/>\n", p[0][0], p[0][1]);
      continue;
    }
    if (!open) {
      if (item.kind == Kind::face)
        text += fmt::format("<path color=\"{}\" d=\"", item.colour.data());
      else
        text += item.kind == Kind::edge ? "<path class=\"e\" d=\"" : "<path class=\"o\" d=\"";
      open = item.kind;
      colour = item.colour;
    }
    text +=
        fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}", p[0][0], p[0][1], p[1][0] - p[0][0], p[1][1] - p[0][1]);
    if (item.kind == Kind::face) text += fmt::format(" {:.1f} {:.1f}z", p[2][0] - p[1][0], p[2][1] - p[1][1]);
  }
  if (open) text += "\"/>\n";
  return text;
}

// The stroke of a face covers the seam that would shine through between two of them.
const char* const painter_style =
    ".body{stroke-linejoin:round;stroke-linecap:round;stroke-width:.7}"
    ".body path{fill:currentColor;stroke:currentColor}"
    ".body path.e{fill:none;stroke:#000000;stroke-opacity:.2;stroke-width:.6}"
    ".body path.o{fill:none;stroke:#303030;stroke-width:1}"
    ".body circle{fill:#202020;stroke:#ffffff;stroke-width:.8}";

double painted_area(const std::vector<SpacePoint>& points, const std::vector<TriangleCorners>& triangles,
                    const Camera& camera, double scale) {
  const std::vector<SpacePoint> seen = seen_by(camera, points);
  double area = 0;
  for (const TriangleCorners& t : triangles)
    area += std::max(0.0, facing(at(seen, t[0]), at(seen, t[1]), at(seen, t[2])) / 2);
  return area * scale * scale;
}

std::string shape_path(const std::vector<SpacePoint>& points, const std::vector<TriangleCorners>& triangles,
                       const Camera& camera, const Placement& placement) {
  const std::vector<SpacePoint> seen = seen_by(camera, points);
  std::string text;
  for (const TriangleCorners& t : triangles) {
    if (!looks_this_way(seen, t)) continue;
    const auto p = placement.at(at(seen, t[0])), q = placement.at(at(seen, t[1])),
               r = placement.at(at(seen, t[2]));
    text += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f} {:.1f} {:.1f}z", p[0], p[1], q[0], q[1], r[0], r[1]);
  }
  return text;
}

}  // namespace hmax
