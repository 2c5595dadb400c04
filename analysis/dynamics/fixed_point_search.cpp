#include "analysis/dynamics/fixed_point_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <unordered_map>

#include <Eigen/LU>

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::VectorXd;

/// @throws std::invalid_argument  unless the box is finite, not empty and of two coordinates
void require_plane(const Box& box) {
  if (box.lower.size() != 2 || box.upper.size() != 2 || !box.lower.allFinite() || !box.upper.allFinite() ||
      !(box.size().minCoeff() > 0))
    throw std::invalid_argument("a search in the plane needs two finite bounds with lower < upper");
}

/// Lexicographic order, the first component first.
bool less(const VectorXd& a, const VectorXd& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// The angle from a to b, in (-pi, pi].
/// atan2 of cross and dot product, independent of both lengths.
double turn(const Vector2d& a, const Vector2d& b) { return std::atan2(a(0) * b(1) - a(1) * b(0), a.dot(b)); }

/// The angle by which g turns from a to b on a straight line; NaN where that cannot be said.
/// Halves the line until both halves turn by less than pi / 4, so that no whole turn is missed between two
/// looks of a smooth g.
/// @param halvings  that are left
double turn_between(const VectorFunction& g, const Vector2d& a, const Vector2d& ga, const Vector2d& b,
                    const Vector2d& gb, int halvings) {
  const Vector2d middle = (a + b) / 2;
  const Vector2d gm = g(middle);
  for (const Vector2d& known : {gm, gb})
    if (!known.allFinite() || known.isZero(0)) return std::nan("");
  const double first = turn(ga, gm), second = turn(gm, gb);
  constexpr double little = std::numbers::pi / 4;
  if (std::abs(first) < little && std::abs(second) < little) return first + second;
  if (halvings == 0) return std::nan("");
  return turn_between(g, a, ga, middle, gm, halvings - 1) + turn_between(g, middle, gm, b, gb, halvings - 1);
}

/// The square of a lattice over the box with its lower left corner at (i, j).
struct Cell {
  int i, j, width;
};

/// A tree of squares: each is dropped, divided or handed to Newton's method. Values at lattice points are
/// kept, so that squares share those of their corners.
class CellSearch {
 public:
  CellSearch(const VectorFunction& map, const Box& box, std::int64_t most_steps)
      : left_(most_steps), size_(box.size()), box_(box) {
    map_ = [this, &map](const VectorXd& y) {
      --left_;
      return map(y);
    };
  }

  /// Starts with 32 x 32 squares.
  FixedPointSearch run() {
    for (int i = 0; i < sides; i += coarse)
      for (int j = 0; j < sides; j += coarse) explore({i, j, coarse});
    found_.whole = left_ > 0;
    std::ranges::sort(found_.points, less, &FixedPoint::state);
    return std::move(found_);
  }

 private:
  static constexpr int finest = 2, coarse = 256, sides = 32 * coarse;  // in distances of the lattice
  static constexpr std::size_t isolated = 500;                         // more points than this are no points

  /// The state at a place of the lattice, which has 8192 distances a side.
  [[nodiscard]] VectorXd at(double i, double j) const {
    return box_.lower + Vector2d(i, j).cwiseProduct(size_) / sides;
  }

  /// Phi(y) - y in sizes of the box, at a point of the lattice.
  const Vector2d& value(int i, int j) {
    const auto [entry, isnew] = values_.try_emplace(std::int64_t{i} * (sides + 1) + j);
    if (isnew) {
      const VectorXd y = at(i, j);
      entry->second = (map_(y) - y).cwiseQuotient(size_);
    }
    return entry->second;
  }

  /// Newton's method from the middle of a cell, which may stray three widths; the point is kept if it is
  /// new.
  void take(const Cell& cell) {
    constexpr double same = 1e-7;  // in sizes of the box
    const double middle = cell.width / 2.0;
    const auto y =
        newton_fixed_point(map_, box_, at(cell.i + middle, cell.j + middle), 3.0 * cell.width / sides);
    if (!y) return;
    const bool known = std::ranges::any_of(found_.points, [&](const FixedPoint& other) {
      return (other.state - *y).cwiseQuotient(size_).norm() < same;
    });
    if (known) return;
    found_.points.push_back(fixed_point_at(map_, *y, size_ / 16));
    if (found_.points.size() > isolated) left_ = 0;
  }

  /// Into four quarters, each explored in turn.
  void split(const Cell& cell) {
    const int half = cell.width / 2;
    for (const int i : {cell.i, cell.i + half})
      for (const int j : {cell.j, cell.j + half}) explore({i, j, half});
  }

  /// Decides by the values of g = Phi(y) - y at the four corners and the middle.
  void explore(const Cell& cell) {
    if (left_ <= 0) return;
    const auto [i, j, width] = cell;
    const std::array<Vector2d, 5> g{value(i, j), value(i + width, j), value(i, j + width),
                                    value(i + width, j + width), value(i + width / 2, j + width / 2)};
    const auto finite = std::ranges::count_if(g, [](const Vector2d& at) { return at.allFinite(); });
    if (finite == 0) return;
    if (finite < 5) {  // the edge of what diverges
      if (width > coarse / 8) split(cell);
      return;
    }
    constexpr double rounding = 1e-9;
    if (std::ranges::all_of(g, [](const Vector2d& at) { return at.cwiseAbs().maxCoeff() < rounding; })) {
      left_ = 0;  // every point of the cell is fixed
      return;
    }
    // g(u) = a + B u + misfit, u in [-1, 1]^2.
    const Vector2d a = (g[0] + g[1] + g[2] + g[3]) / 4;
    // Slopes of the plane of least squares through the corners, in half widths of the cell.
    Matrix2d B;
    B << (g[1] + g[3] - g[0] - g[2]) / 4, (g[2] + g[3] - g[0] - g[1]) / 4;
    // The misfit is the twisting term of the corners and the bulge of the middle.
    const Vector2d doubt = 2 * ((g[0] + g[3] - g[1] - g[2]) / 4).cwiseAbs() + 2 * (g[4] - a).cwiseAbs();
    // |a_i| > sum_j |B_ij| + doubt_i: component i has no zero in [-1, 1]^2.
    if ((a.cwiseAbs().array() > (B.cwiseAbs().rowwise().sum() + doubt).array()).any()) return;
    const Matrix2d inverse = B.inverse();
    if (inverse.allFinite()) {
      // u = -B^-1 (a + misfit): where |B^-1 a| exceeds 1 + |B^-1| doubt no zero lies in the cell.
      const Vector2d zero = inverse * a, around = inverse.cwiseAbs() * doubt;
      if ((zero.cwiseAbs().array() > 1 + around.array()).any()) return;
      if (around.maxCoeff() < 0.5) return take(cell);
    }
    width > finest ? split(cell) : take(cell);
  }

  std::int64_t left_;
  VectorXd size_;
  Box box_;
  VectorFunction map_;
  std::unordered_map<std::int64_t, Vector2d> values_;
  FixedPointSearch found_;
};

}  // namespace

// The winding number of g along the border, from the angles between neighbouring values.
std::optional<int> degree_around(const VectorFunction& g, const Box& box) {
  require_plane(box);
  constexpr int pieces = 64, halvings = 20;
  const Vector2d lower = box.lower, upper = box.upper;
  const std::array<Vector2d, 5> corners{lower, Vector2d(upper(0), lower(1)), upper,
                                        Vector2d(lower(0), upper(1)), lower};
  double angle = 0;
  Vector2d from = lower, there = g(from);
  for (std::size_t side = 0; side < 4; ++side)
    for (int piece = 1; piece <= pieces; ++piece) {
      // 64 pieces a side, counter-clockwise from the lower left corner.
      const double share = double(piece) / pieces;
      const Vector2d to = (1 - share) * corners[side] + share * corners[side + 1];
      const Vector2d next = g(to);
      angle += turn_between(g, from, there, to, next, halvings);
      if (!std::isfinite(angle)) return std::nullopt;
      from = to;
      there = next;
    }
  return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

// The product is real but for rounding, so its real part has the sign of the determinant.
std::optional<int> index_of(const FixedPoint& point) {
  std::complex<double> det = 1;
  for (const auto& mu : point.multipliers) {
    // A multiplier of one, as at a fold.
    if (!(std::abs(1.0 - mu) > 1e-8)) return std::nullopt;
    det *= 1.0 - mu;
  }
  return det.real() > 0 ? 1 : -1;
}

namespace {
/// Without an index of one point there is no sum.
void sum_indices(FixedPointSearch& found) {
  found.index_sum = 0;
  for (const FixedPoint& point : found.points) {
    const auto index = index_of(point);
    found.index_sum = index && found.index_sum ? std::optional(*found.index_sum + *index) : std::nullopt;
  }
}

/// The largest finite |f_i| on a grid over a window; 1 where that is 0.
Vector2d size_of_field(const PlanarField& field, const Window& window) {
  constexpr int grid = 16;
  Vector2d largest = Vector2d::Zero();
  for (int i = 0; i <= grid; ++i)
    for (int j = 0; j <= grid; ++j) {
      const Vector2d f =
          field.rhs(window.lower + Vector2d(i, j).cwiseProduct(window.size()) / grid).cwiseAbs();
      if (f.allFinite()) largest = largest.cwiseMax(f);
    }
  return largest.unaryExpr([](double size) { return size > 0 ? size : 1.0; });
}
}  // namespace

// The degree is taken of the same g in sizes of the box: scaling by positive numbers does not change it.
FixedPointSearch search_fixed_points(const VectorFunction& map, const Box& box, std::int64_t most_steps) {
  require_plane(box);
  FixedPointSearch found = CellSearch(map, box, most_steps).run();
  const VectorXd size = box.size();
  found.degree =
      degree_around([&](const VectorXd& y) -> VectorXd { return (map(y) - y).cwiseQuotient(size); }, box);
  sum_indices(found);
  return found;
}

// Fixed points of Phi^2 that Phi moves by at least 1e-5 of the box. Newton's method starts from a grid: Phi^2
// is so steep where a step is long that a search in cells comes to no end.
std::vector<PeriodTwo> find_period_two(const VectorFunction& map, const Box& box) {
  require_plane(box);
  constexpr int starts = 31;
  const VectorXd size = box.size();
  const VectorFunction twice = [&](const VectorXd& y) -> VectorXd { return map(map(y)); };
  const auto apart = [&](const VectorXd& a, const VectorXd& b) {
    return (a - b).cwiseQuotient(size).norm() >= 1e-5;
  };
  std::vector<VectorXd> roots;
  for (int i = 0; i < starts; ++i)
    for (int j = 0; j < starts; ++j) {
      const Vector2d middle = Vector2d(j + 0.5, i + 0.5) / starts;
      const auto y = newton_fixed_point(twice, box, box.lower + middle.cwiseProduct(Vector2d(size)));
      if (y && std::ranges::all_of(roots, [&](const VectorXd& other) { return apart(other, *y); }))
        roots.push_back(*y);
    }
  std::ranges::sort(roots, less);
  std::vector<PeriodTwo> found;
  for (const VectorXd& y : roots) {
    const VectorXd other = map(y);
    if (!apart(y, other)) continue;
    const bool known = std::ranges::any_of(found, [&](const PeriodTwo& orbit) {
      return !apart(orbit.states[0], y) || !apart(orbit.states[1], y);
    });
    if (known) continue;
    const Multipliers mu =
        multipliers_of(differenced_jacobian(map, other, size) * differenced_jacobian(map, y, size));
    const bool first = !less(other, y);
    found.push_back({{first ? y : other, first ? other : y}, mu, classify_map(mu)});
  }
  return found;
}

// Each point of the search in cells is sharpened by Newton's method on f with its own Jacobian.
EquilibriumSet search_equilibria(const PlanarField& field, const Window& window) {
  EquilibriumSet found;
  found.points = find_equilibria(field, window);
  const Vector2d size = window.size(), largest = size_of_field(field, window);
  // Phi(y) - y = f in units of its own size, so that fixed points of this map are the equilibria.
  const VectorFunction map = [&](const VectorXd& y) -> VectorXd {
    return y + field.rhs(y).cwiseQuotient(largest).cwiseProduct(size);
  };
  const FixedPointSearch searched = search_fixed_points(map, {window.lower, window.upper});
  found.whole = searched.whole;
  found.degree = searched.degree;
  if (searched.whole)
    for (const FixedPoint& point : searched.points) {
      const std::optional<Equilibrium> refined = equilibrium_from(field, window, point.state);
      if (refined && std::ranges::none_of(found.points, [&](const Equilibrium& other) {
            return (other.state - refined->state).cwiseQuotient(size).norm() < 1e-6;
          }))
        found.points.push_back(*refined);
    }
  std::ranges::sort(found.points, [](const Equilibrium& a, const Equilibrium& b) {
    return std::pair(a.state(0), a.state(1)) < std::pair(b.state(0), b.state(1));
  });
  found.index_sum = 0;
  for (const Equilibrium& point : found.points) {
    if (point.type == EquilibriumType::degenerate) found.index_sum.reset();
    if (!found.index_sum) break;
    *found.index_sum += point.type == EquilibriumType::saddle ? -1 : 1;
  }
  return found;
}

}  // namespace hmax
