#include "analysis/dynamics/basins.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include <Eigen/LU>

#include "core/numbers.hpp"
#include "core/parallel_for.hpp"

namespace hmax {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// All quantities in units of `size`; the 3 x 3 system is regular because no two eigenvalues of a stable A
// add up to zero.
Trap::Trap(const Vector2d& equilibrium, const Matrix2d& J, const Vector2d& size)
    : equilibrium_{equilibrium[0], equilibrium[1]}, size_{size[0], size[1]} {
  // Both eigenvalues have negative real parts if and only if the trace is negative and the determinant
  // positive.
  const Matrix2d A = size.cwiseInverse().asDiagonal() * J * size.asDiagonal();
  if (!(A.trace() < 0) || !(A.determinant() > 0))
    throw std::invalid_argument("a trap is for stable equilibria: both eigenvalues need negative real parts");
  // Lyapunov's equation A^T P + P A = -1: P = c (d 1 + B^T B), where B A = -d 1.
  const double d = A.determinant(), c = -1 / (2 * A.trace() * d);
  const Matrix2d B = A - A.trace() * Matrix2d::Identity();
  const Matrix2d P = c * (d * Matrix2d::Identity() + B.transpose() * B);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) P_[i][j] = P(i, j);
  // The singular values of B: their squares have the sum |B|^2 and the product d^2.
  const double sum = B.squaredNorm(), largest = (sum + std::sqrt(std::max(0.0, sum * sum - 4 * d * d))) / 2;
  // u^T P u >= p_min |u|^2, so u^T P u < 1e-6 p_min gives |u| < 1e-3.
  bound_ = 1e-6 * c * (d + d * d / largest);
  // |2 u^T P N| <= |u|^2 / 2 where |N| <= |u| / (4 p_max).
  slack_ = 1 / (16 * c * (d + largest));
}

Trap::Trap(const Vector2d& equilibrium, const Kink& kink, const Vector2d& size)
    : equilibrium_{equilibrium[0], equilibrium[1]}, size_{size[0], size[1]}, P_{} {
  const Vector2d in_units(size[0], size[1] / kink.unit);
  P_[0][0] = in_units[0] * in_units[0];
  P_[1][1] = in_units[1] * in_units[1];
  const double r = 1e-3 * in_units.minCoeff() / kink.swing;
  bound_ = r * r;
  double slowest = kink.rays.empty() ? -kink.rate : infinity;
  for (const Kink::Ray& ray : kink.rays) slowest = std::min(slowest, -ray.rate);
  slack_ = slowest / 16;
}

double Basins::share(int of) const {
  return static_cast<double>(std::ranges::count(fate, of)) / static_cast<double>(fate.size());
}

// Cell (column, row) has its centre at lower + ((column + 1/2) / columns, (row + 1/2) / rows) of the
// window.
Basins basins(const std::vector<FatesOf>& fates_of, const Window& window, int columns, int rows,
              const std::function<bool(double)>& going, std::size_t at_once) {
  if (columns < 1 || rows < 1 || !(window.size().minCoeff() > 0))
    throw std::invalid_argument("basins need a window with lower < upper and at least one cell");
  const auto width = static_cast<std::size_t>(columns), height = static_cast<std::size_t>(rows);
  const std::size_t rows_at_once = std::max<std::size_t>(1, at_once / width);
  Basins result{columns, rows, window, std::vector<int>(width * height, undecided)};
  const auto start = [&](std::size_t row, std::size_t column) -> Vector2d {
    // From the middle outwards, so that a window about zero gives starts that mirror each other exactly.
    const Vector2d from_middle((static_cast<double>(column) + 0.5 - columns / 2.0) / columns,
                               (static_cast<double>(row) + 0.5 - rows / 2.0) / rows);
    return (window.lower + window.upper) / 2 + from_middle.cwiseProduct(window.size());
  };
  const auto add_rows = [&](std::size_t call, std::size_t worker) {
    const std::size_t first = call * rows_at_once, count = std::min(rows_at_once, height - first);
    std::vector<Vector2d> starts;
    starts.reserve(count * width);
    for (std::size_t row = first; row < first + count; ++row)
      for (std::size_t column = 0; column < width; ++column) starts.push_back(start(row, column));
    fates_of[worker](starts, std::span(result.fate).subspan(first * width, count * width));
  };
  std::mutex asking;
  bool ended = false;
  const std::size_t calls = (height + rows_at_once - 1) / rows_at_once;
  std::size_t begun = 0;
  parallel_for(
      calls, add_rows, [](std::size_t) {},
      [&] {
        const std::scoped_lock lock(asking);
        return ended = ended || (going && !going(static_cast<double>(begun++) / static_cast<double>(calls)));
      });
  return result;
}

}  // namespace hmax
