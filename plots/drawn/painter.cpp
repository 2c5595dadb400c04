#include "plots/drawn/painter.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "plots/drawn/colour_map.hpp"

namespace hmax {

namespace {

SpacePoint operator-(const SpacePoint& a, const SpacePoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const SpacePoint& a, const SpacePoint& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
SpacePoint cross(const SpacePoint& a, const SpacePoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
SpacePoint unit(const SpacePoint& a) {
  const double length = std::sqrt(dot(a, a));
  return length > 0 ? SpacePoint{a[0] / length, a[1] / length, a[2] / length} : SpacePoint{0, 0, 1};
}

template <class T>
const T& at(const std::vector<T>& values, std::int32_t i) {
  return values[static_cast<std::size_t>(i)];
}

/// Twice the area times the normal of length 1. The page counts down, which turns triangles round.
SpacePoint normal_of(const Surface& seen, const TriangleCorners& t) {
  const SpacePoint& a = at(seen.points, t[0]);
  return cross(at(seen.points, t[2]) - a, at(seen.points, t[1]) - a);
}

double area_of(const Surface& seen) {
  double area = 0;
  for (const TriangleCorners& t : seen.triangles) area += normal_of(seen, t)[2] / 2;
  return area;
}

/// A matt surface under a light from the upper left with a bright sky: from 1 down to three quarters.
double brightness_of(const SpacePoint& normal) {
  static const SpacePoint light = unit({-0.5, -0.75, 0.8});
  return 0.75 + 0.25 * std::clamp((dot(unit(normal), light) + 0.35) / 1.35, 0.0, 1.0);
}

/// All points of a cell of a grid as one.
Surface joined(const Surface& seen, double cell) {
  std::map<std::array<std::int64_t, 3>, std::int32_t> cells;
  std::vector<std::int32_t> now(seen.points.size(), -1);
  std::vector<double> members;
  const bool smooth = seen.smooth && !seen.shares.empty();
  Surface fewer{.smooth = seen.smooth};
  const auto add = [&](std::int32_t i) {
    const SpacePoint& p = at(seen.points, i);
    const std::array key{std::llround(p[0] / cell), std::llround(p[1] / cell), std::llround(p[2] / cell)};
    const auto [found, fresh] = cells.try_emplace({key[0], key[1], key[2]}, members.size());
    now[static_cast<std::size_t>(i)] = found->second;
    if (fresh) {
      members.push_back(0);
      fewer.points.push_back({});
      if (smooth) fewer.shares.push_back(0);
    }
    const auto c = static_cast<std::size_t>(found->second);
    const double part = 1 / ++members[c];
    for (std::size_t k = 0; k < 3; ++k) fewer.points[c][k] += part * (p[k] - fewer.points[c][k]);
    if (smooth) fewer.shares[c] += part * (at(seen.shares, i) - fewer.shares[c]);
  };
  for (const TriangleCorners& t : seen.triangles)
    for (const std::int32_t i : t)
      if (at(now, i) < 0) add(i);
  for (std::size_t t = 0; t < seen.triangles.size(); ++t) {
    const auto& [a, b, c] = seen.triangles[t];
    const TriangleCorners corners{at(now, a), at(now, b), at(now, c)};
    // What was turned over by joining lies under its neighbours.
    if (!(normal_of(fewer, corners)[2] > 0)) continue;
    fewer.triangles.push_back(corners);
    if (!smooth && !seen.shares.empty()) fewer.shares.push_back(seen.shares[t]);
  }
  return fewer;
}

/// A gradient for a value that is linear over the triangle.
std::string gradient(const std::string& id, const std::array<SpacePoint, 3>& p,
                     const std::array<double, 3>& share, double bright) {
  const auto along = [&](std::size_t k) { return std::array{p[k][0] - p[0][0], p[k][1] - p[0][1]}; };
  const auto [ux, uy] = along(1);
  const auto [vx, vy] = along(2);
  const double det = ux * vy - uy * vx, u = share[1] - share[0], v = share[2] - share[0];
  const double gx = (u * vy - v * uy) / det, gy = (v * ux - u * vx) / det;
  const auto [least, most] = std::ranges::minmax_element(share);
  const double low = *least, high = *most, way = (high - low) / (gx * gx + gy * gy);
  const SpacePoint& from = p[static_cast<std::size_t>(least - share.begin())];
  std::string stops;
  const auto stop = [&](double value) {
    stops += fmt::format("<stop offset=\"{:.3f}\" stop-color=\"{}\"/>", (value - low) / (high - low),
                         hex_of(colour_at(value), bright));
  };
  stop(low);
  constexpr double intervals = colour_stops.size() - 1;
  for (std::size_t k = 0; k < colour_stops.size(); ++k)
    if (const double value = static_cast<double>(k) / intervals; low < value && value < high) stop(value);
  stop(high);
  return fmt::format(
      "<linearGradient id=\"{}\" gradientUnits=\"userSpaceOnUse\" x1=\"{:.1f}\" y1=\"{:.1f}\" "
      "x2=\"{:.1f}\" y2=\"{:.1f}\">{}</linearGradient>\n",
      id, from[0], from[1], from[0] + way * gx, from[1] + way * gy, stops);
}

std::string path_of(const std::array<SpacePoint, 3>& p) {
  return fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f} {:.1f} {:.1f}z", p[0][0], p[0][1], p[1][0], p[1][1],
                     p[2][0], p[2][1]);
}

std::array<SpacePoint, 3> corners_of(const Surface& seen, const TriangleCorners& t) {
  return {at(seen.points, t[0]), at(seen.points, t[1]), at(seen.points, t[2])};
}

}  // namespace

Camera::Camera(const SpacePoint& towards) : towards_(unit(towards)) {
  const bool vertical = std::abs(towards_[2]) > 0.999;
  right_ = unit(cross(vertical ? SpacePoint{0, 1, 0} : SpacePoint{0, 0, 1}, towards_));
  up_ = cross(towards_, right_);
}

SpacePoint Camera::seen(const SpacePoint& p) const {
  return {x + scale * dot(right_, p), y - scale * dot(up_, p), scale * dot(towards_, p)};
}

Surface seen_by(const Camera& camera, const Surface& surface) {
  const bool of_triangles = !surface.smooth && !surface.shares.empty();
  Surface seen{.smooth = surface.smooth};
  if (!of_triangles) seen.shares = surface.shares;
  for (const SpacePoint& p : surface.points) seen.points.push_back(camera.seen(p));
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!(normal_of(seen, surface.triangles[t])[2] > 0)) continue;
    seen.triangles.push_back(surface.triangles[t]);
    if (of_triangles) seen.shares.push_back(surface.shares[t]);
  }
  return seen;
}

Surface simplified(const Surface& seen, std::size_t most) {
  Surface fewer = seen;
  for (double cell = std::sqrt(2 * area_of(seen) / static_cast<double>(most)); fewer.triangles.size() > most;
       cell *= 1.25)
    fewer = joined(seen, cell);
  return fewer;
}

std::string shape_path(const Surface& seen) {
  std::string text;
  for (const TriangleCorners& t : seen.triangles) text += path_of(corners_of(seen, t));
  return text;
}

bool edges_told_apart(const Surface& seen) {
  constexpr double least = 60;  // pixels of area, on average
  return area_of(seen) > least * static_cast<double>(seen.triangles.size());
}

std::string painted(const Surface& seen, const std::string& id, bool edges) {
  constexpr double one_colour = 0.02;  // of the colours within a triangle
  std::vector<std::size_t> order(seen.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t t) {
    const auto& [p, q, r] = corners_of(seen, seen.triangles[t]);
    return p[2] + q[2] + r[2];
  });
  // A stroke in the colour of its face covers the seam that would shine through.
  std::string text = fmt::format("<g class=\"{}\">\n", edges ? "body edges" : "body");
  for (const std::size_t t : order) {
    const TriangleCorners& corners = seen.triangles[t];
    const auto p = corners_of(seen, corners);
    const double bright = brightness_of(normal_of(seen, corners));
    std::array<double, 3> share{NAN, NAN, NAN};
    for (std::size_t k = 0; k < 3 && !seen.shares.empty(); ++k)
      share[k] = seen.smooth ? at(seen.shares, corners[k]) : seen.shares[t];
    const double mean = (share[0] + share[1] + share[2]) / 3;
    std::string fill = hex_of(std::isnan(mean) ? Rgb{208, 208, 207} : colour_at(mean), bright);
    if (std::isfinite(mean) && std::ranges::max(share) - std::ranges::min(share) > one_colour) {
      const std::string name = fmt::format("{}g{}", id, t);
      text += gradient(name, p, share, bright);
      fill = fmt::format("url(#{})", name);
    }
    text += fmt::format("<path fill=\"{0}\"{1} d=\"{2}\"/>\n", fill,
                        edges ? "" : fmt::format(" stroke=\"{}\"", fill), path_of(p));
  }
  return text + "</g>\n";
}

}  // namespace hmax
