/// Meshes by name: those of problems/meshes, and the generators with their parameters.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/embedded_text.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// Sorted by name.
std::span<const EmbeddedText> mesh_texts();

/// A mesh as it is asked for: "ball:n=6,radius=0.04:refine=1" is `ball` with n = 6, radius = 0.04, refine
/// = 1.
struct MeshRequest {
  std::string name;  ///< of a mesh or a file
  std::vector<std::pair<std::string, double>> parameters;
};

/// What `merge=off` stands for.
inline constexpr double merge_off = -1;

/// Takes what looks like :key=number,key=number from the end; a name may hold other colons.
/// @throws std::invalid_argument when a parameter is no number or is given twice
MeshRequest parse_mesh_request(std::string_view text);

/// A mesh that has a name, with the parameters it takes and their defaults. All of them take `refine`,
/// `mend` and `merge` too.
struct NamedMesh {
  std::string name;
  std::vector<std::pair<std::string, double>> parameters{};
  std::string description{};
  int held_axis =
      3;  ///< where it is held by default: 1, 2, 3: at its low end along x, y, z; -1, -2, -3: at the high one
};

/// phantom, liver, beam, cube, ball.
const std::vector<NamedMesh>& named_meshes();

/// Null for a name that none of them has, as that of a file.
const NamedMesh* find_named_mesh(std::string_view name);

/// What is done to a mesh, whether it comes by name or from a file.
struct MeshModifiers {
  int refine = 0;           ///< how often
  TetMesh::Index mend = 0;  ///< how many tetrahedra, after the refinements
  /// Share of the shortest edge within which points are merged, before all others; negative: not at all.
  std::optional<double> merge{};

  [[nodiscard]] bool any() const { return refine > 0 || mend > 0; }
};

/// `refine`, `mend` or `merge`.
bool is_modifier(std::string_view parameter);

/// @throws std::invalid_argument unless the first two are whole and 0 or more, and `merge` a share of an edge
/// or "off"
MeshModifiers modifiers_of(const MeshRequest& request);

/// Refines and mends a valid mesh as asked for.
/// @returns what was mended, in the unit of the mesh; nothing where that was not asked for
std::optional<Mending> modify(MeshFile& file, const MeshModifiers& modifiers);

/// The mesh of this name, in metres, in the order of its file or generator, without its modifiers.
/// @throws std::invalid_argument as mesh_by_name
TetMesh unmodified_mesh(const MeshRequest& request);

/// The same, refined and mended as asked for.
/// @throws std::invalid_argument for a name or parameter that is unknown, naming the known ones, and for
///         parameters out of range
TetMesh mesh_by_name(const MeshRequest& request);
inline TetMesh mesh_by_name(std::string_view text) { return mesh_by_name(parse_mesh_request(text)); }

}  // namespace hmax
