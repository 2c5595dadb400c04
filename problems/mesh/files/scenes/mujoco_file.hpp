/// The models of MuJoCo, .xml, as far as they hold a flexcomp of tetrahedra.
#pragma once

#include <string_view>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/scenes/xml_file.hpp"

namespace hmax {

/// The tag that all others of a model are in.
inline constexpr std::string_view mujoco_root = "mujoco";

/// The name of the group of points that are pinned.
inline constexpr std::string_view mujoco_pinned = "pin";

/// The one flexcomp. @throws std::invalid_argument  where there is none, and where there are several
const XmlPart& mujoco_flexcomp(const XmlFile& file);

/// The tetrahedra of the flexcomp, of type grid, direct or gmsh, where its bodies and frames place it; the
/// group is mujoco_pinned. @throws std::invalid_argument  one sentence with file, line and remedy
MeshFile mujoco_mesh(const XmlFile& file);

}  // namespace hmax
