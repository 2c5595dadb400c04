/// Meshes and what was computed on them, as texts that other programs read.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "problems/tissue/tet_mesh.hpp"

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

/// Gmsh 2.2 ASCII; regions are physical groups. Coordinates read back as the same doubles.
std::string msh_text(const TetMesh& mesh);

/// VTK XML for ParaView; regions become the cell data "region". A displacement is a field of three
/// components, by which ParaView warps the rest positions.
/// @throws std::invalid_argument when a field has another number of columns than the mesh has points or
/// tetrahedra
std::string vtu_text(const TetMesh& mesh, const MeshFields& fields = {},
                     VtuEncoding encoding = VtuEncoding::raw);

/// A series in time for ParaView: each instant [s] with its .vtu, as a path from the folder of the .pvd.
std::string pvd_text(std::span<const std::pair<double, std::string>> frames);

}  // namespace hmax
