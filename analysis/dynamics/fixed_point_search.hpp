/// Fixed points and orbits of period two of a map of the plane, such as one step of a method, and equilibria
/// of a field: all in a window, with the degree as a check.
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/equilibria.hpp"

namespace hmax {

/// y -> Phi(y); an image that is not finite stands for none.
using PlanarMap = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

/// Eigenvalues of D Phi, the largest modulus first, then the larger imaginary part.
/// A fixed point is stable when all |mu| < 1. Of the period map of a driven system they are the Floquet
/// multipliers of the periodic motion.
using Multipliers = std::array<std::complex<double>, 2>;
/// With an entry of D that is not finite both are NaN.
Multipliers multipliers_of(const Eigen::Matrix2d& D);

/// The type of a fixed point of a map, in the words of equilibria: stable with all |mu| < 1, unstable with
/// all |mu| > 1, a saddle with both; a focus where some are complex, else a node. |mu| = 1 to 1e-8, as
/// differences tell it, is a centre where all of them are and are complex, otherwise degenerate.
/// [strogatz2015nonlinear] section 10.1
EquilibriumType classify_map(const Multipliers& multipliers);

/// Phi(y) = y.
/// Equilibria of y' = f(y) are fixed points of every Runge-Kutta method; others are spurious, see
/// is_spurious().
struct FixedPoint {
  Eigen::Vector2d state;
  Multipliers multipliers;
  EquilibriumType type;  ///< by classify_map()
};

/// Phi(a) = b and Phi(b) = a with a != b.
/// The two points of an orbit of period two; as a spurious solution of a method it appears where a
/// multiplier passes -1.
struct PeriodTwo {
  std::array<Eigen::Vector2d, 2> states;  ///< the lexicographically smaller first
  Multipliers multipliers;                ///< of D Phi(b) D Phi(a)
  EquilibriumType type;                   ///< of both, as fixed points of Phi applied twice
};

/// Newton's method on Phi(y) - y from `start`; nothing when it does not arrive in the window.
/// y <- y - (D Phi - I)^-1 (Phi(y) - y) with D Phi by central differences, at most 50 steps; where D Phi -
/// I is singular the step of least norm in sizes of the window. No step is longer than 0.3 of the window.
/// Arrived: last step below 1e-6 and |Phi(y) - y| below 1e-10, both in sizes of the window.
/// @param leash  in sizes of the window: how far from the start it may stray before it is given up
std::optional<Eigen::Vector2d> newton_fixed_point(const PlanarMap& map, const Window& window,
                                                  const Eigen::Vector2d& start,
                                                  double leash = std::numeric_limits<double>::infinity());

/// Whether a fixed point of a step of length h is no equilibrium of y' = f(y): h |f_i| then is a part of the
/// size of the window that no rounding explains. [iserles1991unified]
/// Spurious when max_i h |f_i(y)| / size_i >= 1e-6.
/// @param f  y' = f(y)
/// @param h  [s]
bool is_spurious(const PlanarMap& f, double h, const Eigen::Vector2d& y, const Window& window);

/// sign det(I - D Phi): the index of a fixed point as a zero of Phi(y) - y. Nothing at a multiplier of one to
/// 1e-8, where it is not decided by the multipliers.
/// The product of 1 - mu over the multipliers, conjugate pairs making positive factors. In the plane det(D
/// Phi - I) = det(I - D Phi).
std::optional<int> index_of(const FixedPoint& point);

/// What the border of a window tells of the points that a search has found inside.
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

/// Every fixed point in a window. Cells are divided, down to 1/4096 of the window, until either an
/// affine map through the values in the cell, with twice its misfit as doubt, has no zero there, or one that
/// Newton's method takes over. The misfit is seen at five points, so that this is no proof; `accounts` is
/// what the border adds to it. Points less than 1e-7 of the window apart are one, unless they are known.
/// The search is cut short after 400,000 steps, and where the fixed points are not isolated.
/// @param known  states that may be fixed, like the equilibria of the field that a method's step maps
/// @throws std::invalid_argument when the window is empty or not finite
FixedPointSearch search_fixed_points(const PlanarMap& map, const Window& window,
                                     const std::vector<Eigen::Vector2d>& known = {});

/// Every orbit of period two with a point in the window that Newton's method on Phi(Phi(y)) - y reaches from
/// 31 x 31 starts, in lexicographic order; fixed points of Phi itself are left out. Multipliers by the chain
/// rule, D(Phi^2)(a) = D Phi(b) D Phi(a).
/// @throws std::invalid_argument as search_fixed_points
std::vector<PeriodTwo> find_period_two(const PlanarMap& map, const Window& window);

/// Equilibria, with the degree of f.
struct EquilibriumSet : DegreeCheck {
  std::vector<Equilibrium> points;  ///< by first then second component, each once
};

/// Every equilibrium in a window: those of find_equilibria and of a search in cells, which are divided until
/// a component of f has no zero there, a known equilibrium is the only one, or f is so nearly affine that
/// Newton's method takes over. It is cut short after 400,000 evaluations of f and J, and where equilibria are
/// not isolated.
/// @throws std::invalid_argument as find_equilibria
EquilibriumSet search_equilibria(const PlanarField& field, const Window& window);

}  // namespace hmax
