/// Fixed points and orbits of period two of a map y -> Phi(y), such as one step of a method: what they are.
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

  /// The lengths of the sides, by which distances are measured.
  [[nodiscard]] Eigen::VectorXd size() const { return upper - lower; }
};

/// Eigenvalues of D Phi, shape (n), the largest modulus first, then the larger imaginary part.
/// A fixed point is stable when all |mu| < 1. Of the period map of a driven system they are the Floquet
/// multipliers of the periodic motion.
using Multipliers = std::vector<std::complex<double>>;
/// @param D  shape (n, n); with an entry that is not finite all multipliers are NaN
Multipliers multipliers_of(const Eigen::MatrixXd& D);

/// The type of a fixed point of a map, in the words of equilibria: stable with all |mu| < 1, unstable with
/// all |mu| > 1, a saddle with both; a focus where some are complex, else a node. |mu| = 1 to 1e-8, as
/// differences tell it, is a centre where all of them are and are complex, otherwise degenerate.
/// [strogatz2015nonlinear] section 10.1
EquilibriumType classify_map(const Multipliers& multipliers);

/// Phi(y) = y.
/// Equilibria of y' = f(y) are fixed points of every Runge-Kutta method; others are spurious, see
/// is_spurious().
struct FixedPoint {
  Eigen::VectorXd state;  ///< shape (n)
  Multipliers multipliers;
  EquilibriumType type;  ///< by classify_map()
};

/// Phi(a) = b and Phi(b) = a with a != b.
/// The two points of an orbit of period two; as a spurious solution of a method it appears where a
/// multiplier passes -1.
struct PeriodTwo {
  std::array<Eigen::VectorXd, 2> states;  ///< shape (n) each, the lexicographically smaller first
  Multipliers multipliers;                ///< of D Phi(b) D Phi(a)
  EquilibriumType type;                   ///< of both, as fixed points of Phi applied twice
};

/// Newton's method on Phi(y) - y from `start`; nothing when it does not arrive in the box.
/// y <- y - (D Phi - I)^-1 (Phi(y) - y) with D Phi by central differences, at most 50 steps; where D Phi -
/// I is singular the step of least norm in sizes of the box. No step is longer than 0.3 of the box.
/// Arrived: last step below 1e-6 and |Phi(y) - y| below 1e-10, both in sizes of the box.
/// @param leash  in sizes of the box: how far from the start it may stray before it is given up
std::optional<Eigen::VectorXd> newton_fixed_point(const VectorFunction& map, const Box& box,
                                                  const Eigen::VectorXd& start,
                                                  double leash = std::numeric_limits<double>::infinity());

/// The fixed point y with its multipliers.
/// By differenced_jacobian(); y is taken as it is.
/// @param scale  shape (n), positive: over which the map changes noticeably
FixedPoint fixed_point_at(const VectorFunction& map, const Eigen::VectorXd& y, const Eigen::VectorXd& scale);

/// Whether a fixed point of a step of length h is no equilibrium of y' = f(y): h |f_i| then is a part of the
/// size of the box that no rounding explains. [iserles1991unified]
/// Spurious when max_i h |f_i(y)| / size_i >= 1e-6.
/// @param f  y' = f(y), shape (n) to (n)
/// @param h  [s]
bool is_spurious(const VectorFunction& f, double h, const Eigen::VectorXd& y, const Box& box);

}  // namespace hmax
