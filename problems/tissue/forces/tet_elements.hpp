/// Linear tetrahedra of any elastic law: energy, force and stiffness, one element after the other.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/elements.hpp"
#include "problems/tissue/forces/node_rows.hpp"
#include "problems/tissue/forces/rest_shape.hpp"
#include "problems/tissue/forces/tet_blocks.hpp"

namespace hmax {

/// Ds = (u1 - u0, u2 - u0, u3 - u0).
[[nodiscard]] Eigen::Matrix3d edge_vectors(const NodeRows& u, const std::array<TetMesh::Index, 4>& points);
/// The same as kernels take it, column a at U[a].
inline void edge_vectors(const NodeRows& u, const std::array<TetMesh::Index, 4>& points, double (*U)[3]) {
  const NodeRow& first = u[static_cast<std::size_t>(points[0])];
  for (std::size_t a = 0; a < 3; ++a) {
    const NodeRow& row = u[static_cast<std::size_t>(points[a + 1])];
    U[a][0] = row.x - first.x, U[a][1] = row.y - first.y, U[a][2] = row.z - first.z;
  }
}

/// f -= V P g_a at the points of an element of stress P.
void subtract_pull(const RestShape& rest, const std::array<TetMesh::Index, 4>& points,
                   const Eigen::Matrix3d& stress, NodeRows& f);

/// The same of a pull of the kernels.
inline void subtract_pull(const std::array<TetMesh::Index, 4>& points, const double (*pull)[3], NodeRows& f) {
  const auto row = [&](std::size_t a) -> NodeRow& { return f[static_cast<std::size_t>(points[a])]; };
  for (std::size_t a = 0; a < 3; ++a)
    row(a + 1).x -= pull[a][0], row(a + 1).y -= pull[a][1], row(a + 1).z -= pull[a][2];
  row(0).x += (pull[0][0] + pull[1][0]) + pull[2][0];
  row(0).y += (pull[0][1] + pull[1][1]) + pull[2][1];
  row(0).z += (pull[0][2] + pull[1][2]) + pull[2][2];
}

/// -dF/du of one element, points after one another.
using ElementStiffness = Eigen::Matrix<double, 12, 12>;

/// K of an element from differential(dF), that of its stress.
template <class Differential>
ElementStiffness element_stiffness(const RestShape& rest, const Differential& differential) {
  ElementStiffness K;
  for (Eigen::Index b = 1; b < 4; ++b)
    for (Eigen::Index c = 0; c < 3; ++c) {
      // Point b moves along axis c: dF = e_c g_b^T.
      Eigen::Matrix3d dF = Eigen::Matrix3d::Zero();
      dF.row(c) = rest.gradients.row(b - 1);
      const Eigen::Matrix3d pull = rest.volume * differential(dF) * rest.gradients.transpose();
      auto column = K.col(3 * b + c);
      column.head<3>() = -pull.rowwise().sum();
      for (Eigen::Index a = 1; a < 4; ++a) column.segment<3>(3 * a) = pull.col(a - 1);
    }
  for (Eigen::Index c = 0; c < 3; ++c) K.col(c) = -(K.col(3 + c) + K.col(6 + c) + K.col(9 + c));
  return K;
}

/// K of an element of some points from its blocks on and above the diagonal.
/// @param block_of  block_of(a, b, block) writes that of points a <= b
template <int points, class BlockOf>
Eigen::Matrix<double, 3 * points, 3 * points> symmetric_stiffness(const BlockOf& block_of) {
  Eigen::Matrix<double, 3 * points, 3 * points> K;
  double block[3][3];
  for (int a = 0; a < points; ++a)
    for (int b = a; b < points; ++b) {
      block_of(a, b, block);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) K(3 * a + i, 3 * b + j) = K(3 * b + j, 3 * a + i) = block[i][j];
    }
  return K;
}

/// K of an element of StableNeoHookean, or of Corotational.
/// @param law  its kernel
[[nodiscard]] ElementStiffness kernel_stiffness(TetLaw law, const NodeRows& u,
                                                const std::array<TetMesh::Index, 4>& points,
                                                const RestShape& rest, const Lame& lame);

/// The finite elements of a mesh, each with a constant displacement gradient
///   H = Ds Bm,   Ds = (u1 - u0, u2 - u0, u3 - u0),
/// energy V W(H) and forces -V P(H) g_a at its points, where the gradients g_1 ... g_3 of the shape functions
/// are the rows of Bm and g_0 = -(g_1 + g_2 + g_3). Rows u are the displacements of the points: positions
/// would carry their own rounding into the strains, multiplied with the longest edge over the height.
/// Forces of laws that the kernels have, those with Law::kernel, are theirs, as is the stiffness of
/// StableNeoHookean and Corotational.
/// @tparam Law  a class of elasticity.hpp
template <class Law>
class TetElements final : public Elements {
 public:
  /// @param lame  of each region of the mesh
  /// @param pattern  holds the pairs of points of every tetrahedron
  TetElements(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern);

  [[nodiscard]] double energy(const NodeRows& u) const override;
  void add_force(const NodeRows& u, NodeRows& f) const override;
  void write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const override;
  /// values += K = -dF/du [N/m] at u.
  void add_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const;

  void write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const override;
  void visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const override;
  [[nodiscard]] std::size_t pieces() const override { return elements_.size(); }
  [[nodiscard]] ElementParts parts() const override { return {.tetrahedra = blocks_ ? &*blocks_ : nullptr}; }

 private:
  struct Element {
    std::array<Index, 4> points;
    RestShape rest;
    Lame lame;
  };
  static Law law(const NodeRows& u, const Element& e);
  static ElementStiffness stiffness(const NodeRows& u, const Element& e);

  std::vector<Element> elements_;
  std::vector<std::array<Index, 16>> slots_;
  std::optional<TetBlocks> blocks_;
};

template <class Law>
TetElements<Law>::TetElements(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern) {
  elements_.reserve(static_cast<std::size_t>(mesh.tetrahedron_count()));
  slots_.reserve(elements_.capacity());
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    std::array<Index, 4> points;
    for (Eigen::Index a = 0; a < 4; ++a) points[static_cast<std::size_t>(a)] = mesh.tetrahedra(a, t);
    elements_.push_back({points, RestShape(mesh, points), lame[static_cast<std::size_t>(mesh.region(t))]});
    slots_.push_back(pattern.slots(points));
  }
  if constexpr (requires { Law::kernel; }) blocks_.emplace(mesh, lame, Law::kernel);
}

template <class Law>
Law TetElements<Law>::law(const NodeRows& u, const Element& e) {
  return Law(edge_vectors(u, e.points) * e.rest.gradients, e.lame);
}

template <class Law>
double TetElements<Law>::energy(const NodeRows& u) const {
  double sum = 0;
  for (const Element& e : elements_) sum += e.rest.volume * law(u, e).energy();
  return sum;
}

template <class Law>
void TetElements<Law>::write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const {
  for (std::size_t e = 0; e < elements_.size(); ++e)
    W[static_cast<Eigen::Index>(e)] = law(u, elements_[e]).energy();
}

template <class Law>
void TetElements<Law>::add_force(const NodeRows& u, NodeRows& f) const {
  if (blocks_) return blocks_->add_force(u, f);
  for (const Element& e : elements_) subtract_pull(e.rest, e.points, law(u, e).stress(), f);
}

template <class Law>
ElementStiffness TetElements<Law>::stiffness(const NodeRows& u, const Element& e) {
  if constexpr (std::is_same_v<Law, StableNeoHookean> || std::is_same_v<Law, Corotational>)
    return kernel_stiffness(Law::kernel, u, e.points, e.rest, e.lame);
  const Law at = law(u, e);
  return element_stiffness(e.rest, [&](const Eigen::Matrix3d& dF) { return at.differential(dF); });
}

template <class Law>
void TetElements<Law>::visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const {
  for (const Element& e : elements_) visit(e.points, stiffness(u, e));
}

template <class Law>
void TetElements<Law>::write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const {
  std::fill_n(values, pattern.entries(), 0.0);
  add_stiffness(u, pattern, values);
}

template <class Law>
void TetElements<Law>::add_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const {
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const ElementStiffness K = stiffness(u, elements_[t]);
    pattern.add_element(values, slots_[t], elements_[t].points, K);
  }
}

}  // namespace hmax
