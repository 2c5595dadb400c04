#include "analysis/amplification/region.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <unordered_map>

namespace hmax {

// Positive for outlines, which run counter-clockwise.
double RegionCurve::area() const {
  double twice = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Complex a = points[i], b = points[(i + 1) % points.size()];
    // The cross product a x b, twice the area of the triangle (0, a, b).
    twice += a.real() * b.imag() - b.real() * a.imag();
  }
  return twice / 2;
}

// In this order: what the family offers, Schur and Cohn's test of the polynomial in z, the spectral
// radius.
StableAt stable_at(const Amplification& amplification) {
  if (amplification.stable_at) return amplification.stable_at;
  if (amplification.in_z) return [p = *amplification.in_z](Complex z) { return p.is_at_most_one(z); };
  return [amplification](Complex z) { return amplification.spectral_radius(z) <= 1; };
}

namespace {

/// The nodes of the grid, with one row of unstable nodes all around the window.
class Grid {
 public:
  /// Evaluates (columns + 1) (rows + 1) nodes, half of them where symmetry tells the rest.
  Grid(const StableAt& is_stable, const PlaneWindow& window, int columns, int rows)
      : is_stable_(is_stable), window_(window), columns_(columns), rows_(rows) {
    stable_.resize(static_cast<std::size_t>(columns + 3) * static_cast<std::size_t>(rows + 3));
    // The plane is symmetric about its real axis: where the window is too, half of it says everything.
    const bool symmetric = window.im_from == -window.im_to;
    for (int j = 0; j <= rows; ++j)
      for (int i = 0; i <= columns; ++i)
        at(i, j) = symmetric && j > rows / 2 ? at(i, rows - j) : is_stable(node(i, j));
  }

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] bool stable(int i, int j) const { return stable_[index(i, j)] != 0; }
  /// Nodes from -1 to columns + 1 and rows + 1: the ring outside the window is unstable.
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j + 1) * static_cast<std::size_t>(columns_ + 3) +
           static_cast<std::size_t>(i + 1);
  }

  /// Nodes outside of the window lie on its edge, so that curves are closed along it.
  [[nodiscard]] Complex node(int i, int j) const {
    const double x = std::clamp(static_cast<double>(i) / columns_, 0.0, 1.0);
    const double y = std::clamp(static_cast<double>(j) / rows_, 0.0, 1.0);
    return {window_.re_from + x * (window_.re_to - window_.re_from),
            window_.im_from + y * (window_.im_to - window_.im_from)};
  }
  // Nodes of the ring around the window, which count as unstable.
  [[nodiscard]] bool outside(int i, int j) const { return i < 0 || j < 0 || i > columns_ || j > rows_; }

  /// Where stability changes between two neighbours, one stable and one not.
  [[nodiscard]] Complex crossing(Complex inside, Complex outside) const {
    // 45 halvings: 2^-45 of the side of a cell.
    for (int halving = 0; halving < 45; ++halving) {
      const Complex middle = (inside + outside) / 2.0;
      (is_stable_(middle) ? inside : outside) = middle;
    }
    return (inside + outside) / 2.0;
  }

  /// Of a cell with two opposite stable corners.
  [[nodiscard]] bool centre_is_stable(int i, int j) const {
    return is_stable_((node(i, j) + node(i + 1, j + 1)) / 2.0);
  }

 private:
  std::uint8_t& at(int i, int j) { return stable_[index(i, j)]; }

  const StableAt& is_stable_;
  PlaneWindow window_;
  int columns_, rows_;
  std::vector<std::uint8_t> stable_;
};

/// The edges of a grid that curves cross. An edge is named by its lower left node and its direction, and
/// holds one point of a curve. Every square links the edges that a curve enters and leaves it by, the stable
/// side to the left.
class CrossedEdges {
 public:
  // All squares, those of the ring included.
  explicit CrossedEdges(const Grid& grid) : grid_(grid) {
    for (int j = -1; j <= grid.rows(); ++j)
      for (int i = -1; i <= grid.columns(); ++i) link_in_square(i, j);
  }

  /// The curves, each edge taken once.
  std::vector<RegionCurve> curves() {
    std::vector<RegionCurve> curves;
    for (const std::size_t start : starts_) {
      if (!edges_.contains(start)) continue;
      RegionCurve curve = follow(start);
      if (curve.points.size() > 2) curves.push_back(std::move(curve));
    }
    return curves;
  }

 private:
  struct Edge {
    std::size_t next;  ///< the edge by which the curve leaves the square that it enters here
    int i, j, i2, j2;  ///< of its two nodes
  };

  // The edge from (i, j) to (i + 1, j), and that to (i, j + 1).
  [[nodiscard]] std::size_t horizontal(int i, int j) const { return 2 * grid_.index(i, j); }
  [[nodiscard]] std::size_t vertical(int i, int j) const { return 2 * grid_.index(i, j) + 1; }

  /// Links the edges of a square by which a curve enters and leaves.
  void link_in_square(int i, int j) {
    // Corners counter-clockwise from the lower left one.
    const std::array<bool, 4> corner{grid_.stable(i, j), grid_.stable(i + 1, j), grid_.stable(i + 1, j + 1),
                                     grid_.stable(i, j + 1)};
    const int count = corner[0] + corner[1] + corner[2] + corner[3];
    if (count == 0 || count == 4) return;
    // Edge e runs from corner e to corner e + 1. With the stable side to its left a curve enters where the
    // corners go from stable to unstable and leaves where they go back.
    std::array<int, 2> entries{}, exits{};
    int entered = 0, left = 0;
    for (int e = 0; e < 4; ++e) {
      const bool a = corner[static_cast<std::size_t>(e)], b = corner[static_cast<std::size_t>((e + 1) % 4)];
      if (a && !b) entries[static_cast<std::size_t>(entered++)] = e;
      if (!a && b) exits[static_cast<std::size_t>(left++)] = e;
    }
    if (entered == 1) return link(i, j, entries[0], exits[0]);
    // Two opposite corners: the middle says whether the stable ones are joined.
    const bool joined = grid_.centre_is_stable(i, j);
    // Around a lone stable corner the curve leaves by the edge before, around an unstable one by the next.
    for (const int entry : entries) link(i, j, entry, joined ? (entry + 1) % 4 : (entry + 3) % 4);
  }

  /// Edges of a square are counted anticlockwise from the lower one.
  void link(int i, int j, int from, int to) {
    const std::array<std::size_t, 4> names{horizontal(i, j), vertical(i + 1, j), horizontal(i, j + 1),
                                           vertical(i, j)};
    const std::array<std::array<int, 4>, 4> ends{
        {{i, j, i + 1, j}, {i + 1, j, i + 1, j + 1}, {i, j + 1, i + 1, j + 1}, {i, j, i, j + 1}}};
    const auto f = static_cast<std::size_t>(from);
    edges_[names[f]] = {names[static_cast<std::size_t>(to)], ends[f][0], ends[f][1], ends[f][2], ends[f][3]};
    starts_.push_back(names[f]);
  }

  /// From edge to edge until the curve comes back; these are no longer there then.
  RegionCurve follow(std::size_t start) {
    RegionCurve curve;
    for (std::size_t name = start; edges_.contains(name);) {
      const Edge edge = edges_[name];
      edges_.erase(name);
      const Complex a = grid_.node(edge.i, edge.j), b = grid_.node(edge.i2, edge.j2);
      Complex point = a;
      if (grid_.outside(edge.i, edge.j) || grid_.outside(edge.i2, edge.j2))
        curve.clipped = true;  // both nodes are the same point of the edge, or its corner
      else
        point = grid_.stable(edge.i, edge.j) ? grid_.crossing(a, b) : grid_.crossing(b, a);
      if (curve.points.empty() || point != curve.points.back()) curve.points.push_back(point);
      name = edge.next;
    }
    return curve;
  }

  const Grid& grid_;
  // By the name of the edge; taken out by follow().
  std::unordered_map<std::size_t, Edge> edges_;
  std::vector<std::size_t> starts_;
};

}  // namespace

// Marching squares: nodes of a grid, linked crossings, curves; the region is to the left of each curve by
// construction.
std::vector<RegionCurve> region_boundary(const StableAt& is_stable, const PlaneWindow& window, int cells) {
  const double width = window.re_to - window.re_from, height = window.im_to - window.im_from;
  if (!(width > 0) || !(height > 0) || !std::isfinite(width) || !std::isfinite(height))
    throw std::invalid_argument(
        "the window of a stability region must be a rectangle of finite, positive sides");
  if (cells < 2) throw std::invalid_argument("a stability region needs a grid of at least two cells");
  // Squares, so that curves are resolved alike in both directions.
  const double side = std::max(width, height) / cells;
  // Even numbers of rows keep the real axis on the grid.
  const int columns = std::max(2, static_cast<int>(std::lround(width / side)));
  const int rows = std::max(2, 2 * static_cast<int>(std::lround(height / side / 2)));
  const Grid grid(is_stable, window, columns, rows);
  std::vector<RegionCurve> curves = CrossedEdges(grid).curves();
  std::ranges::sort(curves, [](const RegionCurve& a, const RegionCurve& b) {
    return std::abs(a.area()) > std::abs(b.area());
  });
  return curves;
}

// Probes rays every 4.45 degrees; one ray without exit means an unbounded region.
PlaneWindow window_of(const Amplification& amplification) {
  // The first exit on the ray z = r exp(i degrees).
  const auto exit = [&](double degrees) {
    return first_exit(
        amplification.of_eigenmode(Eigenmode(std::polar(1.0, degrees * std::numbers::pi / 180))));
  };
  // Just beside the imaginary axis, since on it many methods leave at once.
  double reach = 0;
  bool bounded = true;
  for (double degrees = 91; degrees <= 180; degrees += 4.45) {
    const double here = exit(degrees);
    if (std::isinf(here))
      bounded = false;
    else
      reach = std::max(reach, here);
  }
  if (bounded) {
    const double size = std::max(reach, 1e-6);
    const double height = std::clamp(1.35 * std::max(exit(91), exit(100)), 0.55 * size, 1.4 * size);
    return {-1.2 * size, 0.4 * size, -height, height};
  }
  // What is unstable in the right half-plane, as far as it goes.
  const UnstableSteps right = unstable_steps(amplification.of_eigenmode(Eigenmode(1)));
  double size = 6;
  for (const Interval& interval : right.intervals)
    if (std::isfinite(interval.to)) size = std::max(reach, 1.2 * interval.to);
  return {-0.5 * size, 1.2 * size, -0.9 * size, 0.9 * size};
}

}  // namespace hmax
