#include "problems/tissue/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "problems/mesh/at.hpp"

namespace hmax {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The largest distance of neighbouring samples [m]. A sphere rests on a triangle of samples at a distance s
/// s^2 / (6 radius) deeper than on a plane: a fiftieth of the depth here.
double spacing_for(const SphereTool& tool) {
  const double depth = tool.travel.norm();
  return std::sqrt(0.12 * tool.radius * (depth > 0 ? std::min(depth, tool.radius) : tool.radius));
}

/// A small tool on a large triangle is given no more than some ten thousand samples.
constexpr double most_divisions = 150;

}  // namespace

ToolContact::ToolContact(const Eigen::Matrix3Xd& rest, const MeshTriangles& surface, const SphereTool& tool)
    : tool_(tool), rest_(rest), gap_(std::numeric_limits<double>::infinity()) {
  const double spacing = spacing_for(tool);
  for (const auto& points : surface.colwise()) {
    const Vector3d a = rest.col(points[0]), b = rest.col(points[1]), c = rest.col(points[2]);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double n = std::clamp(std::ceil(longest / spacing), 1.0, most_divisions);
    triangles_.push_back({.points = {points[0], points[1], points[2]},
                          .divisions = static_cast<int>(n),
                          .share = (b - a).cross(c - a).norm() / (6 * n * n)});
    // The front of the tool is on a sample when |arm - s path| = radius.
    const Vector3d path = tool.travel.stableNormalized();
    visit_lattice(triangles_.back(), [&](const Vector3d& weights, double) {
      const Vector3d arm = weights[0] * a + weights[1] * b + weights[2] * c - tool.start;
      const double along = arm.dot(path), aside = (arm - along * path).norm();
      if (arm.norm() < tool.radius)
        gap_ = 0;
      else if (along > 0 && aside < tool.radius)
        gap_ = std::min(gap_, along - std::sqrt(tool.radius * tool.radius - aside * aside));
    });
  }
}

template <class Visit>
void ToolContact::visit_lattice(const Triangle& triangle, const Visit& visit) {
  const int n = triangle.divisions;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      // A sample is a corner of one small triangle, of three on a side, of six inside.
      const int sides = (i == 0) + (j == 0) + (i + j == n);
      visit(Vector3d(i, j, n - i - j) / n, (sides == 0 ? 6 : sides == 1 ? 3 : 1) * triangle.share);
    }
}

template <class Visit>
void ToolContact::visit_samples(double t, const NodeRows& x, const NodeRows* v, const Visit& visit) const {
  const SphereTool::Pose pose = tool_.pose(t);
  const bool damps = v && tool_.damping != 0;
  const Vector3d low = pose.centre.array() - tool_.radius, high = pose.centre.array() + tool_.radius;
  for (const Triangle& triangle : triangles_) {
    const TetMesh::Index a = triangle.points[0], b = triangle.points[1], c = triangle.points[2];
    const auto xa = as_vector(x[at(a)]), xb = as_vector(x[at(b)]), xc = as_vector(x[at(c)]);
    // Outside of the box around the tool, as nearly all are.
    bool near = true;
    for (int k = 0; near && k < 3; ++k)
      near = std::min({xa[k], xb[k], xc[k]}) <= high[k] && std::max({xa[k], xb[k], xc[k]}) >= low[k];
    if (!near) continue;
    SphereTool::Touch touch;
    visit_lattice(triangle, [&](const Vector3d& weights, double area) {
      const Vector3d place = weights[0] * xa + weights[1] * xb + weights[2] * xc;
      Vector3d velocity = pose.velocity;
      if (damps)
        velocity = weights[0] * as_vector((*v)[at(a)]) + weights[1] * as_vector((*v)[at(b)]) +
                   weights[2] * as_vector((*v)[at(c)]);
      if (tool_.touches(pose, place, velocity, touch)) visit(triangle, weights, area, touch);
    });
  }
}

double ToolContact::energy(double t, const NodeRows& x) const {
  double sum = 0;
  visit_samples(t, x, nullptr,
                [&](const Triangle&, const Vector3d&, double area, const SphereTool::Touch& touch) {
                  sum += area * tool_.energy(touch);
                });
  return sum;
}

void ToolContact::add_force(double t, const NodeRows& x, const NodeRows& v, NodeRows& f) const {
  visit_samples(
      t, x, &v,
      [&](const Triangle& triangle, const Vector3d& weights, double area, const SphereTool::Touch& touch) {
        const Vector3d force = area * tool_.pressure(touch);
        for (int a = 0; a < 3; ++a)
          as_vector(f[at(triangle.points[static_cast<std::size_t>(a)])]) += weights[a] * force;
      });
}

template <class Derivative>
void ToolContact::add_blocks(double t, const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                             double* values, const Derivative& derivative) const {
  // Summed over the samples of a triangle before they go to their places in the matrix.
  const Triangle* last = nullptr;
  std::array<Matrix3d, 9> sums;
  const auto write = [&] {
    if (!last) return;
    const auto slots = pattern.slots(last->points);
    for (std::size_t k = 0; k < 9; ++k) pattern.add(values, slots[k], last->points[k % 3], sums[k]);
  };
  visit_samples(
      t, x, &v,
      [&](const Triangle& triangle, const Vector3d& weights, double area, const SphereTool::Touch& touch) {
        if (&triangle != last) {
          write();
          last = &triangle;
          sums.fill(Matrix3d::Zero());
        }
        const Matrix3d block = area * derivative(touch);
        for (std::size_t k = 0; k < 9; ++k) {
          const auto a = static_cast<Eigen::Index>(k / 3), b = static_cast<Eigen::Index>(k % 3);
          sums[k] += weights[a] * weights[b] * block;
        }
      });
  write();
}

void ToolContact::add_stiffness(double t, const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                                double* values) const {
  add_blocks(t, x, v, pattern, values,
             [&](const SphereTool::Touch& touch) { return tool_.stiffness_of(touch); });
}

void ToolContact::add_damping(double t, const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                              double* values) const {
  if (tool_.damping == 0) return;
  add_blocks(t, x, v, pattern, values,
             [&](const SphereTool::Touch& touch) { return tool_.damping_of(touch); });
}

ToolContact::Reach ToolContact::reach(double t, const NodeRows& x) const {
  const Vector3d path = tool_.travel.stableNormalized();
  Reach reach{.depth = tool_.profile.value(t) * tool_.travel.norm()};
  visit_samples(
      t, x, nullptr,
      [&](const Triangle& triangle, const Vector3d& weights, double, const SphereTool::Touch& touch) {
        double along = 0;
        for (int a = 0; a < 3; ++a) {
          const Index point = triangle.points[static_cast<std::size_t>(a)];
          along += weights[a] * path.dot(as_vector(x[at(point)]) - rest_.col(point));
        }
        reach.displacement = std::max(reach.displacement, along);
        reach.penetration = std::max(reach.penetration, touch.depth);
      });
  // One that only rounding makes is none.
  if (reach.penetration < 1e-9 * tool_.radius) reach.penetration = 0;
  if (reach.penetration > 0) reach.indentation = std::max(0.0, reach.depth - gap_ - reach.penetration);
  return reach;
}

}  // namespace hmax
