#include "limits/steps/newton_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// The displacements after a run, shape (dofs); nothing when it does not reach its end.
std::optional<Eigen::VectorXd> displacements_after(const Runner& runner, double t_end, int steps) {
  const RunRecord record = runner.run({.t_end = t_end, .h = t_end / steps}, {});
  if (record.outcome != Outcome::reached_end) return std::nullopt;
  return record.y.head(record.y.size() / 2);
}

/// The error of displacements at time t, and how far its reference may be off: the difference between two of
/// which one takes half as many steps of a method of second order is three times the error of the other.
void set_error(NewtonStep& step, const Eigen::VectorXd& q, const Problem& problem) {
  const Runner reference = find_method("newmark").bind(problem);
  std::optional<Eigen::VectorXd> coarse = displacements_after(reference, step.h, 50);
  step.error = step.error_bound = std::numeric_limits<double>::quiet_NaN();
  for (const int steps : {100, 200, 400}) {
    const std::optional<Eigen::VectorXd> fine = displacements_after(reference, step.h, steps);
    if (coarse && fine) {
      step.error = largest_displacement(q - *fine);
      step.error_bound = largest_displacement(*coarse - *fine) / 3;
      if (step.error_bound <= 0.05 * step.error) return;
    }
    coarse = fine;
  }
}

}  // namespace

std::optional<NewtonStep> largest_newton_step(const Method& method, const Problem& problem) {
  if (!problem.body || problem.body->dofs() > most_newton_step_dofs ||
      is_too_slow(method, problem.body->dim()))
    return std::nullopt;
  constexpr double shortest = 1e-6, first = 1e-3, longest = 1;
  const Runner runner = method.bind(problem);
  const auto after = [&](double h) { return displacements_after(runner, h, 1); };

  double solved = first, failed = 0;
  std::optional<Eigen::VectorXd> q = after(solved);
  for (; !q && solved > shortest; q = after(solved)) {
    failed = solved;
    solved /= 2;
  }
  if (!q) return std::nullopt;
  while (failed == 0 && solved < longest) {
    const double next = std::min(2 * solved, longest);
    if (auto there = after(next)) {
      q = std::move(there);
      solved = next;
    } else {
      failed = next;
    }
  }
  while (failed > 1.05 * solved) {
    const double middle = std::sqrt(solved * failed);
    if (auto there = after(middle)) {
      q = std::move(there);
      solved = middle;
    } else {
      failed = middle;
    }
  }
  NewtonStep step{.h = solved, .is_limit = failed > 0};
  set_error(step, *q, problem);
  return step;
}

}  // namespace hmax
