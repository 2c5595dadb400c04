/// Elastic forces on one point of a body at a time.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "core/positional.hpp"
#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/springs.hpp"
#include "problems/tissue/positional/pieces_at_point.hpp"

namespace hmax {

/// What pieces of a body do to a free point. Displacements q [m] are those of the free points, shape (3
/// points); held points stand at rest.
class PointForces {
 public:
  using Index = TetMesh::Index;

  PointForces() = default;
  PointForces(const PointForces&) = delete;
  PointForces& operator=(const PointForces&) = delete;
  virtual ~PointForces() = default;

  /// f += the force [N] on free point `i` at q, K += -df/dq_i [N/m].
  virtual void add(const Eigen::VectorXd& q, Index i, Eigen::Vector3d& f, Eigen::Matrix3d& K) const = 0;
  /// The free points of each piece, -1 for held ones.
  [[nodiscard]] virtual std::vector<std::vector<Index>> pieces() const = 0;
};

/// The pieces of a body by its free points, and the order in which they are moved.
struct PointPieces {
  std::vector<PointTetrahedron> tetrahedra;
  std::vector<PointSpring> springs;  ///< of the first set
  Colours colours;
};

/// Of linear tetrahedra of a law, the same as TetElements.
/// @param points  how many are free
std::unique_ptr<const PointForces> point_forces_of_law(TetLaw law, std::vector<PointTetrahedron> tetrahedra,
                                                       TetMesh::Index points);

/// Of springs, the same as SpringSet without dampers.
std::unique_ptr<const PointForces> point_forces_of_springs(std::vector<PointSpring> springs,
                                                           const SpringLaw& law, TetMesh::Index points);

}  // namespace hmax
