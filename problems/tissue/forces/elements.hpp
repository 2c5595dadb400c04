/// The finite elements of a mesh, whatever their law.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/node_rows.hpp"

namespace hmax {

/// Tetrahedra with elastic forces. A virtual call serves the whole mesh. Rows u are the displacements [m] of
/// all points.
class Elements {
 public:
  using Index = TetMesh::Index;
  using Stiffness = Eigen::Matrix<double, 12, 12>;  ///< -dF/du of one element, points after one another

  Elements() = default;
  Elements(const Elements&) = default;
  Elements(Elements&&) = default;
  Elements& operator=(const Elements&) = default;
  Elements& operator=(Elements&&) = default;
  virtual ~Elements() = default;

  /// Elastic energy [J] at u.
  [[nodiscard]] virtual double energy(const NodeRows& u) const = 0;
  /// f += the elastic forces [N] at u.
  virtual void add_force(const NodeRows& u, NodeRows& f) const = 0;
  /// values = K = -dF/du [N/m] at u, in the pattern that the elements were made with.
  virtual void write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const = 0;

  /// The number of elements. Element e is tetrahedron e of the mesh.
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// The corners of an element, in the order of its stiffness.
  [[nodiscard]] virtual std::array<Index, 4> points(std::size_t element) const = 0;
  /// Energy density [J/m^3] of an element.
  [[nodiscard]] virtual double energy_density(const NodeRows& u, std::size_t element) const = 0;
  /// The stiffness of an element.
  [[nodiscard]] virtual Stiffness stiffness(const NodeRows& u, std::size_t element) const = 0;
};

}  // namespace hmax
