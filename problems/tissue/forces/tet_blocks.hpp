/// Linear tetrahedra in blocks of eight, whose forces the kernels compute.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/kernels/kernels.hpp"
#include "problems/tissue/forces/node_rows.hpp"
#include "problems/tissue/forces/point_strips.hpp"

namespace hmax {

/// The tetrahedra of a mesh with one of the laws of the kernels. They are taken in the order of their lowest
/// points, and neighbours in it are dealt to different blocks, so that a sum is not waited for by the next.
/// The order is fixed by the mesh: the same mesh gives the same bits.
class TetBlocks {
 public:
  using Index = TetMesh::Index;
  static constexpr std::size_t window = 16;  ///< blocks that are dealt to at once

  /// @param lame  of each region of the mesh
  TetBlocks(const TetMesh& mesh, std::span<const Lame> lame, TetLaw law,
            const TissueKernels& kernels = tissue_kernels());

  /// f += the elastic forces [N] at the displacements u, lane after lane of block after block. 8000 take the
  /// threads of parallel_for(), with the same bits for any number.
  void add_force(const NodeRows& u, NodeRows& f) const;

  [[nodiscard]] TetLaw law() const { return law_; }
  [[nodiscard]] const TissueKernels& kernels() const { return *kernels_; }
  [[nodiscard]] std::span<const TetBlock> blocks() const { return blocks_; }
  /// Of each tetrahedron of the mesh: 8 block + lane.
  [[nodiscard]] std::span<const Index> places() const { return places_; }
  /// The corners of an element in ascending order.
  [[nodiscard]] std::array<Index, 4> corners_at(std::size_t place) const;

 private:
  TetLaw law_;
  const TissueKernels* kernels_;
  std::vector<TetBlock> blocks_;
  PointStrips strips_;
  std::vector<Index> places_;
};

}  // namespace hmax
