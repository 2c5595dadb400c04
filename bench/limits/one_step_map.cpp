#include "bench/limits/one_step_map.hpp"

#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

using Eigen::VectorXd;

/// `steps` steps of length h from y; NaN when they do not reach their end.
VectorXd steps_from(const Method& method, Problem& problem, double h, int steps, const VectorXd& y) {
  const VectorXd lost = VectorXd::Constant(y.size(), std::numeric_limits<double>::quiet_NaN());
  if (!y.allFinite()) return lost;
  problem.y0 = y;
  const RunRecord record = method.bind(problem).run({.t_end = steps * h, .h = h, .jacobian = {1}}, {});
  return record.outcome == Outcome::reached_end ? record.y : lost;
}

/// Whether twelve steps end where twelve times one step ends. They are short, so that nothing grows, but not
/// so short that what a method remembers would not show.
bool remembers(const Method& method, Problem& problem) {
  constexpr int steps = 12;
  const VectorXd scale = problem.y0.cwiseAbs().cwiseMax(0.5);
  for (const double shift : {0.0, 0.37, -0.71}) {
    VectorXd y = problem.y0 + shift * scale;
    for (Eigen::Index i = 1; i < y.size(); i += 2) y(i) -= 0.6 * scale(i);
    const double change = std::visit(
        [&](const auto& system) {
          typename std::remove_cvref_t<decltype(system)>::State state = y, f = y, moved = y, f_moved = y;
          moved += 1e-3 * scale;
          system.rhs(0, state, f);
          system.rhs(0, moved, f_moved);
          return f.cwiseQuotient(scale).norm() + 1e3 * (f_moved - f).cwiseQuotient(scale).norm();
        },
        problem.system);
    if (!(change > 0) || !std::isfinite(change)) continue;
    const double h = 0.3 / change;
    const VectorXd together = steps_from(method, problem, h, steps, y);
    for (int step = 0; step < steps; ++step) y = steps_from(method, problem, h, 1, y);
    if ((together - y).cwiseQuotient(scale).norm() > 1e-9) return true;
  }
  return false;
}

}  // namespace

VectorFunction one_step_map(const Method& method, const Problem& problem, double h) {
  constexpr const char* remedy =
      "choose a one-step method of fixed steps, like explicit_euler, rk4 or trapezoidal";
  if (!method.fixed_step)
    throw InputError(fmt::format("{} chooses its steps itself, so a step of it is no map of states; {}",
                                 method.id, remedy));
  if (!(h > 0) || !std::isfinite(h))
    throw InputError(
        fmt::format("the step is {} but must be a positive finite number; give --h in seconds, for instance "
                    "0.5",
                    to_text(h)));
  check({.t_end = h, .h = h}, method, problem);
  const auto own = std::make_shared<Problem>(problem);
  if (remembers(method, *own))
    throw InputError(fmt::format(
        "{} remembers more than the last state, so a step of it is no map of states; {}", method.id, remedy));
  return [method, own, h](const VectorXd& y) { return steps_from(method, *own, h, 1, y); };
}

}  // namespace hmax
