/// Tetrahedra of Green's strain in blocks of eight: the fast form of TetElements<GreenStrain>.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/elements.hpp"
#include "problems/tissue/forces/kernels/kernels.hpp"
#include "problems/tissue/forces/node_rows.hpp"
#include "problems/tissue/forces/tet_blocks.hpp"

namespace hmax {

/// St. Venant-Kirchhoff elements, see TissueKernels. Rows u are the displacements of the points.
class GreenElements final : public Elements {
 public:
  /// @param lame     of each region of the mesh
  /// @param pattern  holds the pairs of points of every tetrahedron
  GreenElements(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern,
                const TissueKernels& kernels = tissue_kernels());

  [[nodiscard]] double energy(const NodeRows& u) const override;
  void add_force(const NodeRows& u, NodeRows& f) const override { blocks_.add_force(u, f); }
  void write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const override;

  void write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const override;
  /// Corners of a tetrahedron come in ascending order.
  void visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const override;
  [[nodiscard]] std::size_t pieces() const override { return blocks_.places().size(); }
  [[nodiscard]] ElementParts parts() const override { return {.tetrahedra = &blocks_}; }

 private:
  /// One tetrahedron taken out of its block.
  struct Element;
  [[nodiscard]] Element element(const NodeRows& u, std::size_t place) const;

  /// Elements whose sums are finished with them.
  struct Batch {
    std::size_t end;  ///< of blocks
    Index columns;    ///< of the stiffness that are finished after them
    Index highest;    ///< column that they or those before them add to
  };
  /// Columns first .. last - 1 of the stiffness, to which no batch before `batch` adds.
  struct Strip {
    Index first, last;
    std::size_t batch;
  };

  void make_batches(const BlockPattern& pattern);
  void place_rim(const BlockPattern& pattern);
  /// At most so many strips of all columns with about as many blocks; none where one would need most of the
  /// blocks.
  [[nodiscard]] std::vector<Strip> stiffness_strips(std::size_t count) const;
  /// The columns of a strip: all batches that add to them, in their order.
  void write_strip(const NodeRows& u, const BlockPattern& pattern, const Strip& strip,
                   BlockPattern::Pairs& pairs, double* values) const;

  TetBlocks blocks_;
  std::vector<TetSlots> slots_;
  std::vector<Batch> batches_;
  Index ring_ = 0;          ///< blocks of pairs whose sums are not finished, at most
  std::vector<Index> rim_;  ///< columns of pairs with a supported point, whose blocks follow the ring
};

}  // namespace hmax
