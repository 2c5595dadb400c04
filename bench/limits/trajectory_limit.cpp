#include "bench/limits/trajectory_limit.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "analysis/dynamics/growth.hpp"
#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "analysis/statics/static_solution.hpp"
#include "bench/catalogue/catalogue.hpp"
#include "bench/limits/mode_curve.hpp"
#include "bench/limits/mode_range.hpp"
#include "bench/limits/predict.hpp"
#include "bench/models/body_balance.hpp"
#include "bench/models/matrix_problem.hpp"
#include "bench/models/tissue_problem.hpp"
#include "problems/tissue/body.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string four_digits(double value) { return fmt::format("{:.4g}", value); }

/// The tangent of a model, of large bodies by the ends of its spectrum.
Linearised tangent(const Problem& problem, double t, const Eigen::VectorXd& y) {
  if (!problem.body || problem.body->dofs() <= small_enough_for_dense) return linearised(problem, t, y);
  Linearised near{.point = operating_point(problem, t, y)};
  const LinearModel& model = near.point.model;
  if (!set_curve(model, near.modes, small_enough_for_dense) &&
      !set_range(model, near.modes, small_enough_for_dense))
    throw InputError(fmt::format(
        "the stiffness of this body is not symmetric along its path, and all modes of {} degrees of freedom "
        "together are too many; take a smaller mesh, or a load that does not move",
        problem.body->dofs()));
  return near;
}

void look(const Watcher& watcher) {
  if (watcher) watcher();
}

/// Shows the motion from y0 to t_end at `points` instants, or where it is 0 after every step.
void show_motion(const Problem& problem, double t_end, int points, const Watcher& watcher, const Sink& show) {
  RunSpec spec{
      .t_end = t_end, .adaptive = true, .rtol = motion_tolerances.rtol, .atol = motion_tolerances.atol};
  if (points > 0) spec.every = t_end / points;
  spec.max_steps = most_observed_steps;
  const Method method = find_method("dormand_prince_54");
  check(spec, method, problem);
  const RunRecord record =
      method.bind(problem).run(spec, [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
        look(watcher);
        show(t, y);
      });
  if (record.outcome != Outcome::reached_end)
    throw InputError(
        fmt::format("the motion of {} does not reach t = {} s ({} at {} s); take a shorter --t-end",
                    problem.id, to_text(t_end), to_string(record.outcome), to_text(record.t)));
}

/// The size of one state.
MotionSize size_of(const Eigen::Ref<const Eigen::VectorXd>& y, bool mechanical) {
  if (!mechanical) return {.positions = y.norm(), .velocities = 0};
  const Eigen::Index n = y.size() / 2;
  return {.positions = y.head(n).norm(), .velocities = y.tail(n).norm()};
}

}  // namespace

std::optional<double> period_of_load(const Problem& problem) {
  double slowest = infinity;
  const auto look_at = [&](const TimeProfile& profile) {
    if (profile.kind == TimeProfile::Kind::sine && profile.omega != 0)
      slowest = std::min(slowest, std::abs(profile.omega));
  };
  if (problem.body) {
    const TissueSettings& settings = problem.body->settings();
    for (const Support& support : settings.supports) look_at(support.profile);
    for (const PressingForce& load : settings.forces) look_at(load.profile);
    for (const SphereTool& tool : settings.tools) look_at(tool.profile);
  } else if (const auto* oscillator = std::get_if<Oscillator>(&problem.system)) {
    const OscillatorParameters& p = oscillator->parameters();
    if (p.P != 0 && p.w != 0) slowest = std::abs(p.w);
  }
  if (std::isinf(slowest)) return std::nullopt;
  return 2 * std::numbers::pi / slowest;
}

double end_of_motion(const Problem& problem) {
  constexpr double most_ends = 100;
  const double period = period_of_load(problem).value_or(0);
  return period <= most_ends * problem.t_end ? std::max(period, problem.t_end) : problem.t_end;
}

std::optional<Path> path_of_matrices(const Problem& problem, double t_end) {
  if (!is_matrices_id(problem.id)) return std::nullopt;
  if (!(t_end > 0 && std::isfinite(t_end)))
    throw InputError(fmt::format("the end time is {} s but must be positive and finite; give another", to_text(t_end)));
  Path path{.at = {0}, .y = {}, .note = {}};
  const std::vector<double> times = times_of_matrices(problem);
  std::ranges::copy_if(times, std::back_inserter(path.at), [&](double t) { return t > 0 && t < t_end; });
  if (!times.empty()) path.at.push_back(t_end);
  path.y.assign(path.at.size(), Eigen::VectorXd::Zero(problem.y0.size()));
  return path;
}

Path motion_path(const Problem& problem, double t_end, int points, const Watcher& watcher) {
  if (auto path = path_of_matrices(problem, t_end)) return *std::move(path);
  struct Inverted {};
  Path path;
  const auto keep = [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    if (problem.body)
      if (const auto [volume, at] = problem.body->least_volume(t, y.head(problem.body->dofs()));
          !(volume > 0)) {
        path.note = fmt::format(
            "tetrahedron {} is turned inside out by t = {} s of the motion: what moves on from there is no body, and "
            "no limit is looked for beyond {} s",
            tetrahedron_number(problem, at), four_digits(t), four_digits(path.at.back()));
        throw Inverted{};
      }
    path.at.push_back(t);
    path.y.emplace_back(y);
  };
  try {
    show_motion(problem, t_end, points, watcher, keep);
  } catch (const Inverted&) {
  }
  return path;
}

MotionSize size_of_motion(const Problem& problem, double t_end, const Watcher& watcher) {
  MotionSize size;
  show_motion(problem, t_end, 0, watcher, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
    const MotionSize here = size_of(y, is_second_order(problem));
    size.positions = std::max(size.positions, here.positions);
    size.velocities = std::max(size.velocities, here.velocities);
  });
  return size;
}

Path load_path(const Problem& problem, int points, const Watcher& watcher) {
  if (!problem.body)
    throw InputError(
        fmt::format("{} is no body on a mesh, so no load is brought on; look along its motion", problem.id));
  if (!problem.body->is_autonomous())
    throw InputError(
        fmt::format("the load of {} changes with time; take gravity, press or pull, or look along "
                    "the motion",
                    problem.id));
  if (is_at_rest(*problem.body))
    throw InputError(fmt::format(
        "nothing loads {}, so no load can grow; give it one with --set, g of gravity or force of press "
        "and pull, or leave --along load out",
        problem.id));
  Path path;
  for (int i = 0; i <= points; ++i) {
    look(watcher);
    const double share = static_cast<double>(i) / points;
    Eigen::VectorXd y = problem.y0;
    if (i > 0) {
      const StaticSolution equilibrium = solve_static(
          static_model(problem, share),
          {.load_steps = 1 + static_cast<int>(4 * share), .leave_saddles = false}, [] { return 0.0; });
      if (!equilibrium.converged) {
        path.note =
            fmt::format("no equilibrium was found under more than {} of the load: under {} of it {}",
                        four_digits(path.at.back()), four_digits(share), cause_of(problem, equilibrium));
        break;
      }
      y.head(equilibrium.q.size()) = equilibrium.q;
    }
    path.at.push_back(share);
    path.y.push_back(std::move(y));
  }
  return path;
}

std::vector<std::optional<TrajectoryLimit>> limits_along(std::span<const Method> methods,
                                                         const Problem& problem, const Path& path,
                                                         const Watcher& watcher) {
  std::vector<std::optional<TrajectoryLimit>> limits;
  for (const Method& method : methods) {
    limits.emplace_back();
    if (!method.amplification || !suits(method, problem)) continue;
    limits.back() = TrajectoryLimit{.t = path.at,
                                    .h_max = {},
                                    .least = std::numeric_limits<double>::quiet_NaN(),
                                    .y_least = path.y.front()};
  }
  for (std::size_t i = 0; i < path.at.size(); ++i) {
    look(watcher);
    const Linearised near = tangent(problem, path.at[i], path.y[i]);
    for (std::size_t k = 0; k < methods.size(); ++k) {
      if (!limits[k]) continue;
      TrajectoryLimit& limit = *limits[k];
      const Prediction here = predict(methods[k], near);
      if (here.bound == Bound::model) limit.growing += 1;
      const double h = here.h_max.value_or(std::numeric_limits<double>::quiet_NaN());
      limit.h_max.push_back(h);
      if (h < limit.least || (std::isnan(limit.least) && !std::isnan(h))) {
        limit.least = h;
        limit.t_least = path.at[i];
        limit.y_least = path.y[i];
      }
    }
  }
  for (auto& limit : limits)
    if (limit) limit->growing /= static_cast<double>(path.at.size());
  return limits;
}

std::optional<TrajectoryLimit> limit_along(const Method& method, const Problem& problem, double t_end,
                                           int points) {
  if (!method.amplification || !suits(method, problem)) return std::nullopt;
  return limits_along({&method, 1}, problem, motion_path(problem, t_end, points)).front();
}

std::optional<StartLimit> limit_from_start(const Method& method, const Problem& problem, double t_end,
                                           double guess, const MotionSize& size, const Watcher& watcher) {
  if (!method.fixed_step || !suits(method, problem)) return std::nullopt;
  if (t_end > 0.1 * guess * static_cast<double>(most_observed_steps)) return std::nullopt;
  const bool mechanical = is_second_order(problem);
  const Runner runner = method.bind(problem);
  const auto stays = [&](double h) {
    bool inside = true;
    RunSpec spec{.t_end = t_end, .h = h};
    const RunRecord record = runner.run(spec, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
      look(watcher);
      const MotionSize here = size_of(y, mechanical);
      inside = inside && here.positions <= 3 * size.positions && here.velocities <= 3 * size.velocities;
    });
    return inside && record.outcome == Outcome::reached_end;
  };
  const double farthest = std::min(100 * guess, t_end / 10);
  // Too short a run to tell a stable step from one that had no time to grow.
  if (farthest < 2 * guess) return std::nullopt;
  double low = 0.1 * guess;
  if (!stays(low)) return std::nullopt;
  // Runs of t_end / h steps from low to high, one in each stride, take about t_end / (stride low) steps.
  constexpr double most_steps = 2e6, finest = 1e-4, coarsest = 0.02;
  const double stride = std::clamp(t_end / (low * most_steps), finest, coarsest);
  double high = low;
  for (;;) {
    high *= 1 + stride;
    if (high > farthest) return StartLimit{infinity, stride};
    if (!stays(high)) break;
    low = high;
  }
  while (high - low > 1e-4 * high) {
    const double middle = (low + high) / 2;
    (stays(middle) ? low : high) = middle;
  }
  return StartLimit{low, stride};
}

}  // namespace hmax
