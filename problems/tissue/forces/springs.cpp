#include "problems/tissue/forces/springs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Dense>

#include "problems/digits.hpp"
#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/kernels/element_stiffness.hpp"

namespace hmax {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// From a to b: length [m] and direction; no direction when the points coincide.
struct Span {
  double length;
  Vector3d e;
  Span(const NodeRows& x, const std::array<TetMesh::Index, 2>& points) {
    const Vector3d d =
        as_vector(x[static_cast<std::size_t>(points[1])]) - as_vector(x[static_cast<std::size_t>(points[0])]);
    length = std::max(d.norm(), std::numeric_limits<double>::min());
    e = d / length;
  }
};

Vector3d approach(const NodeRows& v, const std::array<TetMesh::Index, 2>& points) {
  return as_vector(v[static_cast<std::size_t>(points[1])]) -
         as_vector(v[static_cast<std::size_t>(points[0])]);
}

void pull_together(NodeRows& f, const std::array<TetMesh::Index, 2>& points, const Vector3d& pull) {
  as_vector(f[static_cast<std::size_t>(points[0])]) += pull;
  as_vector(f[static_cast<std::size_t>(points[1])]) -= pull;
}

/// values += (B, -B; -B, B).
void add_pair(const BlockPattern& pattern, double* values, const std::array<TetMesh::Index, 2>& points,
              const std::array<TetMesh::Index, 4>& slots, const Matrix3d& B) {
  pattern.add(values, slots[0], points[0], B);
  pattern.add(values, slots[1], points[1], -B);
  pattern.add(values, slots[2], points[0], -B);
  pattern.add(values, slots[3], points[1], B);
}

/// dT/dl e e^T + T / l (I - e e^T).
template <class Law>
Matrix3d tangent(const Law& law, const Span& at, double stiffness, double length) {
  double B[3][3];
  kernel_loops::spring_stiffness(law, stiffness, length, at.length, at.e.data(), B);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&B[0][0]);
}

/// b of phi = s + b s^3, the laws that the kernels know.
std::optional<double> cubic_coefficient(const SpringLaw& law) {
  if (std::holds_alternative<LinearSpring>(law)) return 0;
  if (const auto* cubic = std::get_if<CubicSpring>(&law)) return cubic->b;
  return std::nullopt;
}

}  // namespace

/// The springs that begin at each point.
class SpringSet::ByPoint {
 public:
  ByPoint(const std::vector<Spring>& springs, std::size_t points)
      : first_(points + 1, 0), springs_(springs.size()) {
    const auto point = [&](std::size_t i) { return static_cast<std::size_t>(springs[i].points[0]); };
    for (std::size_t i = 0; i < springs.size(); ++i) ++first_[point(i) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < springs.size(); ++i) springs_[next[point(i)]++] = i;
  }
  [[nodiscard]] std::span<const std::size_t> of(std::size_t point) const {
    return std::span(springs_).subspan(first_[point], first_[point + 1] - first_[point]);
  }

 private:
  std::vector<std::size_t> first_, springs_;
};

TableSpring::TableSpring(std::vector<double> strain, std::vector<double> phi)
    : strain_(std::move(strain)), phi_(std::move(phi)) {
  if (strain_.size() < 2 || strain_.size() != phi_.size())
    throw std::invalid_argument("a spring table has " + std::to_string(strain_.size()) + " strains and " +
                                std::to_string(phi_.size()) +
                                " values; give at least two points, each with both");
  sum_.push_back(0);
  for (std::size_t i = 0; i + 1 < strain_.size(); ++i) {
    const double width = strain_[i + 1] - strain_[i];
    if (!(width > 0))
      throw std::invalid_argument("the strains of a spring table do not ascend after " +
                                  shortest_digits(strain_[i]) + "; sort them and leave repeated ones out");
    slope_.push_back((phi_[i + 1] - phi_[i]) / width);
    sum_.push_back(sum_.back() + width * (phi_[i] + phi_[i + 1]) / 2);
  }
  if (const double at_rest = this->phi(0);
      !(std::abs(at_rest) <= 1e-12 * (std::abs(phi_.front()) + std::abs(phi_.back()))))
    throw std::invalid_argument("a spring table has the tension " + shortest_digits(at_rest) +
                                " at strain 0; let it pass through (0, 0)");
}
double TableSpring::up_to(double s) const {
  const std::size_t i = at(lines().line(s));
  const double d = s - strain_[i];
  return sum_[i] + d * (phi_[i] + slope_[i] * d / 2);
}
double TableSpring::integral(double s) const { return up_to(s) - up_to(0); }

std::vector<double> edge_stiffness(const TetMesh& mesh, const EdgeTable& edges,
                                   std::span<const double> young) {
  std::vector<double> k(static_cast<std::size_t>(edges.edges.cols()), 0);
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    Matrix3d rest;
    for (Eigen::Index a = 1; a < 4; ++a)
      rest.col(a - 1) = mesh.points.col(mesh.tetrahedra(a, t)) - mesh.points.col(mesh.tetrahedra(0, t));
    const double stiff = young[static_cast<std::size_t>(mesh.region(t))] * rest.determinant() / 6;
    for (const auto& [a, b] : tetrahedron_edges) {
      const TetMesh::Index i = mesh.tetrahedra(a, t), j = mesh.tetrahedra(b, t);
      k[static_cast<std::size_t>(edges.find(i, j))] +=
          stiff / (mesh.points.col(j) - mesh.points.col(i)).squaredNorm();
    }
  }
  return k;
}

SpringSet::SpringSet(const Eigen::Matrix3Xd& rest, std::vector<Spring> springs, SpringLaw law,
                     const BlockPattern& pattern, const TissueKernels& kernels)
    : springs_(std::move(springs)), law_(std::move(law)), kernels_(&kernels) {
  for (const Spring& spring : springs_) {
    const auto [a, b] = spring.points;
    const std::string name = "the spring between points " + std::to_string(a) + " and " + std::to_string(b);
    length_.push_back((rest.col(b) - rest.col(a)).norm());
    if (!(length_.back() > 0))
      throw std::invalid_argument(name + " has no length; give it two different points");
    if (!(spring.stiffness >= 0 && std::isfinite(spring.stiffness) && spring.damper >= 0 &&
          std::isfinite(spring.damper)))
      throw std::invalid_argument(name + " has the stiffness " + shortest_digits(spring.stiffness) +
                                  " N/m and the damper " + shortest_digits(spring.damper) +
                                  " N s/m; neither may be negative");
    slots_.push_back(pattern.slots(spring.points));
    has_dampers_ = has_dampers_ || spring.damper > 0;
  }
  if (cubic_coefficient(law_)) make_slices(static_cast<std::size_t>(rest.cols()));
}

std::optional<SpringSet::Sliced> SpringSet::sliced() const {
  const std::optional<double> cubic = cubic_coefficient(law_);
  if (!cubic) return std::nullopt;
  return Sliced{slices_, blocks_, ends_, *cubic};
}

void SpringSet::make_slices(std::size_t points) {
  const ByPoint springs(springs_, points);
  std::vector<std::size_t> order;
  for (std::size_t point = 0; point < points; ++point)
    if (!springs.of(point).empty()) order.push_back(point);
  // Points near each other with as many springs share a slice, so that few lanes stay unused.
  constexpr std::size_t lanes = SpringSlice::lanes, window = 16 * lanes;
  for (std::size_t begin = 0; begin < order.size(); begin += window) {
    const std::span<std::size_t> near(order.begin() + static_cast<std::ptrdiff_t>(begin),
                                      std::min(window, order.size() - begin));
    std::stable_sort(near.begin(), near.end(), [&](std::size_t a, std::size_t b) {
      return springs.of(a).size() > springs.of(b).size();
    });
    Index lowest = std::numeric_limits<Index>::max(), highest = 0;
    for (std::size_t n = 0; n < near.size(); n += lanes)
      add_slice(springs, near.subspan(n, std::min(lanes, near.size() - n)));
    for (const std::size_t point : near)
      for (const std::size_t i : springs.of(point)) {
        const auto [low, high] = std::minmax(springs_[i].points[0], springs_[i].points[1]);
        lowest = std::min(lowest, low), highest = std::max(highest, high);
      }
    strips_.add_group(slices_.size(), lowest, highest);
  }
}

void SpringSet::add_slice(const ByPoint& springs, std::span<const std::size_t> points) {
  const std::size_t begin = blocks_.size(), most = springs.of(points.front()).size();
  SpringSlice& slice = slices_.emplace_back();
  slice.begin = static_cast<std::int32_t>(begin);
  slice.end = static_cast<std::int32_t>(begin + most);
  blocks_.resize(begin + most);
  ends_.resize(begin + most);
  for (std::size_t lane = 0; lane < SpringSlice::lanes; ++lane) {
    const std::size_t point = points[std::min(lane, points.size() - 1)];
    const std::span<const std::size_t> here = springs.of(point);
    slice.rows[lane] = 4 * static_cast<Index>(point);
    for (std::size_t k = 0; k < most; ++k) {
      const std::size_t i = here[std::min(k, here.size() - 1)];
      const bool used = lane < points.size() && k < here.size();
      blocks_[begin + k].per_length[lane] = 1 / length_[i];
      blocks_[begin + k].tension[lane] = used ? springs_[i].stiffness * length_[i] : 0;
      ends_[begin + k].rows[lane] = 4 * springs_[i].points[1];
    }
  }
}

double SpringSet::energy(const NodeRows& x) const {
  return std::visit(
      [&](const auto& law) {
        double sum = 0;
        for (std::size_t i = 0; i < springs_.size(); ++i) {
          const double L = length_[i], s = (Span(x, springs_[i].points).length - L) / L;
          sum += springs_[i].stiffness * L * L * law.integral(s);
        }
        return sum;
      },
      law_);
}

void SpringSet::add_force(const NodeRows& x, NodeRows& f) const {
  if (const auto cubic = cubic_coefficient(law_)) {
    // For a thread, some 50 us.
    constexpr std::size_t least = 16'000;
    return add_by_strips(strips_, size() / least, f, [&](std::size_t begin, std::size_t end, double* rows) {
      kernels_->spring_force(slices_.data() + begin, end - begin, blocks_.data(), ends_.data(), *cubic,
                             &x.front().x, rows);
    });
  }
  std::visit(
      [&](const auto& law) {
        for (std::size_t i = 0; i < springs_.size(); ++i) {
          const Span at(x, springs_[i].points);
          const double L = length_[i];
          pull_together(f, springs_[i].points,
                        kernel_loops::spring_tension(law, springs_[i].stiffness * L, L, at.length) * at.e);
        }
      },
      law_);
}

void SpringSet::add_damper_force(const NodeRows& x, const NodeRows& v, NodeRows& f) const {
  for (const Spring& spring : springs_) {
    const Span at(x, spring.points);
    pull_together(f, spring.points, spring.damper * at.e.dot(approach(v, spring.points)) * at.e);
  }
}

Matrix3d SpringSet::stiffness(const NodeRows& x, std::size_t i) const {
  const Span at(x, springs_[i].points);
  return std::visit([&](const auto& law) { return tangent(law, at, springs_[i].stiffness, length_[i]); },
                    law_);
}

void SpringSet::add_stiffness(const NodeRows& x, const BlockPattern& pattern, double* values) const {
  std::visit(
      [&](const auto& law) {
        for (std::size_t i = 0; i < springs_.size(); ++i) {
          const Span at(x, springs_[i].points);
          add_pair(pattern, values, springs_[i].points, slots_[i],
                   tangent(law, at, springs_[i].stiffness, length_[i]));
        }
      },
      law_);
}

void SpringSet::add_damper_stiffness(const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                                     double* values) const {
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    // e.w changes by (w - e (e.w)).dd / l and e by (dd - e (e.dd)) / l.
    const Span at(x, springs_[i].points);
    const Vector3d w = approach(v, springs_[i].points);
    const double along = at.e.dot(w);
    const Matrix3d across = Matrix3d::Identity() - at.e * at.e.transpose();
    add_pair(pattern, values, springs_[i].points, slots_[i],
             springs_[i].damper / at.length * (at.e * (w - along * at.e).transpose() + along * across));
  }
}

void SpringSet::add_damping(const NodeRows& x, const BlockPattern& pattern, double* values) const {
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Span at(x, springs_[i].points);
    add_pair(pattern, values, springs_[i].points, slots_[i], springs_[i].damper * at.e * at.e.transpose());
  }
}

}  // namespace hmax
