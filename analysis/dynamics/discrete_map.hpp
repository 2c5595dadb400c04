/// Fixed points and orbits of period two of a map y -> Phi(y), such as one step of a method.
#pragma once

#include <array>
#include <complex>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/differences.hpp"
#include "analysis/dynamics/phase_plane.hpp"

namespace hmax {

/// The box [lower, upper] of states, shape (n) both.
struct Box {
  Eigen::VectorXd lower, upper;

  [[nodiscard]] Eigen::VectorXd size() const { return upper - lower; }
};

/// Eigenvalues of D Phi, shape (n), the largest modulus first, then the larger imaginary part.
using Multipliers = std::vector<std::complex<double>>;
Multipliers multipliers_of(const Eigen::MatrixXd& D);

/// The type of a fixed point of a map, in the words of equilibria: stable with all |mu| < 1, unstable with
/// all |mu| > 1, a saddle with both; a focus where some are complex, else a node. |mu| = 1 to 1e-8, as
/// differences tell it, is a centre where all of them are and are complex, otherwise degenerate.
/// [strogatz2015nonlinear] section 10.1
EquilibriumType classify_map(const Multipliers& multipliers);

/// Phi(y) = y.
struct FixedPoint {
  Eigen::VectorXd state;  ///< shape (n)
  Multipliers multipliers;
  EquilibriumType type;
};

/// Phi(a) = b and Phi(b) = a with a != b.
struct PeriodTwo {
  std::array<Eigen::VectorXd, 2> states;  ///< shape (n) each, the lexicographically smaller first
  Multipliers multipliers;                ///< of D Phi(b) D Phi(a)
  EquilibriumType type;                   ///< of both, as fixed points of Phi applied twice
};

/// Newton's method on Phi(y) - y from `start`; nothing when it does not arrive in the box.
/// @param leash  in sizes of the box: how far from the start it may stray before it is given up
std::optional<Eigen::VectorXd> newton_fixed_point(const VectorFunction& map, const Box& box,
                                                  const Eigen::VectorXd& start,
                                                  double leash = std::numeric_limits<double>::infinity());

/// The fixed point y with its multipliers.
/// @param scale  shape (n), positive: over which the map changes noticeably
FixedPoint fixed_point_at(const VectorFunction& map, const Eigen::VectorXd& y, const Eigen::VectorXd& scale);

/// Every fixed point in the box that Newton's method reaches from starts^n points of a grid, in lexicographic
/// order, each once. Where the map answers with a number that is not finite, as where a step diverges,
/// nothing is found.
/// @throws std::invalid_argument when the box is empty or not finite, or starts < 1
std::vector<FixedPoint> find_fixed_points(const VectorFunction& map, const Box& box, int starts = 21);

/// Every orbit of period two with a point in the box that Newton's method on Phi(Phi(y)) - y reaches, in
/// lexicographic order; fixed points of Phi itself are left out.
/// @throws std::invalid_argument as find_fixed_points
std::vector<PeriodTwo> find_period_two(const VectorFunction& map, const Box& box, int starts = 31);

/// Whether a fixed point of a step of length h is no equilibrium of y' = f(y): h |f_i| then is a part of the
/// size of the box that no rounding explains. [iserles1991unified]
bool is_spurious(const VectorFunction& f, double h, const Eigen::VectorXd& y, const Box& box);

}  // namespace hmax
