/// What the readers of mesh files share; for the sources of the readers only.
#pragma once

#include <array>
#include <vector>

#include "problems/tissue/mesh_file.hpp"
#include "problems/tissue/mesh_text.hpp"

namespace hmax {

MeshFile read_gmsh(const std::string& name, std::string_view text);
MeshFile read_gmsh_4(MeshText& text, bool binary, bool swapped);
MeshFile read_vtk(const std::string& name, std::string_view text);
MeshFile read_vtu(const std::string& name, std::string_view text);
MeshFile read_medit(const std::string& name, std::string_view text);

/// Collects a mesh point by point, in whatever order and numbering.
class MeshBuilder {
 public:
  using Index = TetMesh::Index;

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
  Index numbered_point(std::int64_t number, const MeshText& text, std::int64_t element) const;
  /// The point with this number where the file counts its points from `first`.
  Index counted_point(std::int64_t number, int first, const MeshText& text, std::int64_t element) const;

  /// @param number  as the file counts elements; @param place  where it begins
  void add_tetrahedron(const std::array<Index, 4>& corners, std::int64_t number, std::int64_t place,
                       std::int64_t region, const MeshText& text);
  /// Several tetrahedra at once get their regions afterwards.
  void set_region(std::size_t tetrahedron, std::int64_t region, const MeshText& text);
  void add_triangles(std::size_t count) { triangles_ += count; }

  /// What was collected. @throws std::invalid_argument when there is no tetrahedron
  MeshFile finish(const MeshText& text, std::string format);

 private:
  std::vector<double> points_;
  std::vector<Index> corners_, regions_;
  std::vector<std::int64_t> element_numbers_, places_;
  std::vector<std::pair<std::int64_t, Index>> by_number_;
  std::vector<Index>
      dense_;  ///< the point of each number, -1 where there is none; empty if numbers are sparse
  std::size_t triangles_ = 0;
  bool regions_differ_ = false;
};

/// The type of a cell in the words of its format, as far as it matters here.
enum class CellKind { tetrahedron, flat, triangle, high_order, other_volume, unknown };

/// Refuses what is neither a tetrahedron nor flat.
void require_readable(CellKind kind, std::int64_t type, std::int64_t element, const MeshText& text);

}  // namespace hmax
