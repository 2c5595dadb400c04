/// The finite elements of a mesh, whatever their law.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/node_rows.hpp"

namespace hmax {

class TetBlocks;          // problems/tissue/forces/tet_blocks.hpp
class NodalPressure;      // problems/tissue/forces/nodal_pressure.hpp
class QuadraticElements;  // problems/tissue/forces/quadratic_elements.hpp
class FibreElements;      // problems/tissue/forces/fibres.hpp

/// What Elements::add_force() adds, one after the other; null what there is none of. None but fibres: more
/// than these.
struct ElementParts {
  const TetBlocks* tetrahedra = nullptr;
  const NodalPressure* of_pressures = nullptr;
  const QuadraticElements* of_ten_nodes = nullptr;
  const FibreElements* fibres = nullptr;
};

/// Takes the points of a piece of an elastic body and its symmetric K = -dF/du [N/m], points after one
/// another, shape (3 points, 3 points).
using StiffnessVisitor =
    std::function<void(std::span<const TetMesh::Index>, const Eigen::Ref<const Eigen::MatrixXd>&)>;

/// Tetrahedra with elastic forces. A virtual call serves the whole mesh. Rows u are the displacements [m] of
/// all points.
class Elements {
 public:
  using Index = TetMesh::Index;

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

  /// W = energy densities [J/m^3] of the tetrahedra at u, parts of elements among them, shape (tetrahedra).
  virtual void write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const = 0;
  /// Calls visit(points, K) for the pieces that the stiffness at u is the sum of: the elements of the mesh
  /// (TetMesh::element) in their order, then what acts on several of them.
  virtual void visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const = 0;
  /// The number of these pieces.
  [[nodiscard]] virtual std::size_t pieces() const = 0;
  /// Of elements that other rooms compute too.
  [[nodiscard]] virtual ElementParts parts() const { return {}; }
};

}  // namespace hmax
