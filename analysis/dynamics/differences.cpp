#include "analysis/dynamics/differences.hpp"

#include <array>
#include <limits>

namespace hmax {
namespace {

/// The column d g / d y_j.
Eigen::VectorXd differenced_column(const VectorFunction& g, const Eigen::VectorXd& y, Eigen::Index j,
                                   double scale, Eigen::Index rows) {
  // Twelve increments, each 1.6 times smaller than the last.
  constexpr int levels = 12;
  constexpr double shrink = 1.6;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd best = Eigen::VectorXd::Constant(rows, nan);
  Eigen::ArrayXd least = Eigen::ArrayXd::Constant(rows, std::numeric_limits<double>::infinity());
  std::array<Eigen::ArrayXd, levels> before, now;  // before[k]: extrapolated k times at the last increment
  int known = 0;
  double increment = scale / 50;
  for (int level = 0; level < levels; ++level, increment /= shrink) {
    Eigen::VectorXd ahead = y, behind = y;
    ahead(j) += increment;
    behind(j) -= increment;
    // What is divided by is the difference of the two machine numbers.
    now[0] = (g(ahead) - g(behind)).array() / (ahead(j) - behind(j));
    if (!now[0].allFinite()) {
      known = 0;
      continue;
    }
    double factor = shrink * shrink;
    for (int k = 1; k <= known; ++k, factor *= shrink * shrink) {
      const auto at = static_cast<std::size_t>(k);
      // T_k = (r^2k T_k-1(d / r) - T_k-1(d)) / (r^2k - 1), r = 1.6 [ridders1982accurate].
      now[at] = (factor * now[at - 1] - before[at - 1]) / (factor - 1);
      // The larger of the differences to the two values that it was made from.
      const Eigen::ArrayXd error = (now[at] - now[at - 1]).abs().max((now[at] - before[at - 1]).abs());
      for (Eigen::Index i = 0; i < rows; ++i)
        if (error(i) < least(i)) {
          least(i) = error(i);
          best(i) = now[at](i);
        }
    }
    ++known;
    std::swap(before, now);
  }
  return best;
}

}  // namespace

// One value of g more than the columns need, for the number of rows.
Eigen::MatrixXd differenced_jacobian(const VectorFunction& g, const Eigen::VectorXd& y,
                                     const Eigen::VectorXd& scale) {
  const Eigen::Index rows = g(y).size();
  Eigen::MatrixXd J(rows, y.size());
  for (Eigen::Index j = 0; j < y.size(); ++j) J.col(j) = differenced_column(g, y, j, scale(j), rows);
  return J;
}

}  // namespace hmax
