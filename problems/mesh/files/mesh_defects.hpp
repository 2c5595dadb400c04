/// What keeps a mesh that was read from being one that models can rely on.
#pragma once

#include <utility>
#include <vector>

#include "problems/mesh/files/mesh_file.hpp"

namespace hmax {

struct MeshDefects {
  using Index = TetMesh::Index;
  std::vector<Index> inverted;                      ///< tetrahedra of negative volume
  std::vector<Index> degenerate;                    ///< flat ones, is_degenerate()
  std::vector<std::pair<Index, Index>> duplicates;  ///< tetrahedra with the same corners as an earlier one
  /// Tetrahedra on the same side of the face that they share with an earlier one. Whatever the order of their
  /// corners, the two overlap: an element was folded over, or is truly inverted.
  std::vector<std::pair<Index, Index>> overlaps;
  std::vector<Index> crowded;  ///< one tetrahedron of each face that has more than two

  [[nodiscard]] bool none() const {
    return inverted.empty() && degenerate.empty() && duplicates.empty() && overlaps.empty() &&
           crowded.empty();
  }
};

MeshDefects defects_of(const TetMesh& mesh);

/// Turns the inverted tetrahedra, which is right where the file lists corners in another order, and hides
/// what is truly inverted: require_no_overlap() first. @returns how many there were
Eigen::Index fix_orientation(TetMesh& mesh);

/// @throws std::invalid_argument with a sentence about the first overlap across a face
void require_no_overlap(const MeshFile& file);

/// @throws std::invalid_argument with a sentence about the first defect: file, place, element, remedy
void require_valid(const MeshFile& file);

}  // namespace hmax
