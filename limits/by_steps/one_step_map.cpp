#include "limits/by_steps/one_step_map.hpp"

#include <cmath>
#include <limits>
#include <memory>

#include "core/input_error.hpp"
#include "core/numbers.hpp"

namespace hmax {

namespace {

using Eigen::VectorXd;

/// Steps of length h from y at t = 0 to t_end; NaN when they do not reach their end.
VectorXd steps_from(const Method& method, Problem& problem, double h, double t_end, const VectorXd& y) {
  VectorXd lost = VectorXd::Constant(y.size(), std::numeric_limits<double>::quiet_NaN());
  if (!y.allFinite()) return lost;
  problem.y0 = y;
  const RunRecord record = method.bind(problem).run({.t_end = t_end, .h = h, .jacobian = {1}}, {});
  return record.outcome == Outcome::reached_end ? record.y : lost;
}

}  // namespace

VectorFunction one_step_map(const Method& method, const Problem& problem, double h) {
  return steps_map(method, problem, h, h);
}

VectorFunction steps_map(const Method& method, const Problem& problem, double h, double t_end) {
  constexpr const char* remedy =
      "choose a one-step method of fixed steps, like explicit_euler, rk4 or trapezoidal";
  if (!method.fixed_step)
    throw input_error("{} chooses its steps itself, so a step of it is no map of states; {}", method.id,
                      remedy);
  if (!(h > 0) || !std::isfinite(h))
    throw input_error(
        "the step is {} but must be a positive finite number; give --h in seconds, for instance "
        "0.5",
        to_text(h));
  check({.t_end = t_end, .h = h}, method, problem);
  if (depends_on_past(method, problem))
    throw input_error("{} remembers more than the last state, so a step of it is no map of states; {}",
                      method.id, remedy);
  const auto own = std::make_shared<Problem>(problem);
  return [method, own, h, t_end](const VectorXd& y) { return steps_from(method, *own, h, t_end, y); };
}

}  // namespace hmax
