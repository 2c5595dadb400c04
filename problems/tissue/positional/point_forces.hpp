/// Elastic forces on one point of a body at a time.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/springs.hpp"

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

/// Of linear tetrahedra of a law, the same as TetElements<Law>.
/// @param lame  of each region
/// @param free  number of each point of the mesh among the free ones, -1 for held ones
template <class Law>
std::unique_ptr<const PointForces> point_forces_of_law(const TetMesh& mesh, std::span<const Lame> lame,
                                                       std::span<const TetMesh::Index> free);

extern template std::unique_ptr<const PointForces> point_forces_of_law<SmallStrain>(
    const TetMesh&, std::span<const Lame>, std::span<const TetMesh::Index>);
extern template std::unique_ptr<const PointForces> point_forces_of_law<GreenStrain>(
    const TetMesh&, std::span<const Lame>, std::span<const TetMesh::Index>);
extern template std::unique_ptr<const PointForces> point_forces_of_law<Corotational>(
    const TetMesh&, std::span<const Lame>, std::span<const TetMesh::Index>);
extern template std::unique_ptr<const PointForces> point_forces_of_law<StableNeoHookean>(
    const TetMesh&, std::span<const Lame>, std::span<const TetMesh::Index>);

/// Of springs, the same as SpringSet without dampers.
/// @param rest  positions of the points of the mesh, shape (3, points)
std::unique_ptr<const PointForces> point_forces_of_springs(const Eigen::Matrix3Xd& rest,
                                                           const SpringSet& springs,
                                                           std::span<const TetMesh::Index> free);

}  // namespace hmax
