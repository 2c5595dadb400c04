/// Finite elements with fibres: stiffness along one direction.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elements.hpp"
#include "problems/tissue/forces/kernels/element_pull.hpp"

namespace hmax {

/// The fibres of one region.
struct Fibre {
  double young = 0;                                     ///< E_f [Pa]; 0: there are none
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< at rest, of any length
};

/// Elements of any law, and in the same tetrahedra fibres along a unit vector a, with the stretch l = |F a|:
///   W = E_f (l - 1)^2 / 2   for l > 1,   0 for l <= 1: they buckle,
///   P = E_f (l - 1) n a^T,   n = F a / l,
///   dP = E_f (n n^T + (1 - 1/l) (I - n n^T)) dF a a^T.
/// The stiffness jumps at l = 1, where they count as taut, as at rest: a limit there has the larger of the
/// two stiffnesses. It is no bound for motion across the jump, which changes the stiffness twice in every
/// oscillation (docs/reference/tissue.md has numbers). Elements of small strain have linear fibres instead,
/// which also push: l - 1 = a.e a and n = a.
///
/// Pieces are those of the elements: the stiffness of the fibre is a part of its tetrahedron's.
class FibreElements final : public Elements {
 public:
  /// @param matrix        what the fibres lie in, of the same mesh
  /// @param fibres        of each region of the mesh
  /// @param small_strain  of a model of small strain
  /// @param pattern       holds the pairs of points of every tetrahedron
  /// @throws std::invalid_argument  for a negative or infinite E_f, and for fibres without a direction
  FibreElements(std::shared_ptr<const Elements> matrix, const TetMesh& mesh, std::span<const Fibre> fibres,
                bool small_strain, const BlockPattern& pattern);

  [[nodiscard]] double energy(const NodeRows& u) const override;
  void add_force(const NodeRows& u, NodeRows& f) const override;
  void write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const override;

  void write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const override;
  void visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const override;
  [[nodiscard]] std::size_t pieces() const override { return matrix_->pieces(); }

  /// Those of the matrix, then these.
  [[nodiscard]] ElementParts parts() const override;

  /// What the fibres lie in.
  [[nodiscard]] const Elements& matrix() const { return *matrix_; }
  /// The fibres of a tetrahedron.
  struct Element {
    Eigen::Index tetrahedron, piece;  ///< of the mesh, and of `matrix`
    std::array<Index, 4> points;
    Eigen::Vector4d slopes;     ///< g_i . a of its shape functions [1/m]
    Eigen::Vector3d direction;  ///< a
    double young, volume;       ///< [Pa], [m^3]
  };
  /// In the order in which their forces are added.
  [[nodiscard]] std::span<const Element> fibres() const { return elements_; }
  [[nodiscard]] bool is_of_small_strain() const { return small_strain_; }

 private:
  using Stretch = kernel_loops::FibreStretch<double>;
  [[nodiscard]] Stretch stretch(const NodeRows& u, const Element& e) const;
  /// E_f (l - 1) [Pa].
  [[nodiscard]] double tension(const Stretch& now, const Element& e) const;
  /// Sets B of fibre_stiffness(): the block of points i and j is g_i.a g_j.a B. False where the fibre is
  /// slack, and B is not set.
  bool resists(const NodeRows& u, const Element& e, Eigen::Matrix3d& B) const;

  std::shared_ptr<const Elements> matrix_;
  bool small_strain_;
  std::vector<Element> elements_;  ///< in the order of the mesh
  std::vector<std::array<Index, 16>> slots_;
};

/// The elements with their fibres; the elements themselves where no region has any.
/// @throws std::invalid_argument  as FibreElements
std::shared_ptr<const Elements> with_fibres(std::shared_ptr<const Elements> matrix, const TetMesh& mesh,
                                            std::span<const Fibre> fibres, bool small_strain,
                                            const BlockPattern& pattern);

}  // namespace hmax
