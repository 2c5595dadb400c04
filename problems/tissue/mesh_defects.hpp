/// What keeps a mesh that was read from being one that models can rely on, and what can be done about it.
#pragma once

#include <utility>
#include <vector>

#include "problems/tissue/mesh_file.hpp"

namespace hmax {

struct MeshDefects {
  using Index = TetMesh::Index;
  std::vector<Index> inverted;                      ///< tetrahedra of negative volume
  std::vector<Index> degenerate;                    ///< flat ones, is_degenerate()
  std::vector<std::pair<Index, Index>> duplicates;  ///< tetrahedra with the same corners as an earlier one
  std::vector<Index> crowded;                       ///< one tetrahedron of each face that has more than two

  [[nodiscard]] bool none() const {
    return inverted.empty() && degenerate.empty() && duplicates.empty() && crowded.empty();
  }
};

MeshDefects defects_of(const TetMesh& mesh);

/// Turns the inverted tetrahedra. @returns how many there were
Eigen::Index fix_orientation(TetMesh& mesh);

/// @throws std::invalid_argument with a sentence about the first defect: file, place, element, remedy
void require_valid(const MeshFile& file);

/// Numbers regions 0, 1, ... in the order of what they were called; none where there is one region only.
/// @returns what each was called
std::vector<TetMesh::Index> number_regions(TetMesh& mesh);

/// A mesh as models take it, and the way back to the order of its file.
struct MeshImport {
  TetMesh mesh;  ///< valid, in metres, without idle points, in local_order(), regions from 0
  std::vector<TetMesh::Index> file_points, file_tetrahedra;  ///< where each stood in the file, from 0
  std::vector<TetMesh::Index> file_regions;                  ///< what the file calls regions 0, 1, ...
  Eigen::Index file_point_count = 0;                         ///< idle points counted

  /// Values of points in the order of the file; 0 at idle points. @param now  one column each
  [[nodiscard]] Eigen::MatrixXd points_in_file_order(const Eigen::MatrixXd& now) const;
  [[nodiscard]] Eigen::MatrixXd tetrahedra_in_file_order(const Eigen::MatrixXd& now) const;
};

/// @param unit  metres in one unit of the file's coordinates
/// @throws std::invalid_argument for defects, and for units that are not positive
MeshImport import_mesh(const MeshFile& file, double unit);

}  // namespace hmax
