/// The input files of FEBio, .feb, of format 4.0.
#pragma once

#include <string_view>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/scenes/xml_file.hpp"

namespace hmax {

/// The tag that all others of a file are in.
inline constexpr std::string_view febio_root = "febio_spec";

/// The names of the groups of points that boundary conditions fix in x, y and z, and of those that they hold
/// in any other way, also besides that.
inline constexpr std::string_view febio_held = "zero displacement", febio_otherwise_held = "otherwise held";

/// Regions are the Elements, in their order from 1; groups are the NodeSets, the surfaces that a node_set
/// names, febio_held and febio_otherwise_held. @throws std::invalid_argument  one sentence with file, line
/// and remedy
MeshFile febio_mesh(const XmlFile& file);

}  // namespace hmax
