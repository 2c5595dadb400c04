/// Linear tetrahedra of any elastic law: energy, force and stiffness, one element after the other.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/elements.hpp"
#include "problems/tissue/forces/node_rows.hpp"

namespace hmax {

/// A tetrahedron at rest. Rounding to double comes last: in a sliver the volume is a difference of products.
struct RestShape {
  RestShape(const TetMesh& mesh, const std::array<TetMesh::Index, 4>& points);
  Eigen::Matrix3d gradients;  ///< Bm = (X1 - X0, X2 - X0, X3 - X0)^-1 [1/m]
  double volume;              ///< [m^3], negative when the points are in the other order
};

/// Ds = (u1 - u0, u2 - u0, u3 - u0).
[[nodiscard]] Eigen::Matrix3d edge_vectors(const NodeRows& u, const std::array<TetMesh::Index, 4>& points);

/// The finite elements of a mesh, each with a constant displacement gradient
///   H = Ds Bm,   Ds = (u1 - u0, u2 - u0, u3 - u0),
/// energy V W(H) and forces -V P(H) g_a at its points, where the gradients g_1 ... g_3 of the shape functions
/// are the rows of Bm and g_0 = -(g_1 + g_2 + g_3). Rows u are the displacements of the points: positions
/// would carry their own rounding into the strains, multiplied with the longest edge over the height.
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

  [[nodiscard]] std::size_t size() const override { return elements_.size(); }
  [[nodiscard]] std::array<Index, 4> points(std::size_t element) const override {
    return elements_[element].points;
  }
  [[nodiscard]] double volume(std::size_t element) const { return elements_[element].rest.volume; }
  [[nodiscard]] double energy_density(const NodeRows& u, std::size_t element) const override;
  [[nodiscard]] Stiffness stiffness(const NodeRows& u, std::size_t element) const override;

 private:
  struct Element {
    std::array<Index, 4> points;
    RestShape rest;
    Lame lame;
  };
  static Law law(const NodeRows& u, const Element& e);

  std::vector<Element> elements_;
  std::vector<std::array<Index, 16>> slots_;
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
double TetElements<Law>::energy_density(const NodeRows& u, std::size_t element) const {
  return law(u, elements_[element]).energy();
}

template <class Law>
void TetElements<Law>::add_force(const NodeRows& u, NodeRows& f) const {
  for (const Element& e : elements_) {
    const Eigen::Matrix3d pull = e.rest.volume * law(u, e).stress() * e.rest.gradients.transpose();
    for (std::size_t a = 1; a < 4; ++a)
      as_vector(f[static_cast<std::size_t>(e.points[a])]) -= pull.col(static_cast<Eigen::Index>(a) - 1);
    as_vector(f[static_cast<std::size_t>(e.points[0])]) += pull.rowwise().sum();
  }
}

template <class Law>
Elements::Stiffness TetElements<Law>::stiffness(const NodeRows& u, std::size_t element) const {
  const Element& e = elements_[element];
  const Law at = law(u, e);
  Stiffness K;
  for (Eigen::Index b = 1; b < 4; ++b)
    for (Eigen::Index c = 0; c < 3; ++c) {
      // Point b moves along axis c: dF = e_c g_b^T.
      Eigen::Matrix3d dF = Eigen::Matrix3d::Zero();
      dF.row(c) = e.rest.gradients.row(b - 1);
      const Eigen::Matrix3d pull = e.rest.volume * at.differential(dF) * e.rest.gradients.transpose();
      auto column = K.col(3 * b + c);
      column.template head<3>() = -pull.rowwise().sum();
      for (Eigen::Index a = 1; a < 4; ++a) column.template segment<3>(3 * a) = pull.col(a - 1);
    }
  for (Eigen::Index c = 0; c < 3; ++c) K.col(c) = -(K.col(3 + c) + K.col(6 + c) + K.col(9 + c));
  return K;
}

template <class Law>
void TetElements<Law>::write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const {
  std::fill_n(values, pattern.entries(), 0.0);
  add_stiffness(u, pattern, values);
}

template <class Law>
void TetElements<Law>::add_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const {
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Stiffness K = stiffness(u, t);
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        pattern.add(
            values, slots_[t][4 * a + b], elements_[t].points[b],
            K.template block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b)));
  }
}

}  // namespace hmax
