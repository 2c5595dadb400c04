/// Meshes as files hold them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "problems/tissue/tet_mesh.hpp"

namespace hmax {

/// A mesh as it was read. Indices are in range and coordinates finite, or reading would have failed; whether
/// the tetrahedra make a valid mesh is for mesh_defects.hpp to say.
struct MeshFile {
  std::string name;                   ///< of the file, as messages tell it
  std::string format;                 ///< "Gmsh 2.2, binary"
  TetMesh mesh;                       ///< coordinates as in the file
  std::vector<std::int64_t> numbers;  ///< of the tetrahedra, as the file counts them
  std::vector<std::int64_t> places;   ///< lines (from 1) or bytes (from 0) where they stand
  bool places_are_bytes = false;
  Eigen::Index triangles = 0;  ///< elements of a surface that were left aside

  /// "NAME, line 12: tetrahedron 7"
  [[nodiscard]] std::string where(Eigen::Index tetrahedron) const;
};

/// A way to write meshes down.
struct MeshFormat {
  std::string_view extension;  ///< ".msh"
  std::string_view name;       ///< for people
  bool written;                ///< by us too
};
std::span<const MeshFormat> mesh_formats();

/// Reads Gmsh .msh (1, 2, 4.1; ASCII and binary), VTK .vtk and .vtu, TetGen .node/.ele (either of the pair),
/// Medit .mesh. Tetrahedra of first order are kept, points, lines and triangles are left aside, other volumes
/// are refused.
/// @throws std::invalid_argument one sentence with file, line or byte, and remedy
MeshFile read_mesh_file(const std::filesystem::path& file);

/// The same from memory. @param name  whose extension tells the format; not for TetGen's pairs
MeshFile read_mesh(const std::string& name, std::string_view text);

/// TetGen's two files.
MeshFile read_tetgen(const std::string& node_name, std::string_view node_text, const std::string& ele_name,
                     std::string_view ele_text);

}  // namespace hmax
