/// The elastic energy of a body as compliant constraints.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/positional.hpp"
#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/elasticity.hpp"
#include "problems/tissue/forces/tet_elements.hpp"

namespace hmax {

/// Constraints C(q) with energy C^2 / (2 compliance). Of a spring of a linear law and stiffness k
///   C = l - L,   compliance 1 / k;
/// of a tetrahedron of volume V two, the deviatoric and the volumetric one of a stable neo-Hookean solid,
///   C = |F|,         compliance 1 / (mu V),
///   C = det F - a,   compliance 1 / ((lambda + mu) V),   a = 1 + mu / (lambda + mu),
/// whose sum has the stress lambda tr(e) I + 2 mu e at small strains e. It is StableNeoHookean without its
/// logarithm, and 4/3 and 5/6 of its coefficients. Of a spring that holds a point three, its displacements.
/// @source [macklin2021constraint] with lambda + mu for lambda, which gives the small strains
class TissueConstraints {
 public:
  using Index = TetMesh::Index;
  // Points are those of the free ones, -1 for held ones.
  struct Spring {
    std::array<Index, 2> points;
    Eigen::Vector3d rest;  ///< from the first to the second [m]
    double length, stiffness;
  };
  struct Tetrahedron {
    Tetrahedron(const std::array<Index, 4>& its_points, const RestShape& rest, const Lame& lame);
    std::array<Index, 4> points;
    Eigen::Matrix3d gradients;      ///< Bm of RestShape [1/m]
    double deviatoric, volumetric;  ///< compliances [1/J]
    double excess;                  ///< a - 1
  };
  struct Anchor {
    Index point;
    double stiffness;  ///< [N/m]
  };

  TissueConstraints();
  void add(const Spring& spring) { springs_.push_back(spring); }
  void add(const Tetrahedron& element) { elements_.push_back(element); }
  void add(const Anchor& anchor) { anchors_.push_back(anchor); }

  [[nodiscard]] const std::vector<Spring>& springs() const { return springs_; }
  [[nodiscard]] const std::vector<Tetrahedron>& tetrahedra() const { return elements_; }

  /// In groups that have no point in common, those of a kind after each other. Numbers of constraints:
  /// springs, then two of each tetrahedron, deviatoric first, then three of each anchor.
  [[nodiscard]] Colours colours() const;

  /// @param constraints  fastest where those of a kind follow each other
  /// @param at           written, of the same size
  void evaluate(const Eigen::VectorXd& q, std::span<const std::int32_t> constraints,
                std::span<CompliantConstraint> at) const;

 private:
  enum class Kind { spring, deviatoric, volumetric, anchor };
  struct Place {
    Kind kind;
    std::size_t number;  ///< of the spring, the tetrahedron, or the axis of an anchor, three each
  };
  struct SideBySide;
  static void evaluate_tetrahedra(SideBySide& all);
  [[nodiscard]] Place place(std::int32_t constraint) const;
  /// The free points of each.
  [[nodiscard]] std::vector<std::vector<Index>> points() const;

  std::vector<Spring> springs_;
  std::vector<Tetrahedron> elements_;
  std::vector<Anchor> anchors_;
  void (*evaluate_tetrahedra_)(SideBySide&);  ///< compiled for this processor
};

}  // namespace hmax
