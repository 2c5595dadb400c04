#include "problems/tissue/forces/quadratic_elements.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <Eigen/Dense>

#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/kernels/element_pull.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"

namespace hmax {

using Eigen::Matrix3d;

QuadraticElements::QuadraticElements(const TetMesh& mesh, std::span<const Lame> lame,
                                     const BlockPattern& pattern) {
  elements_.reserve(at(mesh.ten_node.cols()));
  slots_.reserve(elements_.capacity());
  for (Eigen::Index e = 0; e < mesh.ten_node.cols(); ++e) {
    std::array<Index, 10> points;
    std::ranges::copy(mesh.element(e), points.begin());
    elements_.push_back({.points = points,
                         .rule = rule_of(ten_places(mesh, e), e),
                         .lame = lame[at(mesh.region(mesh.first_part(e)))]});
    slots_.push_back(pattern.slots(points));
  }
}

std::array<QuadraticElements::Point, 4> QuadraticElements::rule_of(const TenPlaces& X, Eigen::Index element) {
  std::array<Point, 4> rule;
  double sum = 0;
  Eigen::Matrix<double, 10, 3> gradients = integrated_gradients(X);
  for (std::size_t g = 0; g < rule.size(); ++g) {
    // Rounding to double comes last, as in a linear tetrahedron.
    const Eigen::Matrix<long double, 10, 3> slopes = ten_node_slopes(ten_node_rule()[g]).cast<long double>();
    const Eigen::Matrix<long double, 3, 3> J = X.cast<long double>() * slopes;
    const auto determinant = static_cast<double>(J.determinant());
    if (!(determinant > 0))
      throw std::invalid_argument("the tetrahedron " + std::to_string(element) +
                                  " of ten nodes has sides bent so far that it has no volume at a point of "
                                  "integration; straighten them");
    rule[g] = {(slopes * J.inverse()).cast<double>(), determinant / 24};
    sum += rule[g].volume;
  }
  const double volume = ten_node_volume(X);
  for (Point& point : rule) {
    point.volume *= volume / sum;
    gradients -= point.volume * point.gradients;
  }
  for (Point& point : rule) point.gradients += gradients / volume;
  return rule;
}

TenPlaces QuadraticElements::moves(const NodeRows& u, const Element& e) {
  TenPlaces own;
  const auto first = as_vector(u[at(e.points[0])]);
  for (std::size_t a = 0; a < 10; ++a)
    own.col(static_cast<Eigen::Index>(a)) = as_vector(u[at(e.points[a])]) - first;
  return own;
}

double QuadraticElements::energy(const NodeRows& u) const {
  double sum = 0;
  for (const Element& e : elements_) {
    const TenPlaces own = moves(u, e);
    for (const Point& point : e.rule)
      sum += point.volume * StableNeoHookean(own * point.gradients, e.lame).energy();
  }
  return sum;
}

void QuadraticElements::write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const {
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const Element& e = elements_[i];
    const TenPlaces own = moves(u, e);
    double energy = 0, volume = 0;
    const auto first = static_cast<Eigen::Index>(8 * i);
    for (std::size_t g = 0; g < 4; ++g) {
      const Point& point = e.rule[g];
      const double density = StableNeoHookean(own * point.gradients, e.lame).energy();
      W[first + static_cast<Eigen::Index>(g)] = density;
      energy += point.volume * density;
      volume += point.volume;
    }
    W.segment<4>(first + 4).setConstant(energy / volume);
  }
}

void QuadraticElements::add_force(const NodeRows& u, NodeRows& f) const {
  for (const Element& e : elements_) {
    const NodeRow& first = u[at(e.points[0])];
    double U[10][3];
    for (std::size_t a = 0; a < 10; ++a) {
      const NodeRow& row = u[at(e.points[a])];
      U[a][0] = row.x - first.x, U[a][1] = row.y - first.y, U[a][2] = row.z - first.z;
    }
    kernel_loops::ten_node_pull<OneElement<double>, double>(U, e, [&](int a, const double* pull) {
      NodeRow& row = f[at(e.points[at(a)])];
      row.x -= pull[0], row.y -= pull[1], row.z -= pull[2];
    });
  }
}

QuadraticElements::Stiffness QuadraticElements::stiffness(const NodeRows& u, const Element& e) {
  const TenPlaces own = moves(u, e);
  Stiffness K = Stiffness::Zero();
  for (const Point& point : e.rule) {
    const StableNeoHookean law(own * point.gradients, e.lame);
    // V dP along each dF = e_c e_k^T, with which point b moves by G_b[k] along axis c.
    std::array<std::array<Matrix3d, 3>, 3> change;
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) {
        Matrix3d dF = Matrix3d::Zero();
        dF(c, k) = 1;
        change[at(c)][at(k)] = point.volume * law.differential(dF);
      }
    for (Eigen::Index b = 0; b < 10; ++b)
      for (Eigen::Index c = 0; c < 3; ++c) {
        Matrix3d stress = Matrix3d::Zero();
        for (Eigen::Index k = 0; k < 3; ++k) stress += point.gradients(b, k) * change[at(c)][at(k)];
        Eigen::Map<TenPlaces>(K.col(3 * b + c).data()).noalias() += stress * point.gradients.transpose();
      }
  }
  return K;
}

void QuadraticElements::visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const {
  for (const Element& e : elements_) visit(e.points, stiffness(u, e));
}

void QuadraticElements::write_stiffness(const NodeRows& u, const BlockPattern& pattern,
                                        double* values) const {
  std::fill_n(values, pattern.entries(), 0.0);
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const Stiffness K = stiffness(u, elements_[i]);
    pattern.add_element(values, slots_[i], elements_[i].points, K);
  }
}

}  // namespace hmax
