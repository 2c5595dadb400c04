/// The mesh models: where the elastic forces of a body come from, and what else differs between them.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/elements.hpp"
#include "problems/tissue/forces/kernels/tet_law.hpp"

namespace hmax {

/// A model of SOFA with the same forces: the methods of its linear elements, the materials of its
/// hyperelastic ones.
enum class SofaField { none, small, polar, st_venant_kirchhoff, neo_hookean };

/// A mesh model and its facts. tissue_models() lists all of them.
struct TissueModel {
  using MakeElements = std::shared_ptr<const Elements> (*)(const TetMesh& mesh, std::span<const Lame> lame,
                                                           const BlockPattern& pattern);

  std::string_view id;
  std::string_view note;           ///< one line: what the forces are
  bool is_linear = false;          ///< forces are linear in the displacements, whatever their size
  bool resists_inversion = false;  ///< forces restore every element, flat and inverted ones included
  bool resists_crushing = false;   ///< its energy has the volume itself, so that lost volume pushes back
  /// The largest nominal compression that it carries under uniaxial stress, relative to E; 0: no bound is
  /// known.
  double most_compression = 0;
  bool resists_locking = false;  ///< bends as freely near nu = 1/2 as far from it
  /// All points of the tetrahedra around a point act on each other; false: those of a tetrahedron do.
  bool averages_at_points = false;
  /// Its elements have ten nodes: it takes a mesh with TetMesh::ten_node, all others its tetrahedra.
  bool has_ten_nodes = false;
  SofaField sofa = SofaField::none;
  MakeElements make_elements = nullptr;  ///< null: springs along the edges of the mesh
  /// Of elements that are written point by point too (problems/tissue/positional).
  std::optional<TetLaw> point_law = std::nullopt;
  /// Its small strains are those of two compliant constraints of each tetrahedron.
  bool has_constraints = false;

  [[nodiscard]] constexpr bool is_of_springs() const { return make_elements == nullptr; }
  bool operator==(const TissueModel& other) const { return id == other.id; }
};

/// The pairs of points that act on each other in elements of a model, or along the edges of the mesh.
/// @param table  edges of the mesh
[[nodiscard]] MeshEdges acting_pairs(const TissueModel& model, const TetMesh& mesh, const EdgeTable& table);

/// Poisson's ratio of springs whose stiffness comes from Young's modulus [vangelder1998approximate].
inline constexpr double poisson_of_springs = 0.25;

/// In the order in which they are listed. The first is the default.
[[nodiscard]] std::span<const TissueModel> tissue_models();

/// @throws std::invalid_argument  for an unknown id, naming the known ones
const TissueModel& tissue_model(std::string_view id);

}  // namespace hmax
