#include "limits/fidelity/settled_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "integrators/implicit/anderson.hpp"

namespace hmax {

SettledState settled_state(const VectorFunction& step, const Eigen::VectorXd& start, double left,
                           const std::function<void()>& watch, double size) {
  const double tolerance = std::max(1e-14, 1e-8 * left);
  /// Equations that are solved to a tolerance of their own leave more: it counts as settled where it no
  /// longer falls, to a thousandth.
  const double tolerable = 1e-3 * left;
  constexpr int most = 4000, patience = 200, most_idle = 1000;
  /// Beyond so many times the least residual the memory misleads.
  constexpr double lost = 1e4;
  const Eigen::Index n = start.size();
  AndersonMixing<Eigen::VectorXd, 1> mixing;
  std::array<Eigen::VectorXd, 1> q{start}, change{start};
  SettledState best{.q = start, .residual = std::numeric_limits<double>::infinity()};
  Eigen::VectorXd y = Eigen::VectorXd::Zero(2 * n);
  int best_at = 0;
  for (int i = 1; i <= most; ++i) {
    if (watch) watch();
    y.head(n) = q[0];
    change[0] = step(y).head(n) - q[0];
    best.steps = i;
    const double residual = change[0].norm() / std::max(q[0].norm(), size);
    if (residual < best.residual) {
      best.q = q[0];
      best.residual = residual;
      best_at = i;
    }
    if (residual <= tolerance || (best.residual <= tolerable && i >= best_at + patience)) {
      best.settled = true;
      return best;
    }
    if (i >= best_at + most_idle) break;
    if (!std::isfinite(residual) || residual > lost * best.residual) {
      if (!std::isfinite(best.residual)) return best;
      mixing.forget();
      q[0] = best.q;
      y.head(n) = best.q;
      change[0] = step(y).head(n) - best.q;
    }
    mixing.step(q, change);
  }
  best.settled = best.residual <= tolerable;
  return best;
}

}  // namespace hmax
