/// What a mesh is made of where its tetrahedra do not all hang together.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

/// Tetrahedra that hang together by their faces.
struct MeshPart {
  std::vector<TetMesh::Index> tetrahedra;  ///< sorted
  /// Its points that other parts have too, sorted. Around one of them, or an edge between two, it turns
  /// freely: it is a hinge.
  std::vector<TetMesh::Index> hinges;
};

/// The parts of a mesh, the largest first; of equal ones that with the first tetrahedron.
std::vector<MeshPart> parts_of(const TetMesh& mesh);

/// Tetrahedra that hang together by their points, in parts of which none has one of the points `held`.
/// @param held  sorted
std::vector<std::vector<TetMesh::Index>> loose_parts(const TetMesh& mesh,
                                                     const std::vector<TetMesh::Index>& held);

/// Tetrahedra that hang together by their points, and the rigid motions that supports leave them. What turns
/// about a hinge within a part is not counted.
struct FreePart {
  std::vector<TetMesh::Index> tetrahedra;
  std::vector<TetMesh::Index> points;  ///< sorted
  /// Displacements of `points`, orthonormal columns, shape (3 points, count): 6 where none of them is held,
  /// 3 where one is, 1 where those that are held stand in a line.
  Eigen::MatrixXd motions;
};

/// The parts of a mesh that supports leave free to move as a whole.
/// @param held  sorted
std::vector<FreePart> free_parts(const TetMesh& mesh, const std::vector<TetMesh::Index>& held);

}  // namespace hmax
