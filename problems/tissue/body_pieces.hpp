/// A body at rest in pieces: rows of its stiffness, damping and mass, some points at a time.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/tissue_settings.hpp"

namespace hmax {

/// What is needed of a body at rest to make any of its rows: the mesh, and no matrix. Rows are the
/// displacements x, y, z of the free points, which count in local_order() of the mesh
/// (problems/mesh/renumber.hpp), so that the rows of a range of points have most of their entries in columns
/// of that range.
///
/// Rows of a range are those of a TissueBody made of the elements that touch it, and of those around their
/// points where a model averages there: all that acts on a point of the range.
class BodyPieces {
 public:
  using Index = TetMesh::Index;
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  /// Rows of 3 (end - begin) unknowns.
  struct Piece {
    Rows stiffness;  ///< K [N/m], shape (rows, dofs())
    Rows damping;    ///< C of the dampers of springs [N s/m], without alpha M + beta K; no shape where there
                     ///< are none
    Eigen::VectorXd mass;  ///< [kg], shape (rows)
  };
  /// Of each point of a range: points that it acts on in the range, itself among them, and beyond it.
  struct Neighbours {
    std::vector<int> inside, outside;
  };

  /// @param mesh  valid, without unused points
  /// @throws std::invalid_argument  as TissueBody, and for springs with a stiffness relative to the mean of
  /// all
  BodyPieces(const TetMesh& mesh, TissueSettings settings);

  [[nodiscard]] Index free_points() const { return static_cast<Index>(free_points_.size()); }
  [[nodiscard]] Eigen::Index dofs() const { return 3 * static_cast<Eigen::Index>(free_points_.size()); }
  /// Of Rayleigh damping [1/s], [s].
  [[nodiscard]] double alpha() const { return alpha_; }
  [[nodiscard]] double beta() const { return beta_; }
  [[nodiscard]] bool has_dampers() const;

  /// Of the free points begin to end, begin < end. The bits of a row may depend on the range.
  [[nodiscard]] Piece piece(Index begin, Index end) const;
  [[nodiscard]] Neighbours neighbours(Index begin, Index end) const;

 private:
  void set_masses();
  void number_free_points();
  /// The elements with a point among `points`, which rise.
  [[nodiscard]] std::vector<Index> touching(const std::vector<Index>& points) const;
  /// Their points, rising.
  [[nodiscard]] std::vector<Index> points_of(const std::vector<Index>& elements) const;
  /// The elements that act on free points begin to end, with points in their order; `points` are those of
  /// the mesh.
  [[nodiscard]] TetMesh around(Index begin, Index end, std::vector<Index>& points) const;

  TetMesh mesh_;
  TissueSettings settings_;  ///< as any piece has them: at rest, nothing acts
  double alpha_ = 0, beta_ = 0;
  double mass_of_point_ = 0;        ///< where all have the same [kg]
  Index width_ = 0;                 ///< no element has points that lie further apart in the order
  std::vector<Index> free_points_;  ///< their numbers in the mesh, rising
  std::vector<Index> number_;  ///< of each point of the mesh among the free ones; -1 of those that are held
  MeshEdges pairs_;            ///< of points that act on each other
};

}  // namespace hmax
