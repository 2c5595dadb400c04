#include "problems/tissue/forces/quadratic_elements.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <Eigen/Dense>

#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/kernels/element_pull.hpp"
#include "problems/tissue/forces/kernels/element_stiffness.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"
#include "problems/tissue/forces/tet_elements.hpp"

namespace hmax {

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

void QuadraticElements::moves(const NodeRows& u, const Element& e, double (*U)[3]) {
  const NodeRow& first = u[at(e.points[0])];
  for (std::size_t a = 0; a < 10; ++a) {
    const NodeRow& row = u[at(e.points[a])];
    U[a][0] = row.x - first.x, U[a][1] = row.y - first.y, U[a][2] = row.z - first.z;
  }
}

TenPlaces QuadraticElements::moves(const NodeRows& u, const Element& e) {
  double U[10][3];
  moves(u, e, U);
  return Eigen::Map<const TenPlaces>(U[0]);
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
    double U[10][3];
    moves(u, e, U);
    kernel_loops::ten_node_pull<OneElement<double>, double>(U, e, [&](int a, const double* pull) {
      NodeRow& row = f[at(e.points[at(a)])];
      row.x -= pull[0], row.y -= pull[1], row.z -= pull[2];
    });
  }
}

QuadraticElements::Stiffness QuadraticElements::stiffness(const NodeRows& u, const Element& e) {
  using Lanes = OneElement<double>;
  double U[10][3];
  moves(u, e, U);
  std::array<kernel_loops::NeoHookeanParts<Lanes, 10>, 4> parts;
  for (int g = 0; g < 4; ++g) {
    for (int a = 0; a < 10; ++a)
      for (int j = 0; j < 3; ++j) parts[at(g)].g[a][j] = e.gradient(g, a, j);
    kernel_loops::ten_node_parts(U, e, g, parts[at(g)]);
  }
  return symmetric_stiffness<10>([&](int a, int b, double(*block)[3]) {
    kernel_loops::ten_node_stiffness(
        [&](int g) -> const auto& { return parts[at(g)]; }, a, b, block);
  });
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
