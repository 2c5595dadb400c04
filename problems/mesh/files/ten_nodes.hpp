/// Mesh files with tetrahedra of ten nodes, for models that take them.
#pragma once

#include <span>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/topology.hpp"

namespace hmax {

/// What a model takes of the nodes of a tetrahedron.
enum class ElementNodes { four, ten };

/// The mesh with all ten nodes of each tetrahedron (TetMesh::ten_node), cut into eight parts which keep its
/// number, place and region. Edges whose middle the file does not have get a point halfway, behind the points
/// of the file and numbered on (`inserted`). Triangles and lines of groups are cut alike. Of nodes at the
/// same place in the middle of an edge the first is taken.
/// @param file  valid (mesh_defects.hpp)
/// @throws std::invalid_argument  naming file and tetrahedron, where sides are bent so far that an element or
///                                a part of it has no volume, and where an edge has two different middles
MeshFile with_ten_nodes(const MeshFile& file);

/// Each tetrahedron of ten nodes into eight of ten nodes on the same curved sides. Their number is 1; points
/// get no numbers.
MeshFile refined_ten_nodes(const MeshFile& file);

/// A group with each triangle into four and each line into two. @param middles  the point of each edge
/// Elements whose sides are no edges of the mesh are left out.
MeshGroup refined_group(const MeshGroup& group, const EdgeTable& table,
                        std::span<const TetMesh::Index> middles);

/// Numbers those points behind the last that has a number, on from the highest.
void number_new_points(MeshFile& file);

}  // namespace hmax
