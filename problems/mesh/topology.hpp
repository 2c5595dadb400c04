/// Edges, faces, boundary and connectedness of a tetrahedral mesh.
#pragma once

#include <array>
#include <vector>

#include "problems/mesh/faces.hpp"
#include "problems/mesh/tet_mesh.hpp"

namespace hmax {

using MeshEdges = Eigen::Matrix<TetMesh::Index, 2, Eigen::Dynamic>;
using MeshTriangles = Eigen::Matrix<TetMesh::Index, 3, Eigen::Dynamic>;

/// The six edges of a tetrahedron by its own corners 0 to 3.
inline constexpr std::array<std::array<int, 2>, 6> tetrahedron_edges{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// The edges of a mesh, each once, lower point first, sorted.
struct EdgeTable {
  MeshEdges edges;                    ///< shape (2, edges)
  std::vector<TetMesh::Index> first;  ///< edges first[a] to first[a + 1] start at point a; shape (points + 1)

  /// The edge between two points in any order, or -1. Logarithmic in the edges of a point.
  [[nodiscard]] TetMesh::Index find(TetMesh::Index a, TetMesh::Index b) const;
};

EdgeTable edge_table(const TetMesh& mesh);
inline MeshEdges edges_of(const TetMesh& mesh) { return edge_table(mesh).edges; }

/// The pairs of points of each element, each once, lower point first, sorted: the edges, and of ten nodes all
/// pairs of them.
MeshEdges element_pairs(const TetMesh& mesh);

/// The pairs of points with at most two edges between them, each once, lower point first, sorted: points of
/// tetrahedra that share a point.
MeshEdges two_edge_pairs(const EdgeTable& table);

/// What a mesh looks like from outside.
struct MeshSurface {
  MeshTriangles triangles;              ///< faces of one tetrahedron only, outward, in the order of these
  MeshEdges edges;                      ///< of the triangles, as in EdgeTable
  std::vector<TetMesh::Index> points;   ///< of the triangles, sorted
  std::vector<TetMesh::Index> inside;   ///< of each triangle: its tetrahedron
  Eigen::Index faces = 0;               ///< different faces of the mesh, inner ones counted
  std::vector<TetMesh::Index> crowded;  ///< a tetrahedron of each face of more than two: no solid has them
};

MeshSurface surface_of(const TetMesh& mesh);

/// The counts of a mesh.
struct MeshTopology {
  Eigen::Index points = 0, edges = 0, faces = 0, tetrahedra = 0;
  Eigen::Index surface_points = 0, surface_edges = 0, surface_triangles = 0;
  Eigen::Index components = 0;     ///< parts that share no point
  Eigen::Index unused_points = 0;  ///< in no tetrahedron
  Eigen::Index crowded_faces = 0;  ///< of more than two tetrahedra

  /// Points - edges + faces - tetrahedra without the unused points: 1 for a solid that can be shrunk to a
  /// point, less by one for each handle, more by one for each hollow.
  [[nodiscard]] Eigen::Index euler() const { return points - unused_points - edges + faces - tetrahedra; }
  /// The same of the surface; twice that of the solid where the surface is a manifold.
  [[nodiscard]] Eigen::Index surface_euler() const {
    return surface_points - surface_edges + surface_triangles;
  }
};

MeshTopology topology_of(const TetMesh& mesh);

/// The points that are in no tetrahedron.
std::vector<TetMesh::Index> unused_points(const TetMesh& mesh);

}  // namespace hmax
