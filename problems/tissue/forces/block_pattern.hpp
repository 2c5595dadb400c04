/// The one sparsity pattern that stiffness and damping of a tissue model share: blocks of 3 x 3.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "problems/mesh/topology.hpp"
#include "problems/tissue/forces/node_rows.hpp"

namespace hmax {

/// Where the blocks of a symmetric pattern stand in the value array of a compressed, column-major sparse
/// matrix over the free points. Block (i, j) couples points i and j of the mesh; its entry (r, c) is
///   values[slot(i, j) + c * stride(j) + r].
/// Both triangles and every diagonal block are in the pattern.
class BlockPattern {
 public:
  using Matrix = Eigen::SparseMatrix<double>;
  using Index = TetMesh::Index;

  BlockPattern() = default;
  /// @param free   of every point: its number among the free ones, from 0 in the order of the mesh, or -1 for
  ///               a supported one
  /// @param pairs  points that act on each other, in any order, repeated or not, shape (2, pairs)
  /// @throws std::invalid_argument  when there are more entries than an index of the matrix can count
  BlockPattern(std::vector<Index> free, const MeshEdges& pairs);

  [[nodiscard]] Index dofs() const { return 3 * static_cast<Index>(first_.size() - 1); }
  [[nodiscard]] Index entries() const { return 9 * first_.back(); }
  [[nodiscard]] const std::vector<Index>& free() const { return free_; }

  /// Where block (i, j) begins; -1 when i or j is supported. The pair must be in the pattern.
  [[nodiscard]] Index slot(Index i, Index j) const;
  /// From one column of the blocks of point j to the next; 0 for a supported one.
  [[nodiscard]] Index stride(Index j) const { return stride_[static_cast<std::size_t>(j)]; }
  /// The slots of all pairs of k points, row after row, shape (k * k).
  template <std::size_t k>
  [[nodiscard]] std::array<Index, k * k> slots(const std::array<Index, k>& points) const {
    std::array<Index, k * k> all;
    for (std::size_t a = 0; a < k; ++a)
      for (std::size_t b = 0; b < k; ++b) all[k * a + b] = slot(points[a], points[b]);
    return all;
  }

  /// Adds a block at a slot; nothing for slot -1.
  template <class Block>
  void add(double* values, Index slot, Index j, const Block& block) const {
    if (slot < 0) return;
    for (int c = 0; c < 3; ++c)
      Eigen::Map<Eigen::Vector3d>(values + slot + std::ptrdiff_t{c} * stride(j)) += block.col(c);
  }

  /// values += K of an element at the slots of its k points, shape (3 k, 3 k).
  template <std::size_t k, class Stiffness>
  void add_element(double* values, const std::array<Index, k * k>& slots, const std::array<Index, k>& points,
                   const Stiffness& K) const {
    for (std::size_t a = 0; a < k; ++a)
      for (std::size_t b = 0; b < k; ++b)
        add(values, slots[k * a + b], points[b],
            K.template block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b)));
  }

  /// The number of the block of a pair i != j among those below the diagonal, column by column; -1 when a
  /// point is supported.
  [[nodiscard]] Index pair(Index i, Index j) const;
  [[nodiscard]] Index columns() const { return static_cast<Index>(first_.size() - 1); }
  /// The first of these blocks in a column or after it; and the last row of a column.
  [[nodiscard]] Index first_pair(Index column) const { return lower_[static_cast<std::size_t>(column)]; }
  [[nodiscard]] Index last_row(Index column) const {
    return rows_[static_cast<std::size_t>(first_[static_cast<std::size_t>(column) + 1]) - 1];
  }

  /// Blocks below the diagonal, three columns of each, one a row. They are kept only while they are needed:
  /// block k stands at place k modulo `ring`, shape (3 ring) or longer, and is 0 again once both columns that
  /// it belongs to were written.
  struct Pairs {
    NodeRows rows;
    Index ring = 0;
    std::vector<double> diagonal;  ///< of the columns that are written next: what is not among the pairs
    std::vector<Index> next;  ///< of each column: the place of its first block whose other column was not
                              ///< written
    /// The block at a place, which moves on to the next.
    double* take(Index& place) {
      double* const block = &rows.front().x + 12 * static_cast<std::ptrdiff_t>(place);
      if (++place == ring) place = 0;
      return block;
    }
  };
  /// Begins a matrix: columns before this one are taken for written.
  void begin(Index column, Pairs& pairs) const;

  /// Writes the next columns, begin .. end - 1, of the matrix of forces that act between points alone, each
  /// row of which sums to zero. What pairs with a supported point add to the diagonal blocks must be in
  /// `diagonal` by then.
  void write(Index begin, Index end, Pairs& pairs, double* values) const;
  /// Passes over the next columns: as write(), without a matrix.
  void skip(Index begin, Index end, Pairs& pairs) const;

  /// Gives A this pattern. A matrix that has it already keeps its memory and its values: columns as long and
  /// blocks that begin in the same rows.
  void shape(Matrix& A) const;
  /// The same, with all values 0.
  void clear(Matrix& A) const;

 private:
  std::vector<Index> free_, stride_;  // by point of the mesh
  std::vector<Index> lower_{0};       // of each free column of blocks: its first block below the diagonal
  std::vector<Index> first_{0};       // of each free column of blocks: its first block
  std::vector<Index> rows_;           // of each block: its row among the free points, ascending in a column
};

}  // namespace hmax
