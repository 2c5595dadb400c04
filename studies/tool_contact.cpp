#include "studies/tool_contact.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

using Corner = Eigen::Vector3d;
constexpr double pressed_for = 0.6;  // longer than the way of the tool takes [s]

/// The part of a convex polygon below a plane.
std::vector<Corner> clipped(const std::vector<Corner>& polygon, const Eigen::Vector4d& plane) {
  std::vector<Corner> kept;
  const auto above = [&](const Corner& x) { return plane.head<3>().dot(x) - plane[3]; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at_a = above(a), at_b = above(b);
    if (at_a <= 0) kept.push_back(a);
    if ((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return kept;
}

/// Whether a point of a fine lattice on the triangle lies in the ball.
bool touches(const SphereTool& tool, const Eigen::Vector3d& centre, const std::array<Corner, 3>& x) {
  constexpr int n = 40;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const Corner at = (i * x[0] + j * x[1] + (n - i - j) * x[2]) / n;
      if ((at - centre).norm() < tool.radius) return true;
    }
  return false;
}

Problem with_tool(std::string_view mesh, std::string_view material, Parameters parameters) {
  return make_problem(tissue_id("fem_green", mesh, "tool"),
                      {.material = std::string(material), .parameters = std::move(parameters)});
}

/// The sum of the elastic forces on the free points: what a tool on them holds in equilibrium.
double elastic_force(const Problem& problem, const Eigen::VectorXd& q) {
  const Problem bare = with_settings(problem, [](TissueSettings& settings) { settings.tools.clear(); });
  Eigen::VectorXd f(q.size());
  bare.body->force(0, q, Eigen::VectorXd::Zero(q.size()), f);
  return f.reshaped(3, f.size() / 3).rowwise().sum().norm();
}

}  // namespace

ViewVolume view_along(const Eigen::Vector3d& from, const Eigen::Vector3d& ahead, double half) {
  const Eigen::Vector3d along = ahead.normalized(), right = along.unitOrthogonal(), up = along.cross(right);
  ViewVolume volume;
  std::size_t k = 0;
  for (const Eigen::Vector3d& side : {right, up})
    for (const double sign : {1.0, -1.0}) volume[k++] << sign * side, sign * side.dot(from) + half;
  volume[4] << along, along.dot(from) + ahead.norm();
  volume[5] << -along, -along.dot(from);
  return volume;
}

std::vector<Eigen::Index> triangles_in(const ViewVolume& volume, const Eigen::Matrix3Xd& points,
                                       const MeshTriangles& triangles) {
  std::vector<Eigen::Index> found;
  std::vector<Corner> polygon;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    polygon = {points.col(triangles(0, t)), points.col(triangles(1, t)), points.col(triangles(2, t))};
    for (const Eigen::Vector4d& plane : volume) {
      polygon = clipped(polygon, plane);
      if (polygon.empty()) break;
    }
    if (!polygon.empty()) found.push_back(t);
  }
  return found;
}

ViewSearch view_search(std::string_view mesh, std::string_view material) {
  const Problem problem = with_tool(mesh, material, {});
  const SphereTool& tool = settings_of(problem).tools.front();
  const Eigen::Matrix3Xd& points = problem.body->mesh().points;
  const MeshTriangles triangles = surface_of(problem.body->mesh()).triangles;
  const Eigen::Vector3d along = tool.travel.normalized();
  const ViewVolume volume =
      view_along(tool.start - tool.radius * along, tool.travel + 2 * tool.radius * along, tool.radius);
  const std::vector<Eigen::Index> found = triangles_in(volume, points, triangles);
  ViewSearch search{.triangles = static_cast<long>(triangles.cols()),
                    .found = static_cast<long>(found.size())};
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const std::array<Corner, 3> corners{points.col(triangles(0, t)), points.col(triangles(1, t)),
                                        points.col(triangles(2, t))};
    if (!touches(tool, tool.start + tool.travel, corners)) continue;
    ++search.touched;
    if (!std::ranges::binary_search(found, t)) ++search.missed;
  }
  const std::array task{repeated([&] { triangles_in(volume, points, triangles); })};
  search.seconds = time_interleaved(task, {.repetitions = 5}).front().least();
  return search;
}

std::vector<PenaltyContact> penalty_contacts(std::string_view mesh, std::string_view material, double depth) {
  const double by_default =
      with_tool(mesh, material, {{"depth", depth}}).body->settings().tools.front().stiffness;
  const Method explicit_method = find_method("symplectic_euler");
  std::vector<PenaltyContact> all;
  for (const double factor : {0.01, 0.1, 1.0, 10.0}) {
    const Problem problem =
        with_tool(mesh, material, {{"depth", depth}, {"tool_stiffness", factor * by_default}});
    const RunRecord record =
        find_method("linearly_implicit_euler").bind(problem).run({.t_end = pressed_for, .h = 0.002}, {});
    if (record.outcome != Outcome::reached_end)
      throw InputError(fmt::format("the tool ended at t = {:g} s; this is a defect", record.t));
    const auto limit = [&](double t, const Eigen::VectorXd& y) {
      return predict(explicit_method, linearised(problem, t, y)).h_max.value_or(NAN);
    };
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(record.y.size());
    all.push_back({.factor = factor,
                   .penetration = problem.body->tool_reaches(record.t, record.y).front().penetration,
                   .force = elastic_force(problem, record.y.head(problem.body->dofs())),
                   .h_rest = limit(0, rest),
                   .h_pressed = limit(record.t, record.y)});
  }
  return all;
}

}  // namespace hmax
