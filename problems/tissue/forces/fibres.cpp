#include "problems/tissue/forces/fibres.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "problems/digits.hpp"
#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/kernels/element_stiffness.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"
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
                             std::span<const Fibre> fibres, bool small_strain, const BlockPattern& pattern)
    : matrix_(std::move(matrix)), small_strain_(small_strain) {
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

FibreElements::Stretch FibreElements::stretch(const NodeRows& u, const Element& e) const {
  double U[3][3];
  edge_vectors(u, e.points, U);
  return kernel_loops::stretch_of_fibre<OneElement<double>>(U, e.slopes.data() + 1, e.direction.data(),
                                                            small_strain_);
}

double FibreElements::tension(const Stretch& now, const Element& e) const {
  return kernel_loops::fibre_tension(now, e.young, small_strain_);
}

bool FibreElements::resists(const NodeRows& u, const Element& e, Matrix3d& B) const {
  const Stretch now = stretch(u, e);
  if (!kernel_loops::is_taut(now, small_strain_)) return false;
  double block[3][3];
  kernel_loops::fibre_stiffness(now, e.young, e.volume, small_strain_, block);
  B = Eigen::Map<const Matrix3d>(block[0]);  // it is symmetric
  return true;
}

double FibreElements::energy(const NodeRows& u) const {
  double sum = matrix_->energy(u);
  for (const Element& e : elements_) {
    const Stretch now = stretch(u, e);
    sum += e.volume * tension(now, e) * now.strain / 2;
  }
  return sum;
}

void FibreElements::write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const {
  matrix_->write_energy_densities(u, W);
  for (const Element& e : elements_) {
    const Stretch now = stretch(u, e);
    W[e.tetrahedron] += tension(now, e) * now.strain / 2;
  }
}

void FibreElements::add_force(const NodeRows& u, NodeRows& f) const {
  matrix_->add_force(u, f);
  for (const Element& e : elements_) {
    const Stretch now = stretch(u, e);
    const double stress = tension(now, e);
    if (stress == 0) continue;
    const Eigen::Map<const Vector3d> along(now.along);
    for (std::size_t a = 0; a < 4; ++a)
      as_vector(f[at(e.points[a])]) -= e.volume * stress * e.slopes[static_cast<Eigen::Index>(a)] * along;
  }
}

ElementParts FibreElements::parts() const {
  ElementParts parts = matrix_->parts();
  parts.fibres = this;
  return parts;
}

void FibreElements::write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const {
  matrix_->write_stiffness(u, pattern, values);
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Element& e = elements_[t];
    Matrix3d B;
    if (!resists(u, e, B)) continue;
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
      Matrix3d B;
      if (!resists(u, *next, B)) continue;
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
                                            std::span<const Fibre> fibres, bool small_strain,
                                            const BlockPattern& pattern) {
  if (std::ranges::all_of(fibres, [](const Fibre& fibre) { return fibre.young == 0; })) return matrix;
  return std::make_shared<const FibreElements>(std::move(matrix), mesh, fibres, small_strain, pattern);
}

}  // namespace hmax
