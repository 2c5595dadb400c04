/// Meshes as users ask for them: a file or a name, with parameters behind colons.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "problems/mesh/files/mesh_import.hpp"
#include "problems/mesh/files/mesh_names.hpp"
#include "problems/mesh/files/ten_nodes.hpp"

namespace hmax {

/// A mesh as it stands in its file, or as its generator makes it, before anybody relies on it.
struct OpenedMesh {
  MeshFile file;                     ///< refined and mended if that was asked for
  bool from_file = false;            ///< else by name, in metres and valid
  std::optional<Mending> mending{};  ///< if asked for, in the unit of the file
};

/// What is done to points at exactly the same place where the text does not say it with `:merge=TOL` or
/// `:merge=off`. hmax has no contact between the parts of a mesh: parts that touch without sharing points
/// would pass through each other. So models merge them; whoever looks at a file sees it as it is.
enum class CoincidentPoints { merged, kept };

/// @param text   a name such as `ball:n=6`, or a file; both take `:refine=K`, `:mend=N` and `:merge=TOL`
/// @param nodes  ten: the mesh has TetMesh::ten_node, with the middles of the file or inserted ones
/// @throws InputError naming file, line and remedy, or the nearest known name
OpenedMesh open_mesh(const std::string& text, CoincidentPoints coincident = CoincidentPoints::merged,
                     ElementNodes nodes = ElementNodes::four);

/// What is to be said of what was not read, of points that were merged, and of those that nearly coincide and
/// were not. Sentences.
std::vector<std::string> remarks_on_mesh(const MeshFile& file);

/// The same mesh with about an eighth of its tetrahedra: refined once less, or with half as many points along
/// its edges; empty where it has no such parameter. As many of them are mended.
std::string coarser_mesh(const std::string& text);

/// The same mesh with `count` of the tetrahedra mended that limit explicit steps most; empty where it asks
/// for that itself.
std::string mended_mesh(const std::string& text, int count);

/// Metres of "m", "cm", "mm" or of a number of metres.
double unit_in_metres(std::string_view text);

/// A mesh for models. Meshes from files, and those by name of 5000 tetrahedra and more, are renumbered for
/// locality; all know the way back.
struct LoadedMesh {
  std::string name;  ///< as asked for
  TetMesh mesh;
  std::shared_ptr<const MeshOrigin> origin;
};

/// @param unit  metres in one unit of a file's coordinates, as the user states it. Files do not say it and it
///              is never guessed: without it a file is refused with the size of its box. Meshes by name are
///              in metres, and refuse any other unit.
/// @throws InputError as open_mesh, and for defects of the mesh and a unit that is missing or too much
LoadedMesh load_mesh(const std::string& text, std::optional<double> unit = {},
                     ElementNodes nodes = ElementNodes::four);

/// The same where the caller renumbers the mesh: one by name keeps its order.
LoadedMesh load_mesh_to_renumber(const std::string& text, std::optional<double> unit = {},
                                 ElementNodes nodes = ElementNodes::four);

/// "0.22 x 0.15 x 0.16", the sides of the box around a mesh.
std::string box_in_words(const TetMesh& mesh, double unit = 1);

}  // namespace hmax
