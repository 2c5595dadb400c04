#include "problems/tissue/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "problems/mesh/at.hpp"

namespace hmax {
namespace {

using Eigen::Vector3d;

/// The largest distance of neighbouring samples [m]. A sphere rests on a triangle of samples at a distance s
/// s^2 / (6 radius) deeper than on a plane: a fiftieth of the depth here.
double spacing_for(const SphereTool& tool) {
  const double depth = tool.travel.norm();
  return std::sqrt(0.12 * tool.radius * (depth > 0 ? std::min(depth, tool.radius) : tool.radius));
}

/// A small tool on a large triangle is given no more than some ten thousand samples.
constexpr double most_divisions = 150;

/// Component i of the row of corner a of a triangle, for visit_touches().
auto corners_of(const ToolContact::Triangle& triangle, const NodeRows& rows) {
  return [&triangle, &rows](int a, int i) {
    return as_vector(rows[at(triangle.points[static_cast<std::size_t>(a)])])[i];
  };
}

}  // namespace

ToolContact::ToolContact(const Eigen::Matrix3Xd& rest, const MeshTriangles& surface, const SphereTool& tool)
    : tool_(tool), rest_(rest), gap_(std::numeric_limits<double>::infinity()) {
  const double spacing = spacing_for(tool);
  for (const auto& points : surface.colwise()) {
    const Vector3d a = rest.col(points[0]), b = rest.col(points[1]), c = rest.col(points[2]);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double n = std::clamp(std::ceil(longest / spacing), 1.0, most_divisions);
    triangles_.push_back({.points = {points[0], points[1], points[2]},
                          .samples = {.divisions = static_cast<std::int32_t>(n),
                                      .share = (b - a).cross(c - a).norm() / (6 * n * n)}});
    // The front of the tool is on a sample when |arm - s path| = radius.
    const Vector3d path = tool.travel.stableNormalized();
    triangles_.back().samples.visit([&](const double* weights, double) {
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
void ToolContact::visit_samples(double t, const NodeRows& x, const Visit& visit) const {
  const SpherePose<double> pose = tool_.pose(t);
  SphereLaw<double> law = tool_.law();
  law.damping = 0;
  for (const Triangle& triangle : triangles_)
    kernel_loops::visit_touches(law, pose, triangle.samples, corners_of(triangle, x), corners_of(triangle, x),
                                [&](const double* weights, double area, const SphereTouch<double>& touch) {
                                  visit(triangle, weights, area, touch);
                                });
}

double ToolContact::energy(double t, const NodeRows& x) const {
  double sum = 0;
  visit_samples(t, x, [&](const Triangle&, const double*, double area, const SphereTouch<double>& touch) {
    sum += area * tool_.law().energy(touch);
  });
  return sum;
}

void ToolContact::add_force(double t, const NodeRows& x, const NodeRows& v, NodeRows& f) const {
  const SpherePose<double> pose = tool_.pose(t);
  const SphereLaw<double> law = tool_.law();
  double force[3][3];
  for (const Triangle& triangle : triangles_)
    if (kernel_loops::contact_force(law, pose, triangle.samples, corners_of(triangle, x),
                                    corners_of(triangle, v), force))
      for (std::size_t a = 0; a < 3; ++a)
        as_vector(f[at(triangle.points[a])]) += Eigen::Map<const Vector3d>(force[a]);
}

template <class Derivative>
void ToolContact::add_blocks(double t, const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                             double* values, const Derivative& derivative) const {
  using Block = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const SpherePose<double> pose = tool_.pose(t);
  const SphereLaw<double> law = tool_.law();
  double D[3][3], sums[6][3][3];  // of pairs of corners: as b_a b_b, they do not ask for their order
  for (const Triangle& triangle : triangles_) {
    bool is_touched = false;
    kernel_loops::visit_touches(law, pose, triangle.samples, corners_of(triangle, x), corners_of(triangle, v),
                                [&](const double* b, double area, const SphereTouch<double>& touch) {
                                  if (!is_touched) std::fill_n(&sums[0][0][0], 54, 0.0);
                                  is_touched = true;
                                  derivative(law, touch, D);
                                  for (int a = 0; a < 3; ++a)
                                    for (int c = a; c < 3; ++c)
                                      kernel_loops::add_sample(area, b[a] * b[c], D,
                                                               sums[kernel_loops::symmetric(a, c)]);
                                });
    if (!is_touched) continue;
    const auto slots = pattern.slots(triangle.points);
    for (std::size_t k = 0; k < 9; ++k)
      pattern.add(
          values, slots[k], triangle.points[k % 3],
          Eigen::Map<const Block>(
              &sums[kernel_loops::symmetric(static_cast<int>(k / 3), static_cast<int>(k % 3))][0][0]));
  }
}

void ToolContact::add_stiffness(double t, const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                                double* values) const {
  add_blocks(t, x, v, pattern, values,
             [](const auto& law, const auto& touch, double(*D)[3]) { law.stiffness_of(touch, D); });
}

void ToolContact::add_damping(double t, const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                              double* values) const {
  if (tool_.damping == 0) return;
  add_blocks(t, x, v, pattern, values,
             [](const auto& law, const auto& touch, double(*D)[3]) { law.damping_of(touch, D); });
}

ToolContact::Reach ToolContact::reach(double t, const NodeRows& x) const {
  const Vector3d path = tool_.travel.stableNormalized();
  Reach reach{.depth = tool_.profile.value(t) * tool_.travel.norm()};
  visit_samples(
      t, x, [&](const Triangle& triangle, const double* weights, double, const SphereTouch<double>& touch) {
        double along = 0;
        for (std::size_t a = 0; a < 3; ++a) {
          const Index point = triangle.points[a];
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
