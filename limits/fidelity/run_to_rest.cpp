#include "limits/fidelity/run_to_rest.hpp"

namespace hmax {

RunToRest run_to_rest(const VectorFunction& step, const MassMatrix<double>& mass, double left,
                      const std::function<void()>& watch) {
  constexpr int most = 1000;
  const Eigen::Index n = mass.size();
  Eigen::VectorXd y = Eigen::VectorXd::Zero(2 * n);
  double before = 0;
  for (int i = 1; i <= most; ++i) {
    if (watch) watch();
    const bool from_rest = before == 0;
    const Eigen::VectorXd next = step(y);
    if (!next.allFinite()) return {.q = {}, .steps = i};
    if (from_rest && (next - y).head(n).norm() <= 1e-3 * left * next.head(n).norm())
      return {.q = next.head(n), .steps = i};
    const Eigen::VectorXd v = next.tail(n);
    const double energy = v.dot(mass.times(v));
    if (energy < before) {
      y.tail(n).setZero();
      before = 0;
    } else {
      y = next;
      before = energy;
    }
  }
  return {.q = {}, .steps = most};
}

}  // namespace hmax
