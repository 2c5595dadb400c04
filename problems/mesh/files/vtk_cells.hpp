/// Cells of VTK, in its legacy and its XML files alike; for the sources of the readers only.
#pragma once

#include <span>
#include <vector>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"

namespace hmax {

/// The cells of an unstructured grid: cell i has the points connectivity[offsets[i]] to
/// connectivity[offsets[i + 1] - 1].
struct VtkCells {
  std::vector<std::int64_t> types{}, offsets{}, connectivity{};
  // Of a grid in several pieces: the numbers of the first point and the first cell of this one.
  std::int64_t first_point = 0, first_cell = 0;
};

/// Adds the tetrahedra, and the triangles as a count. @param places  of each cell, or one place for all
/// @param regions  of each cell, or empty
void add_vtk_cells(MeshBuilder& builder, const VtkCells& cells, std::span<const std::int64_t> places,
                   std::span<const std::int64_t> regions, MeshText& text);

/// True for the names by which programs tell the material of each cell.
bool names_vtk_regions(std::string_view name);

}  // namespace hmax
