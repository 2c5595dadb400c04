#include "analysis/amplification/region.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "analysis/amplification/marching_squares.hpp"

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

/// The nodes of a grid of columns x rows squares over the window.
class Grid {
 public:
  Grid(const StableAt& is_stable, const PlaneWindow& window, int columns, int rows)
      : is_stable_(is_stable), window_(window), columns_(columns), rows_(rows) {}

  /// Whether nodes are stable, with a ring of unstable ones all around the window: node (i, j) stands at
  /// (i + 1, j + 1).
  [[nodiscard]] GridNodes nodes() const {
    GridNodes nodes = GridNodes::Constant(columns_ + 3, rows_ + 3, GridNode::outside);
    // The plane is symmetric about its real axis: where the window is too, half of it says everything.
    const bool symmetric = window_.im_from == -window_.im_to;
    for (int j = 0; j <= rows_; ++j)
      for (int i = 0; i <= columns_; ++i)
        nodes(i + 1, j + 1) = symmetric && j > rows_ / 2 ? nodes(i + 1, rows_ - j + 1)
                              : is_stable_(place(i, j))  ? GridNode::inside
                                                         : GridNode::outside;
    return nodes;
  }

  /// Nodes outside of the window lie on its edge, so that curves are closed along it.
  [[nodiscard]] Complex place(int i, int j) const {
    const double x = std::clamp(static_cast<double>(i) / columns_, 0.0, 1.0);
    const double y = std::clamp(static_cast<double>(j) / rows_, 0.0, 1.0);
    return {window_.re_from + x * (window_.re_to - window_.re_from),
            window_.im_from + y * (window_.im_to - window_.im_from)};
  }
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

 private:
  const StableAt& is_stable_;
  PlaneWindow window_;
  int columns_, rows_;
};

/// The points of a curve; what it crosses outside of the window is the edge of that.
RegionCurve placed(const GridCurve& border, const GridNodes& nodes, const Grid& grid) {
  RegionCurve curve;
  for (const GridSide& side : border.sides) {
    const int i = side.i - 1, j = side.j - 1, i2 = side.upward ? i : i + 1, j2 = side.upward ? j + 1 : j;
    const Complex a = grid.place(i, j), b = grid.place(i2, j2);
    Complex point = a;
    if (grid.outside(i, j) || grid.outside(i2, j2))
      curve.clipped = true;  // both nodes are the same point of the edge, or its corner
    else
      point = nodes(side.i, side.j) == GridNode::inside ? grid.crossing(a, b) : grid.crossing(b, a);
    if (curve.points.empty() || point != curve.points.back()) curve.points.push_back(point);
  }
  return curve;
}

}  // namespace

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
  const GridNodes nodes = grid.nodes();
  const auto middle_is_stable = [&](int i, int j) {
    return is_stable((grid.place(i - 1, j - 1) + grid.place(i, j)) / 2.0);
  };
  std::vector<RegionCurve> curves;
  for (const GridCurve& border : border_of(nodes, middle_is_stable))
    if (RegionCurve curve = placed(border, nodes, grid); curve.points.size() > 2)
      curves.push_back(std::move(curve));
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
