/// From a mesh file to a mesh that models take, and from the results of models back to the file.
#pragma once

#include <vector>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/mend.hpp"

namespace hmax {

/// Where the points, tetrahedra and regions of a mesh for models come from.
struct MeshOrigin {
  MeshFile file;                              ///< in its own order, in metres
  std::vector<TetMesh::Index> points;         ///< where each point stands in the file, from 0
  std::vector<TetMesh::Index> tetrahedra;     ///< the same of the tetrahedra
  std::vector<TetMesh::Index> regions = {0};  ///< what the file calls regions 0, 1, ...

  /// The number of a tetrahedron, and of a point, in the file.
  [[nodiscard]] std::int64_t tetrahedron_number(Eigen::Index tetrahedron) const;
  [[nodiscard]] std::int64_t point_number(Eigen::Index point) const;
  /// Values in the order of the file; 0 at points that are in no tetrahedron. @param now  one column each
  [[nodiscard]] Eigen::MatrixXd on_points(const Eigen::MatrixXd& now) const;
  [[nodiscard]] Eigen::MatrixXd on_tetrahedra(const Eigen::MatrixXd& now) const;
  /// The point of the mesh for models of each point of the file; -1 of those in no tetrahedron.
  [[nodiscard]] std::vector<TetMesh::Index> model_points() const;
};

/// A mesh as models take it: valid, in metres, without idle points, regions from 0.
struct MeshImport {
  TetMesh mesh;
  MeshOrigin origin;
};

/// The mesh of a file, in local_order().
/// @param unit  metres in one unit of the file's coordinates
/// @throws std::invalid_argument for defects, and for units that are not positive
MeshImport import_mesh(MeshFile file, double unit);

/// A mesh that models can take as it is, in its own order.
MeshImport import_as_it_is(MeshFile file);

/// Makes one point of those that coincide (coincident_points.hpp): the first of them stays, with its number,
/// and the numbers of the others are kept in `merged`.
/// @param tolerance  share of the shortest edge at a point, from 0: exactly the same place
/// @returns how many points are gone
/// @throws std::invalid_argument for a tolerance that would make a tetrahedron flat
Eigen::Index merge_points(MeshFile& file, double tolerance);

/// Each tetrahedron into eight (refine.hpp), each triangle of a group into four, each line into two. Points
/// keep their numbers and the new ones follow; tetrahedra count from 1. With `middles` the parts have ten
/// nodes again, on the same curved sides.
MeshFile refined(const MeshFile& file, int times);

/// Mends `count` tetrahedra (mend.hpp); points of groups stay, and `middles` go along. Lengths of the result
/// are in the unit of the file.
Mending mend(MeshFile& file, TetMesh::Index count);

/// The file in local_order(), points and tetrahedra counted from 1.
MeshFile renumbered(const MeshFile& file);

/// Numbers regions 0, 1, ... in the order of what they were called; none where there is one region only.
/// @returns what each was called
std::vector<TetMesh::Index> number_regions(TetMesh& mesh);

}  // namespace hmax
