#include "problems/tissue/loads.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Dense>

#include "problems/digits.hpp"
#include "problems/mesh/at.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

SampledCurve::SampledCurve(std::vector<double> t, std::vector<double> v)
    : t_(std::move(t)), v_(std::move(v)) {
  const auto finite = [](double x) { return std::isfinite(x); };
  if (t_.size() < 2 || t_.size() != v_.size() || !std::ranges::all_of(t_, finite) ||
      !std::ranges::all_of(v_, finite) || std::ranges::adjacent_find(t_, std::greater_equal<>()) != t_.end())
    throw std::invalid_argument("a sampled curve needs two or more finite values at increasing times");
  const std::size_t n = t_.size();
  const auto secant = [&](std::size_t i) { return (v_[i + 1] - v_[i]) / (t_[i + 1] - t_[i]); };
  // The ends are flat, as the curve is beyond them. Inside: zero at a turn, else a harmonic mean of both
  // secants.
  slope_.assign(n, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double a = secant(i - 1), b = secant(i), before = t_[i] - t_[i - 1], after = t_[i + 1] - t_[i];
    if (a * b > 0) slope_[i] = 3 * (before + after) / ((2 * after + before) / a + (after + 2 * before) / b);
  }
}

std::size_t SampledCurve::interval_of(double t) const {
  const auto next = std::ranges::upper_bound(t_, t);
  return std::clamp<std::size_t>(static_cast<std::size_t>(next - t_.begin()), 1, t_.size() - 1) - 1;
}

double SampledCurve::value(double t) const {
  if (!(t > t_.front())) return v_.front();
  if (t >= t_.back()) return v_.back();
  const std::size_t i = interval_of(t);
  const double width = t_[i + 1] - t_[i], u = (t - t_[i]) / width, rest = 1 - u;
  return rest * rest * ((1 + 2 * u) * v_[i] + u * width * slope_[i]) +
         u * u * ((3 - 2 * u) * v_[i + 1] - rest * width * slope_[i + 1]);
}

double SampledCurve::rate(double t) const {
  if (!(t > t_.front()) || t >= t_.back()) return 0;
  const std::size_t i = interval_of(t);
  const double width = t_[i + 1] - t_[i], u = (t - t_[i]) / width, rest = 1 - u;
  return 6 * u * rest * (v_[i + 1] - v_[i]) / width + rest * (1 - 3 * u) * slope_[i] -
         u * (2 - 3 * u) * slope_[i + 1];
}

double TimeProfile::value(double t) const {
  switch (kind) {
    case Kind::ramp: {
      const auto risen = [&](double since) {
        const double u = std::clamp(since / rise, 0.0, 1.0);
        return u * u * u * (10 - u * (15 - 6 * u));
      };
      return t > fall ? risen(t - start) - risen(t - fall) : risen(t - start);
    }
    case Kind::sine:
      return std::sin(omega * (t - start));
    case Kind::samples:
      return curve->value(t);
    case Kind::steady:
      break;
  }
  return 1;
}

double TimeProfile::rate(double t) const {
  switch (kind) {
    case Kind::ramp: {
      const auto rising = [&](double since) {
        const double u = std::clamp(since / rise, 0.0, 1.0);
        return 30 * u * u * (1 - u) * (1 - u) / rise;
      };
      return t > fall ? rising(t - start) - rising(t - fall) : rising(t - start);
    }
    case Kind::sine:
      return omega * std::cos(omega * (t - start));
    case Kind::samples:
      return curve->rate(t);
    case Kind::steady:
      break;
  }
  return 0;
}

double TimeProfile::steady_from() const {
  switch (kind) {
    case Kind::ramp:
      return (std::isfinite(fall) ? fall : start) + rise;
    case Kind::sine:
      return std::numeric_limits<double>::infinity();
    case Kind::samples:
      return curve->t_end();
    case Kind::steady:
      break;
  }
  return 0;
}

// Between the samples the curve and its slope are continuous: steps see them.
void TimeProfile::add_breakpoints(std::vector<double>& times) const {
  switch (kind) {
    case Kind::ramp:
      times.insert(times.end(), {start, start + rise});
      if (std::isfinite(fall)) times.insert(times.end(), {fall, fall + rise});
      break;
    case Kind::samples:
      times.insert(times.end(), {curve->t_begin(), curve->t_end()});
      break;
    case Kind::sine:
    case Kind::steady:
      break;
  }
}

SpherePose<double> SphereTool::pose(double t) const {
  const Eigen::Vector3d centre = start + profile.value(t) * travel, velocity = profile.rate(t) * travel;
  return {{centre[0], centre[1], centre[2]}, {velocity[0], velocity[1], velocity[2]}};
}

std::vector<TetMesh::Index> points_of_end(const TetMesh& mesh, const Eigen::Vector3d& towards, double share) {
  const Eigen::RowVectorXd along = towards.transpose() * mesh.points;
  const double far = along.maxCoeff(), reach = share * (far - along.minCoeff());
  std::vector<TetMesh::Index> points;
  for (TetMesh::Index i = 0; i < mesh.point_count(); ++i)
    if (along[i] >= far - reach) points.push_back(i);
  return points;
}

std::vector<TetMesh::Index> points_in_box(const TetMesh& mesh, const Eigen::Vector3d& low,
                                          const Eigen::Vector3d& high) {
  std::vector<TetMesh::Index> inside;
  for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
    const auto x = mesh.points.col(i).array();
    if ((x >= low.array()).all() && (x <= high.array()).all())
      inside.push_back(static_cast<TetMesh::Index>(i));
  }
  return inside;
}

void check_stiffness(const ElasticSupport& support) {
  if (support.stiffness.size() != support.points.size())
    throw std::invalid_argument("an elastic support has " + std::to_string(support.points.size()) +
                                " points but " + std::to_string(support.stiffness.size()) +
                                " stiffnesses; give each point one");
  for (const double k : support.stiffness)
    if (!(k >= 0 && std::isfinite(k)))
      throw std::invalid_argument("the stiffness of an elastic support is " + shortest_digits(k) +
                                  " but must be zero or more and finite");
}

ElasticSupport on_foundation(const TetMesh& mesh, const std::vector<TetMesh::Index>& points, double modulus) {
  std::vector<bool> is_held(at(mesh.point_count()), false);
  for (const TetMesh::Index i : points) is_held[at(i)] = true;
  std::vector<double> area(at(mesh.point_count()), 0);
  const MeshSurface surface = surface_of(mesh);
  for (const auto& corners : surface.triangles.colwise()) {
    if (!std::ranges::all_of(corners, [&](TetMesh::Index i) { return is_held[at(i)]; })) continue;
    const Eigen::Vector3d a = mesh.points.col(corners[0]), b = mesh.points.col(corners[1]),
                          c = mesh.points.col(corners[2]);
    for (const TetMesh::Index i : corners) area[at(i)] += (b - a).cross(c - a).norm() / 6;
  }
  ElasticSupport support;
  for (TetMesh::Index i = 0; i < mesh.point_count(); ++i) {
    if (!(area[at(i)] > 0)) continue;
    support.points.push_back(i);
    support.stiffness.push_back(modulus * area[at(i)]);
  }
  return support;
}

}  // namespace hmax
