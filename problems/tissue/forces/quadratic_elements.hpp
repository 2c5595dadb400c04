/// Tetrahedra of ten nodes, whose displacements are quadratic.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/ten_node.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/elements.hpp"
#include "problems/tissue/forces/node_rows.hpp"

namespace hmax {

/// The stable neo-Hookean solid on isoparametric tetrahedra of ten nodes (TetMesh::ten_node), by a rule of
/// four points g each [hughes2000finite]:
///   energy sum_g V_g W(H_g),   H_g = sum_a u_a G_ag^T,   G = dN/dX.
/// The rule is exact for straight sides. Along curved ones its gradients are shifted by the same vector at
/// all four points and its volumes scaled, so that the sum of V_g G_ag is the integral of G_a and that of
/// V_g the volume: a constant stress is then balanced at inner points (as in [hillman2015variationally]).
/// Bending and linear strain are carried exactly. Forces are finite for every F and restore what is flat. An
/// inverted element may stay so: what lies between the four points is not seen.
/// Forces and stiffness come from the kernels; sums are made in the order of the mesh, on one thread.
class QuadraticElements final : public Elements {
 public:
  /// @param lame     of each region of the mesh
  /// @param pattern  holds all pairs of points of every element
  /// @throws std::invalid_argument  where an element has no volume at a point of the rule
  QuadraticElements(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern);

  [[nodiscard]] double energy(const NodeRows& u) const override;
  void add_force(const NodeRows& u, NodeRows& f) const override;
  void write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const override;
  /// Of a part at a corner that of the point of the rule near it, of the inner ones the mean.
  void write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const override;
  void visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const override;
  [[nodiscard]] std::size_t pieces() const override { return elements_.size(); }
  [[nodiscard]] ElementParts parts() const override { return {.of_ten_nodes = this}; }

  /// A point of the rule.
  struct Point {
    Eigen::Matrix<double, 10, 3> gradients;  ///< G [1/m]
    double volume;                           ///< V [m^3]
  };
  struct Element {
    std::array<Index, 10> points;
    std::array<Point, 4> rule;
    Lame lame;
    /// The rule as kernels take it.
    [[nodiscard]] double gradient(int g, Eigen::Index a, Eigen::Index j) const {
      return rule[static_cast<std::size_t>(g)].gradients(a, j);
    }
    [[nodiscard]] double volume(int g) const { return rule[static_cast<std::size_t>(g)].volume; }
    [[nodiscard]] double half_lambda() const { return lame.lambda / 2; }
    [[nodiscard]] double mu() const { return lame.mu; }
  };
  /// In the order in which forces are added up.
  [[nodiscard]] std::span<const Element> elements() const { return elements_; }

 private:
  using Stiffness = Eigen::Matrix<double, 30, 30>;

  static std::array<Point, 4> rule_of(const TenPlaces& X, Eigen::Index element);
  /// Displacements relative to those of the first point, which strains nothing.
  static TenPlaces moves(const NodeRows& u, const Element& e);
  /// The same as kernels take them, that of point a at U[a].
  static void moves(const NodeRows& u, const Element& e, double (*U)[3]);
  static Stiffness stiffness(const NodeRows& u, const Element& e);

  std::vector<Element> elements_;
  std::vector<std::array<Index, 100>> slots_;
};

}  // namespace hmax
