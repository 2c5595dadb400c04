#include "analysis/dynamics/fixed_point_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

/// How far a step leads from y, in sizes of the window; a fixed point stays below.
double map_residual(const PlanarMap& map, const Vector2d& y, const Vector2d& size) {
  return (map(y) - y).cwiseAbs().cwiseQuotient(size).maxCoeff<Eigen::PropagateNaN>();
}
constexpr double fixed_residual = 1e-10;

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
  const auto residual_at = [&](const Vector2d& at) { return map_residual(map, at, size); };
  // At a double point the last steps stay at the root of rounding.
  if (!(length < 1e-6) || !(residual_at(y) < fixed_residual)) return std::nullopt;
  if (((y - window.lower + slack).array() < 0).any() || ((window.upper - y + slack).array() < 0).any())
    return std::nullopt;
  for (Eigen::Index i = 0; i < 2; ++i) {  // a coordinate that is zero to rounding is printed as 0
    Vector2d rounded = y;
    rounded(i) = 0;
    if (std::abs(y(i)) < 1e-9 * size(i) && residual_at(rounded) <= residual_at(y) + 1e-15) y = rounded;
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

/// The square of a lattice over the window with its lower left corner at (i, j).
struct Cell {
  std::int64_t i, j, width;
};

/// At the corners of a square and in its middle.
using Values = std::array<Vector2d, 5>;

/// A tree of squares: each is dropped, divided or handed to Newton's method. Values at lattice points are
/// kept, so that squares share those of their corners.
/// Points keep what Newton's method finds:
///   take(start, leash)     starts it; the leash is in sizes of the window
///   covers(box, values)    whether nothing more is to be found in a box with these values
///   is_crowded(box)        whether there may be more than its size shows
///   is_straight(box)       whether what the values in a box tell of slopes may be believed
///   ends()                 whether the search has to end early
template <class Points>
class CellSearch {
 public:
  /// @param g      whose zeros are searched for
  /// @param leash  three widths of the square at least
  CellSearch(const PlanarMap& g, const Window& window, Points& points, double leash)
      : g_(g), window_(window), size_(window.size()), points_(points), leash_(leash) {}

  /// Starts with 32 x 32 squares. Whether it has come to its end.
  bool run() {
    for (std::int64_t i = 0; i < sides; i += coarse)
      for (std::int64_t j = 0; j < sides; j += coarse) explore({i, j, coarse});
    return !points_.ends();
  }

 private:
  // In distances of the lattice: squares to begin with, and those that are divided further where it is
  // crowded.
  static constexpr std::int64_t sides = std::int64_t{1} << 48, coarse = sides / 32, fine = sides / 4096;

  /// The state at a place of the lattice.
  [[nodiscard]] Vector2d at(std::int64_t i, std::int64_t j) const {
    return window_.lower + Vector2d(double(i), double(j)).cwiseProduct(size_) / double(sides);
  }

  const Vector2d& value(std::int64_t i, std::int64_t j) {
    const auto [entry, isnew] = values_.try_emplace({i, j});
    if (isnew) entry->second = g_(at(i, j));
    return entry->second;
  }

  void take(const Cell& cell) {
    points_.take((at(cell.i, cell.j) + at(cell.i + cell.width, cell.j + cell.width)) / 2,
                 std::max(leash_, 3 * double(cell.width) / double(sides)));
  }

  /// Into four quarters, each explored in turn.
  void split(const Cell& cell) {
    const std::int64_t half = cell.width / 2;
    for (const std::int64_t i : {cell.i, cell.i + half})
      for (const std::int64_t j : {cell.j, cell.j + half}) explore({i, j, half});
  }

  /// Decides by the values of g at the four corners and the middle.
  void explore(const Cell& cell) {
    if (points_.ends()) return;
    const auto [i, j, width] = cell;
    const Values g{value(i, j), value(i + width, j), value(i, j + width), value(i + width, j + width),
                   value(i + width / 2, j + width / 2)};
    const auto finite = std::ranges::count_if(g, [](const Vector2d& at) { return at.allFinite(); });
    if (finite == 0) return;
    if (finite < 5) {  // the edge of what diverges
      if (width > coarse / 8) split(cell);
      return;
    }
    const Window box{at(i, j), at(i + width, j + width)};
    if (points_.covers(box, g)) return;
    // g(u) = a + B u + misfit, u in [-1, 1]^2.
    const Vector2d a = (g[0] + g[1] + g[2] + g[3]) / 4;
    // Slopes of the plane of least squares through the corners, in half widths of the cell.
    Matrix2d B;
    B << (g[1] + g[3] - g[0] - g[2]) / 4, (g[2] + g[3] - g[0] - g[1]) / 4;
    // The misfit is the twisting term of the corners and the bulge of the middle.
    const Vector2d doubt = 2 * ((g[0] + g[3] - g[1] - g[2]) / 4).cwiseAbs() + 2 * (g[4] - a).cwiseAbs();
    // |a_i| > sum_j |B_ij| + doubt_i: component i has no zero in [-1, 1]^2.
    if ((a.cwiseAbs().array() > (B.cwiseAbs().rowwise().sum() + doubt).array()).any()) return;
    const bool is_crowded = points_.is_crowded(box);
    const Matrix2d inverse = B.inverse();
    if (inverse.allFinite() && !is_crowded) {
      // u = -B^-1 (a + misfit): where |B^-1 a| exceeds 1 + |B^-1| doubt no zero lies in the cell.
      const Vector2d zero = inverse * a, around = inverse.cwiseAbs() * doubt;
      const bool misses = (zero.cwiseAbs().array() > 1 + around.array()).any();
      if ((misses || around.maxCoeff() < 0.5) && points_.is_straight(box))
        return misses ? void() : take(cell);
    }
    if (width > (is_crowded ? 2 : fine)) return split(cell);
    take(cell);
  }

  struct Hash {
    std::size_t operator()(const std::pair<std::int64_t, std::int64_t>& place) const {
      return std::hash<std::int64_t>()(place.first * 0x9E3779B97F4A7C15 + place.second);
    }
  };

  const PlanarMap& g_;
  Window window_;
  Vector2d size_;
  Points& points_;
  double leash_;
  std::unordered_map<std::pair<std::int64_t, std::int64_t>, Vector2d, Hash> values_;
};

/// More than these are not isolated, or nobody reads them; fewer may be searched for down to rounding.
constexpr std::size_t most_points = 500, few = 20;
/// Of a map, or of a field and its Jacobian, after which a search is cut short; where some of few points have
/// been missed, so many more.
constexpr std::int64_t most_evaluations = 400'000, more_evaluations = 100'000;

/// Of a map, each once.
class FixedPoints {
 public:
  FixedPoints(const PlanarMap& map, const Window& window) : map_(map), window_(window) {}

  Vector2d map(const Vector2d& y) {
    --left_;
    return map_(y);
  }
  [[nodiscard]] bool ends() const { return left_ <= 0; }
  [[nodiscard]] static bool is_crowded(const Window& /*box*/) { return false; }
  [[nodiscard]] static bool is_straight(const Window& /*box*/) { return true; }
  /// Ends where every point of the cell is fixed.
  bool covers(const Window& /*box*/, const Values& g) {
    constexpr double rounding = 1e-9;
    if (std::ranges::all_of(g, [](const Vector2d& at) { return at.cwiseAbs().maxCoeff() < rounding; }))
      left_ = 0;
    return left_ == 0;
  }
  void take(const Vector2d& start, double leash) {
    constexpr double same = 1e-7;  // in sizes of the window
    const PlanarMap counted = [this](const Vector2d& y) { return map(y); };
    const auto y = newton_fixed_point(counted, window_, start, leash);
    if (!y) return;
    const bool known = std::ranges::any_of(found, [&](const FixedPoint& other) {
      return (other.state - *y).cwiseQuotient(window_.size()).norm() < same;
    });
    if (!known) add(*y);
  }
  void add(const Vector2d& y) {
    found.push_back(fixed_point_at([this](const Vector2d& at) { return map(at); }, y, window_.size() / 16));
    if (found.size() > most_points) left_ = 0;
  }

  std::vector<FixedPoint> found{};

 private:
  const PlanarMap& map_;
  Window window_;
  std::int64_t left_ = most_evaluations;
};

/// Of a field.
class FieldPoints {
 public:
  /// @param is_suspicious  whether some have been missed
  FieldPoints(Equilibria& equilibria, std::int64_t most_evaluations, bool is_suspicious)
      : equilibria_(equilibria), most_(most_evaluations), is_suspicious_(is_suspicious) {}

  [[nodiscard]] bool ends() const {
    return !equilibria_.isolated() || equilibria_.count() > most_points || equilibria_.evaluations() > most_;
  }
  /// Around one of few others may be very near.
  [[nodiscard]] bool is_crowded(const Window& box) const {
    return is_suspicious_ || (equilibria_.count() <= few && equilibria_.holds(box));
  }
  [[nodiscard]] bool covers(const Window& box, const Values& /*g*/) const { return equilibria_.covers(box); }
  [[nodiscard]] bool is_straight(const Window& box) const {
    return equilibria_.change_of_slopes((box.lower + box.upper) / 2, box.size() / 2) < 0.1;
  }
  void take(const Vector2d& start, double leash) { equilibria_.take(start, leash); }

 private:
  Equilibria& equilibria_;
  std::int64_t most_;
  bool is_suspicious_;
};

}  // namespace

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
}  // namespace

// The degree is taken of the same g in sizes of the window: scaling by positive numbers does not change it.
FixedPointSearch search_fixed_points(const PlanarMap& map, const Window& window,
                                     const std::vector<Vector2d>& known) {
  require_valid(window);
  const Vector2d size = window.size();
  FixedPoints points(map, window);
  for (const Vector2d& y : known)
    if (map_residual(map, y, size) < fixed_residual) points.add(y);
  const PlanarMap g = [&](const Vector2d& y) -> Vector2d { return (points.map(y) - y).cwiseQuotient(size); };
  FixedPointSearch found;
  found.whole = CellSearch(g, window, points, 0).run();
  std::ranges::sort(points.found, less, &FixedPoint::state);
  found.points = points.found;
  found.degree = degree_around(g, window);
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

// Where the degree tells that one of few has been missed, all squares are divided down to rounding.
EquilibriumSet search_equilibria(const PlanarField& field, const Window& window) {
  Equilibria equilibria(field, window);
  equilibria.take_grid();
  const PlanarMap f = [&](const Vector2d& y) { return equilibria.rhs(y); };
  // Valleys in which zeros lie may not run along the axes: a leash far beyond the width of small squares.
  const auto search = [&](bool is_suspicious) {
    const std::int64_t most = is_suspicious ? equilibria.evaluations() + more_evaluations : most_evaluations;
    FieldPoints points(equilibria, most, is_suspicious);
    return CellSearch(f, window, points, 0.02).run();
  };
  EquilibriumSet found;
  found.whole = search(false);
  found.degree = degree_around(field.rhs, window, true);
  found.index_sum = equilibria.index_sum();
  const bool is_missing = found.degree && found.index_sum && !found.accounts();
  if (found.whole && is_missing && equilibria.count() <= few) {
    found.whole = search(true);
    found.index_sum = equilibria.index_sum();
  }
  found.points = equilibria.points();
  for (const Equilibrium& e : found.points)  // on which side of the border rounding decides
    if ((e.state.array() == window.lower.array()).any() || (e.state.array() == window.upper.array()).any())
      found.degree.reset();
  return found;
}

}  // namespace hmax
