/// Linear tetrahedra of any elastic law: energy, force and stiffness, one element after the other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elasticity.hpp"
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
class TetElements {
 public:
  using Index = TetMesh::Index;
  using Stiffness = Eigen::Matrix<double, 12, 12>;  ///< -dF/du of one element, points after one another

  /// @param lame  of each region of the mesh
  /// @param pattern  holds the pairs of points of every tetrahedron
  TetElements(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern);

  /// Elastic energy [J] at the displacements u.
  [[nodiscard]] double energy(const NodeRows& u) const;
  /// f += the elastic forces [N] at u.
  void add_force(const NodeRows& u, NodeRows& f) const;
  /// values += K = -dF/du [N/m] at u.
  void add_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const;

  [[nodiscard]] std::size_t size() const { return elements_.size(); }
  [[nodiscard]] const std::array<Index, 4>& points(std::size_t element) const {
    return elements_[element].points;
  }
  [[nodiscard]] double volume(std::size_t element) const { return elements_[element].rest.volume; }
  /// Energy density [J/m^3] of one element.
  [[nodiscard]] double energy_density(const NodeRows& u, std::size_t element) const;
  /// The stiffness of one element.
  [[nodiscard]] Stiffness stiffness(const NodeRows& u, std::size_t element) const;

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

extern template class TetElements<SmallStrain>;
extern template class TetElements<GreenStrain>;
extern template class TetElements<Corotational>;
extern template class TetElements<StableNeoHookean>;

}  // namespace hmax
