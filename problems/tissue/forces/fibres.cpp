#include "problems/tissue/forces/fibres.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "problems/digits.hpp"
#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/tet_elements.hpp"

namespace hmax {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void check(const Fibre& fibre) {
  if (!(fibre.young >= 0) || !std::isfinite(fibre.young))
    throw std::invalid_argument("fibre_E is " + shortest_digits(fibre.young) +
                                " Pa but must be zero or more and finite");
  if (!fibre.direction.allFinite())
    throw std::invalid_argument("fibre_x, fibre_y and fibre_z must be finite");
  if (fibre.young > 0 && fibre.direction.isZero(0))
    throw std::invalid_argument(
        "fibres of fibre_E " + shortest_digits(fibre.young) +
        " Pa have no direction: fibre_x, fibre_y and fibre_z are all 0; give a vector like fibre_x=1, of a region "
        "fibre_x:REGION=1");
}

}  // namespace

FibreElements::FibreElements(std::shared_ptr<const Elements> matrix, const TetMesh& mesh,
                             std::span<const Fibre> fibres, bool linear, const BlockPattern& pattern)
    : matrix_(std::move(matrix)), linear_(linear) {
  for (const Fibre& fibre : fibres) check(fibre);
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    const Fibre& fibre = fibres[at(mesh.region(t))];
    if (fibre.young == 0) continue;
    Element e{.tetrahedron = t,
              .piece = t / mesh.parts(),
              .points = {},
              .slopes = {},
              .direction = fibre.direction.stableNormalized(),
              .young = fibre.young,
              .volume = 0};
    for (Eigen::Index a = 0; a < 4; ++a) e.points[at(a)] = mesh.tetrahedra(a, t);
    const RestShape rest(mesh, e.points);
    e.volume = rest.volume;
    e.slopes.tail<3>() = rest.gradients * e.direction;
    e.slopes[0] = -e.slopes.tail<3>().sum();
    elements_.push_back(e);
    slots_.push_back(pattern.slots(e.points));
  }
}

FibreElements::Stretched FibreElements::stretched(const NodeRows& u, const Element& e) const {
  // F a = a + d; from d rather than F, so that small strains keep their digits.
  const Vector3d d = edge_vectors(u, e.points) * e.slopes.tail<3>();
  if (linear_) return {.strain = e.direction.dot(d), .along = e.direction, .taut = true};
  // A fibre at rest is taut however it was turned.
  constexpr double rounding = 1e-12;
  const double square = 2 * e.direction.dot(d) + d.squaredNorm();  // l^2 - 1
  const double length = std::sqrt(std::max(0.0, 1 + square));
  return {.strain = square / (1 + length), .along = (e.direction + d) / length, .taut = square >= -rounding};
}

double FibreElements::tension(const Stretched& now, const Element& e) const {
  return linear_ || now.strain > 0 ? e.young * now.strain : 0;
}

Matrix3d FibreElements::resistance(const Stretched& now, const Element& e) const {
  const Matrix3d along = now.along * now.along.transpose();
  const double across = linear_ ? 0 : std::max(0.0, now.strain) / (1 + now.strain);
  return e.volume * e.young * (along + across * (Matrix3d::Identity() - along));
}

double FibreElements::energy(const NodeRows& u) const {
  double sum = matrix_->energy(u);
  for (const Element& e : elements_) {
    const Stretched now = stretched(u, e);
    sum += e.volume * tension(now, e) * now.strain / 2;
  }
  return sum;
}

void FibreElements::write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const {
  matrix_->write_energy_densities(u, W);
  for (const Element& e : elements_) {
    const Stretched now = stretched(u, e);
    W[e.tetrahedron] += tension(now, e) * now.strain / 2;
  }
}

void FibreElements::add_force(const NodeRows& u, NodeRows& f) const {
  matrix_->add_force(u, f);
  for (const Element& e : elements_) {
    const Stretched now = stretched(u, e);
    const double stress = tension(now, e);
    if (stress == 0) continue;
    for (std::size_t a = 0; a < 4; ++a)
      as_vector(f[at(e.points[a])]) -= e.volume * stress * e.slopes[static_cast<Eigen::Index>(a)] * now.along;
  }
}

void FibreElements::write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const {
  matrix_->write_stiffness(u, pattern, values);
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Element& e = elements_[t];
    const Stretched now = stretched(u, e);
    if (!now.taut) continue;
    const Matrix3d B = resistance(now, e);
    for (Eigen::Index a = 0; a < 4; ++a)
      for (Eigen::Index b = 0; b < 4; ++b)
        pattern.add(values, slots_[t][at(4 * a + b)], e.points[at(b)],
                    Matrix3d(e.slopes[a] * e.slopes[b] * B));
  }
}

void FibreElements::visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const {
  auto next = elements_.begin();
  Eigen::Index piece = -1;
  Eigen::MatrixXd sum;
  matrix_->visit_stiffness(u, [&](std::span<const Index> points, const Eigen::Ref<const Eigen::MatrixXd>& K) {
    ++piece;
    if (next == elements_.end() || next->piece != piece) return visit(points, K);
    sum = K;
    for (; next != elements_.end() && next->piece == piece; ++next) {
      const Stretched now = stretched(u, *next);
      if (!now.taut) continue;
      const Matrix3d B = resistance(now, *next);
      std::array<Eigen::Index, 4> place;
      for (std::size_t a = 0; a < 4; ++a)
        place[a] = std::ranges::find(points, next->points[a]) - points.begin();
      for (Eigen::Index a = 0; a < 4; ++a)
        for (Eigen::Index b = 0; b < 4; ++b)
          sum.block<3, 3>(3 * place[at(a)], 3 * place[at(b)]) += next->slopes[a] * next->slopes[b] * B;
    }
    visit(points, sum);
  });
}

std::shared_ptr<const Elements> with_fibres(std::shared_ptr<const Elements> matrix, const TetMesh& mesh,
                                            std::span<const Fibre> fibres, bool linear,
                                            const BlockPattern& pattern) {
  if (std::ranges::all_of(fibres, [](const Fibre& fibre) { return fibre.young == 0; })) return matrix;
  return std::make_shared<const FibreElements>(std::move(matrix), mesh, fibres, linear, pattern);
}

}  // namespace hmax
