#include "problems/tissue/forces/membrane.hpp"

#include <stdexcept>

#include <Eigen/Dense>

#include "problems/digits.hpp"
#include "problems/tissue/forces/elasticity.hpp"

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Gradient = Eigen::Matrix<double, 3, 2>;

Gradient edges(const NodeRows& x, const std::array<TetMesh::Index, 3>& points) {
  Gradient Ds;
  for (std::size_t a = 1; a < 3; ++a)
    Ds.col(static_cast<Eigen::Index>(a) - 1) =
        as_vector(x[static_cast<std::size_t>(points[a])]) - as_vector(x[static_cast<std::size_t>(points[0])]);
  return Ds;
}

Matrix2d green(const Gradient& F) { return (F.transpose() * F - Matrix2d::Identity()) / 2; }

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
    triangles_.push_back(
        {{triangles(0, t), triangles(1, t), triangles(2, t)}, flat.inverse(), thickness * normal.norm() / 2});
    slots_.push_back(pattern.slots(triangles_.back().points));
  }
}

Matrix2d Membrane::stress(const Matrix2d& strain) const {
  return young_ / (1 - poisson_ * poisson_) *
         ((1 - poisson_) * strain + poisson_ * strain.trace() * Matrix2d::Identity());
}

double Membrane::energy(const NodeRows& x) const {
  double sum = 0;
  for (const Triangle& t : triangles_) {
    const Matrix2d E = green(edges(x, t.points) * t.gradients);
    sum += t.volume / 2 * stress(E).cwiseProduct(E).sum();
  }
  return sum;
}

void Membrane::add_force(const NodeRows& x, NodeRows& f) const {
  for (const Triangle& t : triangles_) {
    const Gradient F = edges(x, t.points) * t.gradients;
    const Gradient pull = t.volume * F * stress(green(F)) * t.gradients.transpose();
    as_vector(f[static_cast<std::size_t>(t.points[1])]) -= pull.col(0);
    as_vector(f[static_cast<std::size_t>(t.points[2])]) -= pull.col(1);
    as_vector(f[static_cast<std::size_t>(t.points[0])]) += pull.col(0) + pull.col(1);
  }
}

Membrane::Stiffness Membrane::stiffness(const NodeRows& x, std::size_t triangle) const {
  const Triangle& t = triangles_[triangle];
  const Gradient F = edges(x, t.points) * t.gradients;
  const Matrix2d S = stress(green(F));
  Stiffness K;
  for (Eigen::Index b = 1; b < 3; ++b)
    for (Eigen::Index c = 0; c < 3; ++c) {
      Gradient change = Gradient::Zero();
      change.row(c) = t.gradients.row(b - 1);
      const Matrix2d half = F.transpose() * change;
      const Gradient pull =
          t.volume * (change * S + F * stress((half + half.transpose()) / 2)) * t.gradients.transpose();
      auto column = K.col(3 * b + c);
      column.head<3>() = -(pull.col(0) + pull.col(1));
      column.segment<3>(3) = pull.col(0);
      column.tail<3>() = pull.col(1);
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
