/// Meshes as files hold them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// Points, lines or triangles that a file calls by a number, and perhaps by a name: a physical group of Gmsh,
/// a reference of Medit, a label of VTK, a marker of TetGen.
struct MeshGroup {
  int dimension = 0;                      ///< of its elements: 0 points, 1 lines, 2 triangles
  std::int64_t number = 0;                ///< among the groups of this dimension
  std::string name{};                     ///< empty where it has a number only
  std::vector<TetMesh::Index> corners{};  ///< dimension + 1 points of each element
};

/// What groups of points, lines, triangles and tetrahedra are called, by dimension.
inline constexpr std::array<std::string_view, 4> group_kinds{"vertices", "curve", "surface", "region"};

/// A mesh as it was read. Indices are in range and coordinates finite, or reading would have failed; whether
/// the tetrahedra make a valid mesh is for mesh_defects.hpp to say.
struct MeshFile {
  using Middles = Eigen::Matrix<TetMesh::Index, 6, Eigen::Dynamic>;

  std::string name;                   ///< of the file, as messages tell it
  std::string format;                 ///< "Gmsh 2.2, binary"
  TetMesh mesh;                       ///< coordinates as in the file
  std::vector<std::int64_t> numbers;  ///< of the tetrahedra, as the file counts them
  std::vector<std::int64_t> places;   ///< lines (from 1) or bytes (from 0) where they stand
  bool places_are_bytes = false;
  Eigen::Index triangles = 0;     ///< elements of a surface
  Eigen::Index second_order = 0;  ///< tetrahedra of ten nodes
  /// Points in the middles of the edges of each tetrahedron, in the order of tetrahedron_edges, shape (6,
  /// tetrahedra); -1 in tetrahedra of four nodes. Empty where all have four.
  Middles middles{};
  std::vector<std::int64_t> point_numbers{};      ///< of the points, as the file counts them
  std::map<TetMesh::Index, std::string> names{};  ///< of those regions that have one
  std::vector<MeshGroup> groups{};                ///< by dimension and number
  /// Points that were merged: the number of each in the file, and the point that stands for it.
  std::vector<std::pair<std::int64_t, TetMesh::Index>> merged{};
  /// Points that no file has, each halfway between two others (ten_nodes.hpp): point, one, other.
  std::vector<std::array<TetMesh::Index, 3>> inserted{};
  std::string material{};  ///< where the first material stands, "bar.inp, line 7: "; empty without one
  std::vector<std::string> remarks{};  ///< sentences: what of the file is not in the mesh, but for materials

  /// "NAME, line 12: tetrahedron 7"
  [[nodiscard]] std::string where(Eigen::Index tetrahedron) const;
  /// "bar.inp, line 7: this material is not in a mesh; ..."; empty without one.
  [[nodiscard]] std::string material_left_out() const;
  /// "10", or "10 'parenchyma'"
  [[nodiscard]] std::string region_in_words(TetMesh::Index region) const;
};

/// A mesh that no file has numbered: points and tetrahedra count from 1.
MeshFile counted_from_one(TetMesh mesh, std::string name = {});

/// Reads Gmsh .msh (1, 2, 4.0, 4.1; ASCII and binary), VTK .vtk and .vtu, TetGen .node/.ele (either of the
/// pair), Medit .mesh, Vega .veg, CalculiX and Abaqus .inp, SOFA .scn, FEBio .feb, MuJoCo .xml. Tetrahedra
/// are kept, those of second order as their corners and `middles`; points, lines and triangles are kept where
/// they belong to a group; other volumes are refused.
/// @throws std::invalid_argument one sentence with file, line or byte, and remedy
MeshFile read_mesh_file(const std::filesystem::path& file);

/// The same from memory. @param name  whose extension tells the format; not for TetGen's pairs
MeshFile read_mesh(const std::string& name, std::string_view text);

/// TetGen's two files.
MeshFile read_tetgen(const std::string& node_name, std::string_view node_text, const std::string& ele_name,
                     std::string_view ele_text);

}  // namespace hmax
