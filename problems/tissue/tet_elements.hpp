/// Linear tetrahedra of any elastic law: energy, force and stiffness, one element after the other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "problems/tissue/block_pattern.hpp"
#include "problems/tissue/elasticity.hpp"
#include "problems/tissue/node_rows.hpp"
#include "problems/tissue/tet_mesh.hpp"

namespace hmax {

/// The finite elements of a mesh, each with a constant deformation gradient
///   F = Ds Bm,   Ds = (x1 - x0, x2 - x0, x3 - x0),   Bm = Ds(rest)^-1,
/// energy V W(F) and forces -V P(F) g_a at its points, where the gradients g_1 ... g_3 of the shape functions
/// are the rows of Bm and g_0 = -(g_1 + g_2 + g_3).
/// @tparam Law  a class of elasticity.hpp
template <class Law>
class TetElements {
 public:
  using Index = TetMesh::Index;
  using Stiffness = Eigen::Matrix<double, 12, 12>;  ///< -dF/dx of one element, points after one another

  /// @param lame  of each region of the mesh
  /// @param pattern  holds the pairs of points of every tetrahedron
  TetElements(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern);

  /// Elastic energy [J] at the positions x.
  [[nodiscard]] double energy(const NodeRows& x) const;
  /// f += the elastic forces [N] at x.
  void add_force(const NodeRows& x, NodeRows& f) const;
  /// values += K = -dF/dx [N/m] at x.
  void add_stiffness(const NodeRows& x, const BlockPattern& pattern, double* values) const;

  [[nodiscard]] std::size_t size() const { return elements_.size(); }
  [[nodiscard]] const std::array<Index, 4>& points(std::size_t element) const {
    return elements_[element].points;
  }
  [[nodiscard]] double volume(std::size_t element) const { return elements_[element].volume; }
  /// Energy density [J/m^3] of one element.
  [[nodiscard]] double energy_density(const NodeRows& x, std::size_t element) const;
  /// The stiffness of one element.
  [[nodiscard]] Stiffness stiffness(const NodeRows& x, std::size_t element) const;

 private:
  struct Element {
    std::array<Index, 4> points;
    Eigen::Matrix3d gradients;  ///< Bm [1/m]
    double volume;              ///< [m^3]
    Lame lame;
  };
  static Law law(const NodeRows& x, const Element& e);

  std::vector<Element> elements_;
  std::vector<std::array<Index, 16>> slots_;
};

extern template class TetElements<SmallStrain>;
extern template class TetElements<GreenStrain>;
extern template class TetElements<Corotational>;
extern template class TetElements<StableNeoHookean>;

}  // namespace hmax
