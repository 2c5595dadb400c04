/// A skin of triangles in plane stress.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/topology.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/node_rows.hpp"

namespace hmax {

/// Linear triangles that resist stretch and shear in their own plane, and no bending: St. Venant-Kirchhoff in
/// plane stress. With F = (x1 - x0, x2 - x0) Bm, shape (3, 2), and E = (F^T F - I) / 2, shape (2, 2),
///   S = Y / (1 - nu^2) ((1 - nu) E + nu tr(E) I),   energy A h S:E / 2,   forces -A h F S g_a.
/// @source  [bonet2008nonlinear]
class Membrane {
 public:
  using Index = TetMesh::Index;
  using Stiffness = Eigen::Matrix<double, 9, 9>;  ///< -dF/dx of one triangle, points after one another

  /// @param rest       shape (3, points)
  /// @param young      Y [Pa], positive
  /// @param poisson    nu, above -1 and below 1/2
  /// @param thickness  h [m], positive
  /// @param pattern    holds the pairs of points of every triangle
  /// @throws std::invalid_argument  for coefficients out of range
  Membrane(const Eigen::Matrix3Xd& rest, const MeshTriangles& triangles, double young, double poisson,
           double thickness, const BlockPattern& pattern);

  [[nodiscard]] double energy(const NodeRows& x) const;
  void add_force(const NodeRows& x, NodeRows& f) const;
  void add_stiffness(const NodeRows& x, const BlockPattern& pattern, double* values) const;

  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  [[nodiscard]] const std::array<Index, 3>& points(std::size_t i) const { return triangles_[i].points; }
  [[nodiscard]] Stiffness stiffness(const NodeRows& x, std::size_t triangle) const;

  struct Triangle {
    std::array<Index, 3> points;
    double gradients[4];  ///< Bm [1/m], row after row
    double volume;        ///< A h [m^3]
  };
  [[nodiscard]] const Triangle& triangle(std::size_t i) const { return triangles_[i]; }
  [[nodiscard]] double modulus() const;  ///< Y / (1 - nu^2) [Pa]
  [[nodiscard]] double poisson() const { return poisson_; }

 private:
  double young_, poisson_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<Index, 9>> slots_;
};

}  // namespace hmax
