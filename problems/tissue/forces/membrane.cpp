#include "problems/tissue/forces/membrane.hpp"

#include <stdexcept>

#include <Eigen/Dense>

#include "problems/digits.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/kernels/element_pull.hpp"
#include "problems/tissue/forces/kernels/element_stiffness.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Matrix3x2 = Eigen::Matrix<double, 3, 2>;

/// (x1 - x0, x2 - x0), column a at D[a].
void place_edges(const NodeRows& x, const std::array<TetMesh::Index, 3>& points, double (&D)[2][3]) {
  const NodeRow& from = x[static_cast<std::size_t>(points[0])];
  for (std::size_t a = 0; a < 2; ++a) {
    const NodeRow& to = x[static_cast<std::size_t>(points[a + 1])];
    D[a][0] = to.x - from.x, D[a][1] = to.y - from.y, D[a][2] = to.z - from.z;
  }
}

}  // namespace

Membrane::Membrane(const Eigen::Matrix3Xd& rest, const MeshTriangles& triangles, double young, double poisson,
                   double thickness, const BlockPattern& pattern)
    : young_(young), poisson_(poisson) {
  lame(young, poisson);
  if (!(thickness > 0))
    throw std::invalid_argument("the skin is " + shortest_digits(thickness) +
                                " m thick but must be thicker than 0");
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d u = rest.col(triangles(1, t)) - rest.col(triangles(0, t)),
                          w = rest.col(triangles(2, t)) - rest.col(triangles(0, t)), normal = u.cross(w);
    // In the plane of the triangle, the first axis along its first edge.
    const Eigen::Vector3d first = u.normalized(), second = normal.normalized().cross(first);
    Matrix2d flat;
    flat << u.dot(first), w.dot(first), u.dot(second), w.dot(second);
    const Matrix2d Bm = flat.inverse();
    triangles_.push_back({{triangles(0, t), triangles(1, t), triangles(2, t)},
                          {Bm(0, 0), Bm(0, 1), Bm(1, 0), Bm(1, 1)},
                          thickness * normal.norm() / 2});
    slots_.push_back(pattern.slots(triangles_.back().points));
  }
}

double Membrane::modulus() const { return young_ / (1 - poisson_ * poisson_); }

double Membrane::energy(const NodeRows& x) const {
  double sum = 0;
  for (const Triangle& t : triangles_) {
    const Matrix2d Bm = Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(t.gradients);
    double D[2][3];
    place_edges(x, t.points, D);
    const Matrix3x2 F = Eigen::Map<const Matrix3x2>(&D[0][0]) * Bm;
    const Matrix2d E = (F.transpose() * F - Matrix2d::Identity()) / 2,
                   S = modulus() * ((1 - poisson_) * E + poisson_ * E.trace() * Matrix2d::Identity());
    sum += t.volume / 2 * S.cwiseProduct(E).sum();
  }
  return sum;
}

void Membrane::add_force(const NodeRows& x, NodeRows& f) const {
  const double modulus = this->modulus();
  for (const Triangle& t : triangles_) {
    double D[2][3], pull[2][3];
    place_edges(x, t.points, D);
    kernel_loops::triangle_pull<OneElement<double>>(D, t.gradients, t.volume, modulus, poisson_, pull);
    const auto row = [&](std::size_t a) -> NodeRow& { return f[static_cast<std::size_t>(t.points[a])]; };
    NodeRow &f0 = row(0), &f1 = row(1), &f2 = row(2);
    f1.x -= pull[0][0], f1.y -= pull[0][1], f1.z -= pull[0][2];
    f2.x -= pull[1][0], f2.y -= pull[1][1], f2.z -= pull[1][2];
    f0.x += pull[0][0] + pull[1][0], f0.y += pull[0][1] + pull[1][1], f0.z += pull[0][2] + pull[1][2];
  }
}

Membrane::Stiffness Membrane::stiffness(const NodeRows& x, std::size_t triangle) const {
  const Triangle& t = triangles_[triangle];
  double D[2][3], F[2][3], S[3], pull[2][3];
  place_edges(x, t.points, D);
  kernel_loops::triangle_gradient(D, t.gradients, F);
  kernel_loops::membrane_stress<OneElement<double>>(modulus(), poisson_, F, S);
  Stiffness K;
  for (int b = 1; b < 3; ++b)
    for (int c = 0; c < 3; ++c) {
      kernel_loops::triangle_stiffness(F, S, t.gradients, t.volume, modulus(), poisson_, b, c, pull);
      const Eigen::Map<const Matrix3x2> columns(&pull[0][0]);
      auto column = K.col(3 * b + c);
      column.head<3>() = -(columns.col(0) + columns.col(1));
      column.segment<3>(3) = columns.col(0);
      column.tail<3>() = columns.col(1);
    }
  for (Eigen::Index c = 0; c < 3; ++c) K.col(c) = -(K.col(3 + c) + K.col(6 + c));
  return K;
}

void Membrane::add_stiffness(const NodeRows& x, const BlockPattern& pattern, double* values) const {
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Stiffness K = stiffness(x, t);
    pattern.add_element(values, slots_[t], triangles_[t].points, K);
  }
}

}  // namespace hmax
