#include "analysis/dynamics/fixed_point_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

#include <Eigen/LU>

#include "analysis/dynamics/differences.hpp"
#include "core/dense_solvers.hpp"

namespace hmax {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// D map at y by central differences: good enough for a step of Newton's method.
Matrix2d rough_jacobian(const PlanarMap& map, const Vector2d& y, const Vector2d& size) {
  Matrix2d D;
  for (Eigen::Index j = 0; j < 2; ++j) {
    Vector2d ahead = y, behind = y;
    ahead(j) += 1e-6 * size(j);
    behind(j) -= 1e-6 * size(j);
    D.col(j) = (map(ahead) - map(behind)) / (ahead(j) - behind(j));
  }
  return D;
}

}  // namespace

Multipliers multipliers_of(const Matrix2d& D) {
  if (!D.allFinite()) return {std::nan(""), std::nan("")};
  Multipliers mu = eigenvalues_2x2(D);
  // A conjugate pair has one modulus, whatever rounding says.
  const double difference = std::abs(mu[1]) - std::abs(mu[0]);
  const bool differ = std::abs(difference) > 1e-14 * std::abs(mu[1]);
  if (differ ? difference > 0 : mu[1].imag() > mu[0].imag()) std::swap(mu[0], mu[1]);
  return mu;
}

// Saddle: inside and outside; focus: at least one complex multiplier. A negative real multiplier
// alternates sides and counts as a node.
EquilibriumType classify_map(const Multipliers& multipliers) {
  constexpr double on_circle = 1e-8;
  int inside = 0, outside = 0, on = 0;
  bool turns = false, all_turn = true;
  for (const auto& mu : multipliers) {
    const double modulus = std::abs(mu);
    if (!std::isfinite(modulus)) return EquilibriumType::degenerate;
    // Counts the multipliers on, inside and outside the unit circle.
    (std::abs(modulus - 1) <= on_circle ? on : modulus < 1 ? inside : outside) += 1;
    // Rounding splits a double multiplier into a pair about sqrt(epsilon) apart.
    const bool complex = std::abs(mu.imag()) > 1e-6 * modulus;
    turns = turns || complex;
    all_turn = all_turn && complex;
  }
  if (on > 0)
    return inside + outside == 0 && all_turn ? EquilibriumType::centre : EquilibriumType::degenerate;
  if (inside > 0 && outside > 0) return EquilibriumType::saddle;
  if (inside > 0) return turns ? EquilibriumType::stable_focus : EquilibriumType::stable_node;
  return turns ? EquilibriumType::unstable_focus : EquilibriumType::unstable_node;
}

// g(y) = Phi(y) - y, G = D g; the step d, in sizes of the window, solves G S d = -g in the sense of least
// squares.
std::optional<Vector2d> newton_fixed_point(const PlanarMap& map, const Window& window, const Vector2d& start,
                                           double leash) {
  constexpr int most_steps = 50;
  const Vector2d size = window.size();
  const double longest = std::min(0.3, leash);
  Vector2d y = start;
  double length = 1;
  for (int step = 0; step < most_steps && length > 1e-14; ++step) {
    const Vector2d g = map(y) - y;
    if (!g.allFinite()) return std::nullopt;
    if (g.isZero(0)) {
      length = 0;
      break;
    }
    // D(Phi - id)
    const Matrix2d G = rough_jacobian(map, y, size) - Matrix2d::Identity();
    if (!G.allFinite()) return std::nullopt;
    // In sizes of the window, so that components of different units weigh alike.
    Vector2d d = minimum_norm_solution(G * size.asDiagonal(), -g);
    if (!d.allFinite()) return std::nullopt;
    length = d.norm();
    // A step across the window is a leap into the dark.
    if (length > longest) d *= longest / length;
    y += d.cwiseProduct(size);
    if (!((y - start).cwiseQuotient(size).norm() <= leash)) return std::nullopt;
    // What has left for good does not come back.
    if (((y - window.lower + 2 * size).array() < 0).any() ||
        ((window.upper - y + 2 * size).array() < 0).any())
      return std::nullopt;
  }
  const Vector2d slack = 1e-9 * size;
  const auto residual = [&](const Vector2d& at) -> Vector2d {
    return (map(at) - at).cwiseAbs().cwiseQuotient(size);
  };
  // At a double point the last steps stay at the root of rounding.
  if (!(length < 1e-6) || !(residual(y).maxCoeff() < 1e-10)) return std::nullopt;
  if (((y - window.lower + slack).array() < 0).any() || ((window.upper - y + slack).array() < 0).any())
    return std::nullopt;
  for (Eigen::Index i = 0; i < 2; ++i) {  // a coordinate that is zero to rounding is printed as 0
    Vector2d rounded = y;
    rounded(i) = 0;
    if (std::abs(y(i)) < 1e-9 * size(i) && residual(rounded).maxCoeff() <= residual(y).maxCoeff() + 1e-15)
      y = rounded;
  }
  return y;
}

bool is_spurious(const PlanarMap& f, double h, const Vector2d& y, const Window& window) {
  const Vector2d change = h * f(y).cwiseAbs().cwiseQuotient(window.size());
  return !(change.maxCoeff() < 1e-6);
}

namespace {

/// Lexicographic order, the first component first.
bool less(const Vector2d& a, const Vector2d& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// With its multipliers. @param scale  positive: over which the map changes noticeably
FixedPoint fixed_point_at(const PlanarMap& map, const Vector2d& y, const Vector2d& scale) {
  const Multipliers mu = multipliers_of(differenced_jacobian(map, y, scale));
  return {y, mu, classify_map(mu)};
}

/// The angle from a to b, in (-pi, pi].
/// atan2 of cross and dot product, independent of both lengths.
double turn(const Vector2d& a, const Vector2d& b) { return std::atan2(a(0) * b(1) - a(1) * b(0), a.dot(b)); }

/// The angle by which g turns from a to b on a straight line; NaN where that cannot be said.
/// Halves the line until both halves turn by less than pi / 4, so that no whole turn is missed between two
/// looks of a smooth g.
/// @param looks  that are left, of all lines
double turn_between(const PlanarMap& g, const Vector2d& a, const Vector2d& ga, const Vector2d& b,
                    const Vector2d& gb, int& looks) {
  const Vector2d middle = (a + b) / 2;
  const Vector2d gm = g(middle);
  for (const Vector2d& known : {gm, gb})
    if (!known.allFinite() || known.isZero(0)) return std::nan("");
  const double first = turn(ga, gm), second = turn(gm, gb);
  constexpr double little = std::numbers::pi / 4;
  if (std::abs(first) < little && std::abs(second) < little) return first + second;
  if (--looks <= 0 || middle == a || middle == b) return std::nan("");
  return turn_between(g, a, ga, middle, gm, looks) + turn_between(g, middle, gm, b, gb, looks);
}

/// The square of a lattice over the window with its lower left corner at (i, j).
struct Cell {
  int i, j, width;
};

/// A tree of squares: each is dropped, divided or handed to Newton's method. Values at lattice points are
/// kept, so that squares share those of their corners.
class CellSearch {
 public:
  CellSearch(const PlanarMap& map, const Window& window, std::int64_t most_steps)
      : left_(most_steps), size_(window.size()), window_(window) {
    map_ = [this, &map](const Vector2d& y) {
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
  [[nodiscard]] Vector2d at(double i, double j) const {
    return window_.lower + Vector2d(i, j).cwiseProduct(size_) / sides;
  }

  /// Phi(y) - y in sizes of the window, at a point of the lattice.
  const Vector2d& value(int i, int j) {
    const auto [entry, isnew] = values_.try_emplace(std::int64_t{i} * (sides + 1) + j);
    if (isnew) {
      const Vector2d y = at(i, j);
      entry->second = (map_(y) - y).cwiseQuotient(size_);
    }
    return entry->second;
  }

  /// Newton's method from the middle of a cell, which may stray three widths; the point is kept if it is
  /// new.
  void take(const Cell& cell) {
    constexpr double same = 1e-7;  // in sizes of the window
    const double middle = cell.width / 2.0;
    const auto y =
        newton_fixed_point(map_, window_, at(cell.i + middle, cell.j + middle), 3.0 * cell.width / sides);
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
  Vector2d size_;
  Window window_;
  PlanarMap map_;
  std::unordered_map<std::int64_t, Vector2d> values_;
  FixedPointSearch found_;
};

}  // namespace

// The winding number of g along the border, from the angles between neighbouring values.
std::optional<int> degree_around(const PlanarMap& g, const Window& window) {
  require_valid(window);
  constexpr int pieces = 64;
  int looks = 10'000;
  const Vector2d &lower = window.lower, &upper = window.upper;
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
      angle += turn_between(g, from, there, to, next, looks);
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

// The degree is taken of the same g in sizes of the window: scaling by positive numbers does not change it.
FixedPointSearch search_fixed_points(const PlanarMap& map, const Window& window, std::int64_t most_steps) {
  require_valid(window);
  FixedPointSearch found = CellSearch(map, window, most_steps).run();
  const Vector2d size = window.size();
  found.degree =
      degree_around([&](const Vector2d& y) -> Vector2d { return (map(y) - y).cwiseQuotient(size); }, window);
  sum_indices(found);
  return found;
}

// Fixed points of Phi^2 that Phi moves by at least 1e-5 of the window. Newton's method starts from a grid:
// Phi^2 is so steep where a step is long that a search in cells comes to no end.
std::vector<PeriodTwo> find_period_two(const PlanarMap& map, const Window& window) {
  require_valid(window);
  constexpr int starts = 31;
  const Vector2d size = window.size();
  const PlanarMap twice = [&](const Vector2d& y) -> Vector2d { return map(map(y)); };
  const auto apart = [&](const Vector2d& a, const Vector2d& b) {
    return (a - b).cwiseQuotient(size).norm() >= 1e-5;
  };
  std::vector<Vector2d> roots;
  for (int i = 0; i < starts; ++i)
    for (int j = 0; j < starts; ++j) {
      const Vector2d middle = Vector2d(j + 0.5, i + 0.5) / starts;
      const auto y = newton_fixed_point(twice, window, window.lower + middle.cwiseProduct(size));
      if (y && std::ranges::all_of(roots, [&](const Vector2d& other) { return apart(other, *y); }))
        roots.push_back(*y);
    }
  std::ranges::sort(roots, less);
  std::vector<PeriodTwo> found;
  for (const Vector2d& y : roots) {
    const Vector2d other = map(y);
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
  const PlanarMap map = [&](const Vector2d& y) -> Vector2d {
    return y + field.rhs(y).cwiseQuotient(largest).cwiseProduct(size);
  };
  const FixedPointSearch searched = search_fixed_points(map, window);
  found.whole = searched.whole;
  found.degree = searched.degree;
  if (searched.whole)
    for (const FixedPoint& point : searched.points) {
      const std::optional<Equilibrium> refined = equilibrium_from(field, window, point.state);
      if (refined && std::ranges::none_of(found.points, [&](const Equilibrium& known) {
            return known.is(refined->state, refined->resolution);
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
