/// Meshes and what was computed on them, as texts that other programs read.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "problems/mesh/files/mesh_file.hpp"

namespace hmax {

/// Values on a mesh, shape (components, points) or (components, tetrahedra).
struct MeshField {
  std::string name;
  Eigen::MatrixXd values;
};

struct MeshFields {
  std::vector<MeshField> points, tetrahedra;
};

enum class VtuEncoding { ascii, base64, raw };

/// Gmsh 2.2 ASCII with the numbers of points and tetrahedra, physical groups and their names. Coordinates
/// read back as the same doubles. Numbers that Gmsh does not take, below 1, are replaced by those from 1 on.
std::string msh_text(const MeshFile& file);

/// VTK XML for ParaView in the order of the file; regions become the cell data "region". Numbers that do not
/// simply count are the data GlobalNodeId and GlobalElementId; the parts of a tetrahedron of ten nodes share
/// its number. Names of regions are the field data
/// "region_names", and the corners of a group field data such as "surface:30 capsule". A displacement is a
/// field of three components, by which ParaView warps the rest positions.
/// @throws std::invalid_argument when a field has another number of columns than the mesh has points or
/// tetrahedra
std::string vtu_text(const MeshFile& file, const MeshFields& fields = {},
                     VtuEncoding encoding = VtuEncoding::raw);

/// The same of a mesh that no file has numbered.
std::string msh_text(const TetMesh& mesh);

/// A series in time for ParaView: each instant [s] with its .vtu, as a path from the folder of the .pvd.
std::string pvd_text(std::span<const std::pair<double, std::string>> frames);

}  // namespace hmax
