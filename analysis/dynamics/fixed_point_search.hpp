/// All fixed points of a map of the plane, or equilibria of a field, in a window, with the degree as a check.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/dynamics/discrete_map.hpp"

namespace hmax {

/// How often g turns around zero while y goes once around the border of the box, counter-clockwise: the sum
/// of the indices of all zeros inside [strogatz2015nonlinear] section 6.8. The border is halved until g turns
/// by less than pi / 4 from one look to the next; nothing where g is zero or not finite on it.
/// (1 / 2 pi) of the total change of the angle of g. Zero does not say that there are no zeros inside: a
/// saddle (-1) and a node (+1) cancel.
/// @return  an integer; the indices of nodes, foci and centres are +1, of saddles -1
/// @param g    R^2 -> R^2
/// @param box  of two coordinates
std::optional<int> degree_around(const VectorFunction& g, const Box& box);

/// sign det(I - D Phi): the index of a fixed point as a zero of Phi(y) - y. Nothing at a multiplier of one to
/// 1e-8, where it is not decided by the multipliers.
/// The product of 1 - mu over the multipliers, conjugate pairs making positive factors. In the plane det(D
/// Phi - I) = det(I - D Phi).
std::optional<int> index_of(const FixedPoint& point);

/// What the border of a box tells of the points that a search has found inside.
/// The theorem of Poincare and Hopf in the plane: the degree around the border is the sum of the indices
/// inside.
struct DegreeCheck {
  std::optional<int> index_sum;  ///< of the points; nothing where one of them has no index
  std::optional<int> degree;     ///< around the border; nothing where it has none
  bool whole = true;             ///< false where the search has been cut short

  /// Whether the points account for the degree: what is missed then has indices that cancel.
  [[nodiscard]] bool accounts() const { return whole && degree && index_sum == degree; }
};

/// Fixed points, with the degree of Phi(y) - y.
struct FixedPointSearch : DegreeCheck {
  std::vector<FixedPoint> points;  ///< in lexicographic order, each once
};

/// Every fixed point in a box of the plane. Cells are divided, down to 1/4096 of the box, until either an
/// affine map through the values in the cell, with twice its misfit as doubt, has no zero there, or one that
/// Newton's method takes over. The misfit is seen at five points, so that this is no proof; `accounts` is
/// what the border adds to it.
/// @param most_steps  evaluations of the map, after which the search is cut short, as it is where the fixed
///                    points are not isolated
/// @throws std::invalid_argument when the box is empty, not finite or not of two coordinates
FixedPointSearch search_fixed_points(const VectorFunction& map, const Box& box,
                                     std::int64_t most_steps = 400'000);

/// Every orbit of period two with a point in the box that Newton's method on Phi(Phi(y)) - y reaches from 31
/// x 31 starts, in lexicographic order; fixed points of Phi itself are left out. Multipliers by the chain
/// rule, D(Phi^2)(a) = D Phi(b) D Phi(a).
/// @throws std::invalid_argument as search_fixed_points
std::vector<PeriodTwo> find_period_two(const VectorFunction& map, const Box& box);

/// Equilibria, with the degree of f.
struct EquilibriumSet : DegreeCheck {
  std::vector<Equilibrium> points;  ///< by first then second component, each once
};

/// Every equilibrium in a window: those of find_equilibria and of the search in cells, as if f were
/// Phi(y) - y. The index is sign det J: -1 of saddles, 1 of nodes, foci and centres, none of degenerate ones.
/// Where equilibria are not isolated the search is cut short, and they are those of find_equilibria alone.
/// @throws std::invalid_argument as find_equilibria
EquilibriumSet search_equilibria(const PlanarField& field, const Window& window);

}  // namespace hmax
