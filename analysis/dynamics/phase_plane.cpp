#include "analysis/dynamics/phase_plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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
EquilibriumType classify(const Matrix2d& slopes) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const Matrix2d J = slopes / slopes.cwiseAbs().maxCoeff();  // whose determinant does not overflow
  const double T = J.trace();
  const double D = J.determinant();
  // The rounding of the difference of the two products.
  const double rounded = 4 * epsilon * (std::abs(J(0, 0) * J(1, 1)) + std::abs(J(0, 1) * J(1, 0)));
  if (!(std::abs(D) > rounded)) return EquilibriumType::degenerate;
  if (D < 0) return EquilibriumType::saddle;
  // The rounding of T itself, and the damping ratio T / (2 sqrt D) below which a focus is called a centre.
  const double rounding = 4 * epsilon * J.diagonal().cwiseAbs().sum();
  if (std::abs(T) <= std::max(rounding, 2e-12 * std::sqrt(D))) return EquilibriumType::centre;
  // Nodes include T^2 = 4 D to rounding: critical damping computed from m, c and k rarely hits it exactly.
  // Discriminant T^2 - 4 D of lambda^2 - T lambda + D.
  const bool node = T * T >= 4 * D * (1 - 8 * epsilon);
  if (T < 0) return node ? EquilibriumType::stable_node : EquilibriumType::stable_focus;
  return node ? EquilibriumType::unstable_node : EquilibriumType::unstable_focus;
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
