/// What the readers of mesh files share; for the sources of the readers only.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "problems/mesh/files/mesh_text.hpp"
#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

struct MeshFile;  // problems/mesh/files/mesh_file.hpp
class XmlFile;    // problems/mesh/files/scenes/xml_file.hpp
struct XmlPart;

MeshFile read_gmsh(const std::string& name, std::string_view text);
/// @param version  "4.0" or "4.1"
MeshFile read_gmsh_4(MeshText& text, bool binary, bool swapped, std::string_view version);
MeshFile read_vtk(const std::string& name, std::string_view text);
MeshFile read_vtu(const std::string& name, std::string_view text);
MeshFile read_medit(const std::string& name, std::string_view text);
MeshFile read_vega(const std::string& name, std::string_view text);
MeshFile read_inp(const std::string& name, std::string_view text);
MeshFile read_sofa(const std::string& name, std::string_view text);
MeshFile read_febio(const std::string& name, std::string_view text);
MeshFile read_mujoco(const std::string& name, std::string_view text);

/// An attribute of a part of XML.
struct XmlList {
  const XmlPart& part;
  std::string_view attribute;
};
/// The mesh of three coordinates of each point, and of four points of each tetrahedron, counted from 0.
/// @throws std::invalid_argument  naming file, line and attribute
MeshFile listed_mesh(const XmlFile& file, const XmlList& points, const XmlList& corners,
                     const std::string& format);

/// A group of points with the first number behind those of the others; none where it is empty.
void add_points_group(MeshFile& file, std::string_view name, const std::set<TetMesh::Index>& points);

/// Columns behind those that a reader needs. Nobody uses them, but each row has as many as the first one: a
/// row of another length has lost or gained a number.
class ExtraColumns {
 public:
  /// Goes to the end of the row. @param row  what it holds, for the error
  void skip(MeshText& text, const char* row);

 private:
  std::optional<std::size_t> count_;
};

/// The edges in whose middles the nodes 4 to 9 of a tetrahedron of second order lie, by their two corners.
using MiddleOrder = std::array<std::array<int, 2>, 6>;
/// Of VTK, Medit, Abaqus, CalculiX and FEBio.
inline constexpr MiddleOrder middles_of_vtk{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// Collects a mesh point by point, in whatever order and numbering.
class MeshBuilder {
 public:
  using Index = TetMesh::Index;

  /// @param first  the number of the first point, where points are counted
  explicit MeshBuilder(std::int64_t first = 0) : first_(first) {}

  void reserve_points(std::size_t points);
  void reserve_tetrahedra(std::size_t tetrahedra);
  std::size_t point_count() const { return points_.size() / 3; }
  std::size_t tetrahedron_count() const { return corners_.size() / 4; }

  void add_point(double x, double y, double z);
  /// A point with a number of its own.
  void add_point(std::int64_t number, double x, double y, double z);
  /// To be called after the last numbered point. @throws std::invalid_argument when two have the same
  void number_points(const MeshText& text);
  /// The point with this number. @throws std::invalid_argument when there is none
  /// @param what  needs it: "tetrahedron", with the number `element`
  Index numbered_point(std::int64_t number, const MeshText& text, std::int64_t element,
                       const char* what = "tetrahedron") const;
  /// The same where points are counted.
  Index counted_point(std::int64_t number, const MeshText& text, std::int64_t element,
                      const char* what = "tetrahedron") const;

  /// @param number  as the file counts elements; @param place  where it begins
  void add_tetrahedron(const std::array<Index, 4>& corners, std::int64_t number, std::int64_t place,
                       std::int64_t region, const MeshText& text);
  /// Several tetrahedra at once get their regions afterwards.
  void set_region(std::size_t tetrahedron, std::int64_t region, const MeshText& text);
  void add_triangles(std::size_t count) { triangles_ += count; }
  /// The last tetrahedron has ten nodes. @param middles  in the order of the format
  /// @param edges  of the middles, in that order
  void add_middles(std::span<const Index, 6> middles, const MiddleOrder& edges);
  /// An element of the group with this number; 0 is none. @param corners  dimension + 1 points
  void add_to_group(std::int64_t group, std::span<const Index> corners);
  /// @param dimension  3 for a region
  void name_group(std::int64_t dimension, std::int64_t number, std::string name, const MeshText& text);
  /// A tetrahedron is of `region` and of this one too, which is left out.
  void note_second_region(std::int64_t region, std::int64_t second) {
    second_regions_.emplace(region, second);
  }

  /// What was collected. @throws std::invalid_argument when there is no tetrahedron
  MeshFile finish(const MeshText& text, std::string format);

 private:
  std::int64_t first_;
  std::vector<double> points_;
  std::vector<Index> corners_, regions_;
  std::vector<Index> middles_;  ///< six of each tetrahedron up to the last one that has them
  std::vector<std::int64_t> element_numbers_, places_;
  std::vector<std::pair<std::int64_t, Index>> by_number_;
  std::vector<Index>
      dense_;  ///< the point of each number, -1 where there is none; empty if numbers are sparse
  std::size_t triangles_ = 0, second_order_ = 0;
  std::map<std::pair<std::int64_t, std::int64_t>, std::string> names_;  ///< by dimension and number
  std::map<std::pair<int, std::int64_t>, std::vector<Index>> groups_;
  std::set<std::pair<std::int64_t, std::int64_t>> second_regions_;
  bool regions_differ_ = false;
};

/// The type of a cell in the words of its format, as far as it matters here.
enum class CellKind { tetrahedron, triangle, line, point, flat, high_order, other_volume, unknown };

/// The points of an element that are read: its corners; 0 of what is left aside.
constexpr std::size_t corner_count(CellKind kind) {
  return kind > CellKind::point ? 0 : 4 - static_cast<std::size_t>(kind);
}

/// Refuses what is neither a tetrahedron nor flat.
void require_readable(CellKind kind, std::int64_t type, std::int64_t element, const MeshText& text);

}  // namespace hmax
