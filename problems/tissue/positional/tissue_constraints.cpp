#include "problems/tissue/positional/tissue_constraints.hpp"

#include <algorithm>
#include <limits>

#include <Eigen/Dense>

#include "problems/cofactors.hpp"
#include "problems/tissue/positional/free_points.hpp"

namespace hmax {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void evaluate_spring(const Eigen::VectorXd& q, const TissueConstraints::Spring& spring,
                     CompliantConstraint& at) {
  const Vector3d d =
      spring.rest + displacement_of(q, spring.points[1]) - displacement_of(q, spring.points[0]);
  const double l = std::max(d.norm(), std::numeric_limits<double>::min());
  at.value = l - spring.length;
  at.compliance = 1 / spring.stiffness;
  at.add(spring.points[0], -d / l);
  at.add(spring.points[1], d / l);
}

/// dC/dq_i = P g_i with P = dC/dF and the gradients g_i of the shape functions.
void evaluate_tetrahedron(const Eigen::VectorXd& q, const TissueConstraints::Tetrahedron& element,
                          bool volumetric, CompliantConstraint& at) {
  const Matrix3d H = edge_vectors_of(q, element.points).lazyProduct(element.gradients);
  Matrix3d P;
  if (volumetric) {
    const Matrix3d K = cofactors(H);
    const double trace = H.trace();
    at.value = trace + K.trace() + H.col(0).dot(K.col(0)) - element.excess;  // det F - a
    at.compliance = element.volumetric;
    P = K - H.transpose();  // the cofactors of F
    P.diagonal().array() += 1 + trace;
  } else {
    P = H;
    P.diagonal().array() += 1;
    at.value = P.norm();
    at.compliance = element.deviatoric;
    P *= 1 / std::max(at.value, std::numeric_limits<double>::min());
  }
  const Matrix3d pull = P.lazyProduct(element.gradients.transpose());
  at.add(element.points[0], -pull.rowwise().sum());
  for (std::size_t a = 1; a < 4; ++a) at.add(element.points[a], pull.col(static_cast<Eigen::Index>(a) - 1));
}

}  // namespace

TissueConstraints::Tetrahedron::Tetrahedron(const std::array<Index, 4>& its_points, const RestShape& rest,
                                            const Lame& lame)
    : points(its_points),
      gradients(rest.gradients),
      deviatoric(1 / (lame.mu * rest.volume)),
      volumetric(1 / ((lame.lambda + lame.mu) * rest.volume)),
      excess(lame.mu / (lame.lambda + lame.mu)) {}

std::int32_t TissueConstraints::size() const {
  return static_cast<std::int32_t>(springs_.size() + 2 * elements_.size() + 3 * anchors_.size());
}

std::vector<std::vector<TissueConstraints::Index>> TissueConstraints::points() const {
  std::vector<std::vector<Index>> all;
  for (const Spring& each : springs_) all.emplace_back(each.points.begin(), each.points.end());
  for (const Tetrahedron& each : elements_)
    all.insert(all.end(), 2, std::vector<Index>(each.points.begin(), each.points.end()));
  for (const Anchor& each : anchors_) all.insert(all.end(), 3, std::vector<Index>{each.point});
  return all;
}

void TissueConstraints::evaluate(const Eigen::VectorXd& q, std::int32_t constraint,
                                 CompliantConstraint& at) const {
  at.points = 0;
  std::size_t i = static_cast<std::size_t>(constraint);
  if (i < springs_.size()) return evaluate_spring(q, springs_[i], at);
  i -= springs_.size();
  if (i < 2 * elements_.size()) return evaluate_tetrahedron(q, elements_[i / 2], i % 2 == 1, at);
  i -= 2 * elements_.size();
  const Anchor& anchor = anchors_[i / 3];
  const auto axis = static_cast<Eigen::Index>(i % 3);
  at.value = q[3 * static_cast<Eigen::Index>(anchor.point) + axis];
  at.compliance = 1 / anchor.stiffness;
  at.add(anchor.point, Vector3d::Unit(axis));
}

}  // namespace hmax
