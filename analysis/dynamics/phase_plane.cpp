#include "analysis/dynamics/phase_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>

#include "analysis/amplification/marching_squares.hpp"
#include "core/dense_solvers.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// The point of the window at fractions (u, v) in [0, 1].
Vector2d at(const Window& window, double u, double v) {
  return window.lower + Vector2d(u, v).cwiseProduct(window.size());
}

/// Largest finite magnitudes of f or J over a grid: what "zero" is measured against.
/// @param grid  intervals on each side: (grid + 1)^2 points
template <class Of>
auto largest_over(const Window& window, int grid, const Of& of) {
  auto largest = of(window.lower);
  largest.setZero();
  for (int i = 0; i <= grid; ++i)
    for (int j = 0; j <= grid; ++j) {
      const auto sizes = of(at(window, double(i) / grid, double(j) / grid)).cwiseAbs().eval();
      if (sizes.allFinite()) largest = largest.cwiseMax(sizes);
    }
  return largest;
}

/// A zero of f.
struct Root {
  Vector2d y;
  /// What its coordinates are measured against: rounding errs by shares of themselves, whatever the window;
  /// where Newton's method came near but slowly, or J is nearly singular, as at a multiple root, the window.
  Vector2d size;
  [[nodiscard]] Vector2d resolution() const { return 1e-6 * size; }
};

/// The part of the window within its size.
Window around(const Root& root, const Window& window) {
  return {(root.y - root.size).cwiseMax(window.lower), (root.y + root.size).cwiseMin(window.upper)};
}

Equilibrium equilibrium_at(const PlanarField& field, const Window& window, const Root& root) {
  const Matrix2d J = field.jacobian(root.y);
  return {root.y, classify(J, largest_over(around(root, window), 8, field.jacobian)), eigenvalues_2x2(J),
          root.resolution()};
}

/// A coordinate that is zero to rounding is printed as 0.
/// @param near       no farther from 0 than it
/// @param tolerated  sizes of f
void round_to_zero(const PlanarField& field, const Vector2d& near, const Vector2d& tolerated, Vector2d& y) {
  for (int i = 0; i < 2; ++i) {
    Vector2d rounded = y;
    rounded(i) = 0;
    if (std::abs(y(i)) < near(i) && (field.rhs(rounded).cwiseAbs().array() <= tolerated.array()).all())
      y = rounded;
  }
}

/// Newton's method from y, in units of the window; nothing when it does not arrive inside the window.
/// @param scale  sizes of f
std::optional<Root> newton(const PlanarField& field, const Window& window, const Vector2d& scale,
                           Vector2d y) {
  // Linear convergence to a double root gains one bit a step, so many more steps than to a simple one.
  constexpr int most_steps = 300;
  const Vector2d size = window.size();
  Vector2d d = size;
  const auto is_small = [&](double share, double of_window) {
    return (d.cwiseAbs().array() <= share * y.cwiseAbs().cwiseMax(of_window * size).array()).all();
  };
  for (int step = 0; step < most_steps && !is_small(1e-14, 1e-3); ++step) {
    const Vector2d f = field.rhs(y);
    const Matrix2d J = field.jacobian(y);
    if (!f.allFinite() || !J.allFinite()) return std::nullopt;
    // Minimum-norm step: on a line of equilibria J is singular and the nearest point of the line is wanted.
    // J S (d / S) = -f with S the sizes of the window.
    d.setZero();
    if (!f.isZero(0)) d = minimum_norm_solution(J * size.asDiagonal(), -f);
    if (!d.allFinite()) return std::nullopt;
    const double length = d.norm();
    if (length > 1) d /= length;  // near a fold of f the full step may leave for infinity
    d = d.cwiseProduct(size);
    y += d;
  }
  const Vector2d f = field.rhs(y).cwiseAbs();
  const bool is_known = is_small(1e-6, 1e-10);
  if (!is_known && (d.cwiseAbs().array() > 1e-5 * size.array()).any()) return std::nullopt;  // on its way
  if (!f.allFinite() || (f.array() > 1e-12 * scale.array()).any()) return std::nullopt;
  const Vector2d slack = 1e-9 * size;
  if (((y - window.lower + slack).array() < 0).any() || ((window.upper - y + slack).array() < 0).any())
    return std::nullopt;
  const Matrix2d J = field.jacobian(y) * size.asDiagonal();
  const bool is_simple = is_known && std::abs(J.determinant()) > 1e-10 * J.squaredNorm();
  round_to_zero(field, (is_simple ? 1e-13 : 1e-7) * size, f.cwiseMax(1e-15 * scale), y);
  // Where terms of f cancel, coordinates near 0 have the rounding of these terms.
  return Root{y, is_simple ? y.cwiseAbs().cwiseMax(1e-7 * size) : size};
}

/// @throws std::invalid_argument  when the table has no such column
std::size_t column_index(const Table& table, std::string_view name) {
  const auto found = std::find(table.columns.begin(), table.columns.end(), name);
  if (found == table.columns.end())
    throw std::invalid_argument("the orbit has no column '" + std::string(name) + "'");
  return static_cast<std::size_t>(found - table.columns.begin());
}

}  // namespace

void require_valid(const Window& window) {
  if (!window.lower.allFinite() || !window.upper.allFinite() || !(window.size().minCoeff() > 0))
    throw std::invalid_argument(
        "a phase-plane window needs finite bounds with lower < upper in both components");
}

// Bounding box, made symmetric about zero and widened, one side after the other.
Window window_around(const std::vector<Table>& orbits, std::string_view first, std::string_view second,
                     const std::vector<Vector2d>& also, double margin) {
  Window window{Vector2d::Constant(infinity), Vector2d::Constant(-infinity)};
  const auto include = [&](const Vector2d& y) {
    if (!y.allFinite()) return;
    window.lower = window.lower.cwiseMin(y);
    window.upper = window.upper.cwiseMax(y);
  };
  for (const Table& orbit : orbits) {
    const std::size_t i = column_index(orbit, first);
    const std::size_t j = column_index(orbit, second);
    for (std::size_t row = 0; row < orbit.values[i].size(); ++row)
      include({orbit.values[i][row], orbit.values[j][row]});
  }
  for (const Vector2d& y : also) include(y);
  if (!(window.size().minCoeff() >= 0))
    throw std::invalid_argument("a phase-plane window needs a finite point");
  for (int i = 0; i < 2; ++i) {
    double& lower = window.lower(i);
    double& upper = window.upper(i);
    if (lower < 0 && upper > 0) {
      upper = std::max(upper, -lower);
      lower = -upper;
    }
    const double extent = upper - lower;
    const double widen = extent > 0 ? margin * extent : 0.5;
    lower -= widen;
    upper += widen;
  }
  return window;
}

std::string_view name_of(EquilibriumType type) {
  constexpr std::array<std::string_view, 7> names{"stable_node",   "stable_focus",   "centre",    "saddle",
                                                  "unstable_node", "unstable_focus", "degenerate"};
  return names[static_cast<std::size_t>(type)];
}

// T = lambda_1 + lambda_2, D = lambda_1 lambda_2; damping ratio zeta = -T / (2 sqrt(D)) where D > 0.
EquilibriumType classify(const Matrix2d& J, const Matrix2d& scale) {
  const double T = J.trace();
  const double D = J.determinant();
  // The largest determinant that entries of these sizes can make.
  const double largest = std::abs(scale(0, 0) * scale(1, 1)) + std::abs(scale(0, 1) * scale(1, 0));
  if (!(std::abs(D) > 1e-7 * largest)) return EquilibriumType::degenerate;
  if (D < 0) return EquilibriumType::saddle;
  // The rounding of T itself, and the damping ratio T / (2 sqrt D) below which a focus is called a centre.
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * J.diagonal().cwiseAbs().sum();
  if (std::abs(T) <= std::max(rounding, 2e-12 * std::sqrt(D))) return EquilibriumType::centre;
  // Nodes include T^2 = 4 D to rounding: critical damping computed from m, c and k rarely hits it exactly.
  // Discriminant T^2 - 4 D of lambda^2 - T lambda + D.
  const bool node = T * T >= 4 * D * (1 - 8 * std::numeric_limits<double>::epsilon());
  if (T < 0) return node ? EquilibriumType::stable_node : EquilibriumType::stable_focus;
  return node ? EquilibriumType::unstable_node : EquilibriumType::unstable_focus;
}

EquilibriumType classify(const Matrix2d& J) { return classify(J, J); }

std::optional<Equilibrium> equilibrium_from(const PlanarField& field, const Window& window,
                                            const Vector2d& start) {
  require_valid(window);
  const Vector2d scale = largest_over(window, 15, field.rhs);
  const auto root = newton(field, window, scale, start);
  if (!root) return std::nullopt;
  return equilibrium_at(field, window, *root);
}

// Newton's method from the centres of a grid of cells.
std::vector<Equilibrium> find_equilibria(const PlanarField& field, const Window& window, int starts) {
  require_valid(window);
  if (starts < 1) throw std::invalid_argument("the search for equilibria needs at least one start");
  const Vector2d scale = largest_over(window, std::max(8, starts), field.rhs);
  std::vector<Equilibrium> found;
  for (int i = 0; i < starts; ++i)
    for (int j = 0; j < starts; ++j) {
      const auto root = newton(field, window, scale, at(window, (i + 0.5) / starts, (j + 0.5) / starts));
      if (root && std::ranges::none_of(
                      found, [&](const Equilibrium& known) { return known.is(root->y, root->resolution()); }))
        found.push_back(equilibrium_at(field, window, *root));
    }
  std::sort(found.begin(), found.end(), [](const Equilibrium& a, const Equilibrium& b) {
    return std::pair(a.state(0), a.state(1)) < std::pair(b.state(0), b.state(1));
  });
  return found;
}

// The direction is that on a square picture of the window, f_i / size_i, normalised there; arrows are
// given in the units of the axes.
Table direction_field(const PlanarField& field, const Window& window, const std::vector<std::string>& names,
                      int columns, int rows) {
  require_valid(window);
  if (columns < 1 || rows < 1)
    throw std::invalid_argument("a direction field needs at least one column and one row");
  Table table{{}, {names[0], names[1], "d" + names[0], "d" + names[1]}, std::vector<std::vector<double>>(4)};
  // Arrows fill 62 % of the smaller distance between their centres.
  const double length = 0.62 / std::max(columns, rows);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const Vector2d y = at(window, (i + 0.5) / columns, (j + 0.5) / rows);
      const Vector2d seen =
          field.rhs(y).cwiseQuotient(window.size());  // the direction as it looks in the picture
      if (!seen.allFinite() || seen.isZero(0)) continue;
      const Vector2d arrow = length * seen.stableNormalized().cwiseProduct(window.size());
      const std::array<double, 4> row{y(0), y(1), arrow(0), arrow(1)};
      for (std::size_t k = 0; k < 4; ++k) table.values[k].push_back(row[k]);
    }
  return table;
}

std::vector<Polyline> nullcline(const PlanarField& field, int component, const Window& window, int cells) {
  require_valid(window);
  if (component != 0 && component != 1)
    throw std::invalid_argument("a planar field has the components 0 and 1");
  if (cells < 1) throw std::invalid_argument("a nullcline needs at least one cell");
  const auto place = [&](int i, int j) { return at(window, double(i) / cells, double(j) / cells); };
  Eigen::MatrixXd value(cells + 1, cells + 1);
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j) value(i, j) = field.rhs(place(i, j))(component);
  // Zero counts as positive, so a node on the curve is not lost.
  const GridNodes nodes = value.unaryExpr([](double f) {
    return !std::isfinite(f) ? GridNode::unknown : f >= 0 ? GridNode::inside : GridNode::outside;
  });
  const auto middle_is_positive = [&](int i, int j) {
    return (value(i, j) + value(i + 1, j) + value(i + 1, j + 1) + value(i, j + 1)) / 4 >= 0;
  };
  std::vector<Polyline> curves;
  for (const GridCurve& border : border_of(nodes, middle_is_positive)) {
    Polyline curve;
    for (const auto& [i, j, upward] : border.sides) {
      const int i1 = upward ? i : i + 1, j1 = upward ? j + 1 : j;
      const Vector2d from = place(i, j), to = place(i1, j1);
      // f0 / (f0 - f1), without overflow, and 0 for f0 = 0 > f1.
      const Vector2d point = from + 1 / (1 - value(i1, j1) / value(i, j)) * (to - from);
      if (curve.empty() || curve.back() != point) curve.push_back(point);
    }
    if (border.closed && curve.size() > 2) curve.push_back(curve.front());
    if (curve.size() > 1) curves.push_back(std::move(curve));
  }
  return curves;
}

Eigen::Vector2d eigenvector(const Eigen::Matrix2d& J, double lambda) {
  // d is orthogonal to the longer row of J - lambda.
  const Eigen::Matrix2d A = J - lambda * Eigen::Matrix2d::Identity();
  const Eigen::RowVector2d row = A.row(A.row(0).norm() >= A.row(1).norm() ? 0 : 1);
  return Eigen::Vector2d(-row(1), row(0)).normalized();
}

}  // namespace hmax
