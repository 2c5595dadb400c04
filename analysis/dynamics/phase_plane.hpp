/// The phase plane of a planar system: equilibria and their types, nullclines, the direction field.
#pragma once

#include <array>
#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/kink.hpp"
#include "analysis/spectrum/spectrum.hpp"
#include "integrators/system.hpp"
#include "results/table.hpp"

namespace hmax {

/// A planar vector field y' = f(y) with J(i, j) = d f_i / d y_j. What is not planar or not autonomous is
/// frozen first.
/// Both functions are called with states of the window and beyond; they may return values that are not
/// finite.
struct PlanarField {
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> rhs;       ///< f [1/s times the units of y]
  std::function<Eigen::Matrix2d(const Eigen::Vector2d&)> jacobian;  ///< J
  double jacobian_error = 1e-10;  ///< jumps of J that are no more than this share of it are its rounding
};

/// The field of `system` at the instant t [s]; the system is copied. For an autonomous system t is
/// irrelevant.
template <DifferentiableSystem S>
PlanarField frozen_at(S system, double t = 0) {
  static_assert(S::State::RowsAtCompileTime == 2, "a phase plane needs a state of two components");
  return {[system, t](const Eigen::Vector2d& y) {
            Eigen::Vector2d f;
            system.rhs(t, y, f);
            return f;
          },
          [system, t](const Eigen::Vector2d& y) {
            Eigen::Matrix2d J;
            system.jacobian(t, y, J);
            return J;
          }};
}

/// The rectangle [lower, upper] of the plane in the units of the two components.
struct Window {
  Eigen::Vector2d lower, upper;

  /// The lengths of both sides.
  Eigen::Vector2d size() const { return upper - lower; }
};

/// @throws std::invalid_argument  for a window that is empty or not finite
void require_valid(const Window& window);

/// The smallest window that holds the finite points of `orbits` and of `also`, symmetric about zero where it
/// crosses zero, widened by `margin` of its size on each side; a side without extent becomes 1 long.
/// @return  lower < upper in both components
/// @param orbits  tables whose columns `first` and `second` are the two components
/// @throws std::invalid_argument when a table has no such column, or nothing finite is given
Window window_around(const std::vector<Table>& orbits, std::string_view first, std::string_view second,
                     const std::vector<Eigen::Vector2d>& also = {}, double margin = 0.08);

/// The direction d of a real eigenvalue, (J - lambda) d = 0, of length 1.
/// @param lambda  an eigenvalue of J [1/s]; the sign of d has no meaning
Eigen::Vector2d eigenvector(const Eigen::Matrix2d& J, double lambda);

/// Node: real eigenvalues of one sign; focus: a complex pair; centre: an imaginary pair; saddle: real ones
/// of both signs; degenerate: an eigenvalue is zero.
enum class EquilibriumType {
  stable_node,
  stable_focus,
  centre,
  saddle,
  unstable_node,
  unstable_focus,
  degenerate
};

/// "stable_node", ...: the words of the command line.
std::string_view name_of(EquilibriumType type);
/// Nodes and foci to which motions near them come.
inline bool is_stable(EquilibriumType type) {
  return type == EquilibriumType::stable_node || type == EquilibriumType::stable_focus;
}

/// A point where f vanishes.
struct Equilibrium {
  Eigen::Vector2d state;  ///< in the units of the two components
  EquilibriumType type;   ///< by classify(); at a kink that of the motions, degenerate where J is no guide
  std::array<std::complex<double>, 2>
      eigenvalues;  ///< of J [1/s]; larger real part first, then larger imaginary part
  /// Of f around it, the only zero there; nothing where it is not isolated, or f not finite around it.
  std::optional<int> index{};
  /// Where J jumps there. Then eigenvalues are the largest and the least rate of the rays, or rate and
  /// angular frequency of a turn.
  std::optional<Kink> kink{};
};

/// The type of the equilibrium with Jacobian J, from the signs of T, D and T^2 - 4 D. [strogatz2015nonlinear]
/// section 5.2
///   D < 0 saddle; D > 0: T < 0 stable, T > 0 unstable, T = 0 centre; T^2 >= 4 D node, otherwise focus; D = 0
///   degenerate.
/// A centre needs T to be zero to rounding: |T| <= 1e-12 of 2 sqrt(D), a damping ratio no measurement can
/// tell from 0. A critically damped system (T^2 = 4 D) counts as a node.
EquilibriumType classify(const Eigen::Matrix2d& J);

/// The equilibria in the window that Newton's method reaches from a grid, see Equilibria, by first then
/// second component. A line of equilibria is represented by points of it, all `degenerate`.
/// @throws std::invalid_argument when the window is empty or not finite
std::vector<Equilibrium> find_equilibria(const PlanarField& field, const Window& window);

/// Arrows of the direction field on a columns x rows grid of cell centres, all of one length on a square
/// picture of the window: four columns, the two components of the point and of the arrow centred on it, in
/// the units of the axes. Points where f is zero or not finite have no arrow.
/// @param columns, rows  at least 1
/// @throws std::invalid_argument  for fewer, or a window that is empty or not finite
/// @param names  of the two components, "x [m]"; the arrow's columns are called "d" + name
Table direction_field(const PlanarField& field, const Window& window, const std::vector<std::string>& names,
                      int columns = 21, int rows = 17);

/// A curve as points, shape (2) each; closed when first == last.
using Polyline = std::vector<Eigen::Vector2d>;

/// The set f_component = 0 in the window as stitched polylines, by marching squares on cells x cells squares:
/// every open piece ends on the border of the window or at a point where f is not finite.
/// A crossing on the side of a square is placed by linear interpolation, so the error is of second order
/// in the size of a square.
/// @param component  0 or 1
/// @throws std::invalid_argument for another component or cells < 1
std::vector<Polyline> nullcline(const PlanarField& field, int component, const Window& window,
                                int cells = 160);

}  // namespace hmax
