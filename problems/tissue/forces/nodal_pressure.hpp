/// Tetrahedra that share their pressures at the points of the mesh, and so do not lock near nu = 1/2.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/elements.hpp"
#include "problems/tissue/forces/node_rows.hpp"
#include "problems/tissue/forces/tet_elements.hpp"

namespace hmax {

/// The stable neo-Hookean solid on linear tetrahedra with averaged nodal pressure
/// [bonet1998simple], [bonet2001averaged]. Its energy is W(F; lambda, mu) = W(F; 0, mu) + lambda/2 (J - 1)^2
/// in this very form (StableNeoHookean). The first part stays with each element; the second takes the mean J
/// of the elements e around each point a:
///   sum_e V_e W(F_e; 0, mu) + sum_a V_a lambda/2 (J_a - 1)^2,   V_a = sum_e V_e/4,   J_a = sum_e V_e/4 J_e /
///   V_a.
/// An element thus keeps its volume with the stiffness of nu = 0 alone, which also damps the modes of
/// alternating volumes that averages do not see and restores inverted elements [puso2006stabilized]. A
/// negative lambda stays with the elements.
/// Forces come from the kernels. Averages are taken within each region: materials do not mix. The forces are
/// those of elements with the stress P(F_e; 0, mu) + p_e C_e, C = dJ/dF, where p_e is the mean over the
/// corners of p_a = lambda (J_a - 1); with G_a = V_a dJ_a/du
///   K = sum_e (V_e dP_e + p_e V_e dC_e) + sum_a lambda/V_a G_a G_a^T.
/// Sums are made in the order of the mesh, on one thread.
class NodalPressure final : public Elements {
 public:
  /// @param lame     of each region of the mesh
  /// @param pattern  holds the pairs of points of all tetrahedra around every point
  NodalPressure(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern);

  [[nodiscard]] double energy(const NodeRows& u) const override;
  void add_force(const NodeRows& u, NodeRows& f) const override;
  void write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const override;
  void write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const override;
  /// Tetrahedra, then the averages: the first point of each is that at which it is taken.
  void visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const override;
  [[nodiscard]] std::size_t pieces() const override { return elements_.size() + averages_.size(); }
  [[nodiscard]] ElementParts parts() const override { return {.of_pressures = this}; }

  struct Element {
    std::array<Index, 4> points;
    RestShape rest;
    Lame own;                               ///< of what stays with the element
    std::array<Index, 4> averages{};        ///< that it belongs to
    std::array<std::uint16_t, 16> place{};  ///< of its points among those of each
  };
  /// The elements of one region around a point.
  struct Average {
    double volume = 0, lambda = 0;
    std::size_t first = 0, last = 0;  ///< of its points among all of them
    std::size_t first_slot = 0;
  };
  /// In the order in which volumes and forces are added up.
  [[nodiscard]] std::span<const Element> elements() const { return elements_; }
  [[nodiscard]] std::span<const Average> averages() const { return averages_; }

 private:
  /// What a state comes to, kept from call to call.
  struct Scratch {
    struct Gradient {
      double rows[3][3];
      [[nodiscard]] Eigen::Matrix3d matrix() const {
        return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows[0]);
      }
    };
    std::vector<Gradient> H;         ///< of each element
    std::vector<double> change;      ///< of each average: J_a - 1
    std::vector<Eigen::Vector3d> G;  ///< of each point of each average: (lambda/V_a)^(1/2) G_a [N/m]^(1/2)
  };
  static Scratch& scratch();

  void make_averages(const TetMesh& mesh, std::span<const Lame> lame);
  void find_slots(const BlockPattern& pattern);
  /// Sets H and change.
  void average(const NodeRows& u, Scratch& now) const;
  /// Calls of_element(e, K) for each element, and sets G on the way, after average().
  template <class OfElement>
  void visit_elements(Scratch& now, const OfElement& of_element) const;
  [[nodiscard]] double pressure(const Element& e, const Scratch& now) const;
  [[nodiscard]] double energy_density(std::size_t element, const Scratch& now) const;

  std::vector<Element> elements_;
  std::vector<Average> averages_;
  std::vector<Index> points_;  ///< of all averages, one after the other
  std::vector<Index> slots_;   ///< of all pairs of points of each
  std::vector<std::array<Index, 16>> element_slots_;
};

}  // namespace hmax
