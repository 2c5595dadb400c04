#include "bench/trajectory_limit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "analysis/growth.hpp"
#include "bench/predict.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Motion {
  std::vector<double> t;
  std::vector<Eigen::VectorXd> y;
  double largest = 0;  ///< distance from the origin
};

Motion motion_of(const Problem& problem, double t_end, int points) {
  Motion motion;
  RunSpec spec{.t_end = t_end, .adaptive = true, .rtol = 1e-10, .atol = 1e-12};
  spec.every = t_end / points;
  spec.max_steps = most_observed_steps;
  const Method method = find_method("dormand_prince_54");
  check(spec, method, problem);
  const RunRecord record =
      method.bind(problem).run(spec, [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
        motion.t.push_back(t);
        motion.y.emplace_back(y);
        motion.largest = std::max(motion.largest, y.norm());
      });
  if (record.outcome != Outcome::reached_end)
    throw InputError(
        fmt::format("the motion of {} does not reach t = {} s ({} at {} s); take a shorter --t-end",
                    problem.id, to_text(t_end), to_string(record.outcome), to_text(record.t)));
  return motion;
}

}  // namespace

std::optional<TrajectoryLimit> limit_along(const Method& method, const Problem& problem, double t_end,
                                           int points) {
  if (!method.amplification || !suits(method, problem)) return std::nullopt;
  const Motion motion = motion_of(problem, t_end, points);
  TrajectoryLimit limit{.t = motion.t,
                        .h_max = {},
                        .least = std::numeric_limits<double>::quiet_NaN(),
                        .y_least = motion.y.front()};
  for (std::size_t i = 0; i < motion.t.size(); ++i) {
    const Prediction here = predict(method, problem, linearised(problem, motion.t[i], motion.y[i]));
    if (here.bound == Bound::model) limit.growing += 1;
    limit.h_max.push_back(here.h_max.value_or(std::numeric_limits<double>::quiet_NaN()));
    const double h = limit.h_max.back();
    if (h < limit.least || (std::isnan(limit.least) && !std::isnan(h))) {
      limit.least = limit.h_max.back();
      limit.t_least = motion.t[i];
      limit.y_least = motion.y[i];
    }
  }
  limit.growing /= static_cast<double>(motion.t.size());
  return limit;
}

std::optional<double> limit_from_start(const Method& method, const Problem& problem, double t_end,
                                       double guess) {
  if (!method.fixed_step || !suits(method, problem)) return std::nullopt;
  if (t_end > 0.1 * guess * static_cast<double>(most_observed_steps)) return std::nullopt;
  const double allowed = 3 * motion_of(problem, t_end, 1000).largest;
  const Runner runner = method.bind(problem);
  const auto stays = [&](double h) {
    bool inside = true;
    RunSpec spec{.t_end = t_end, .h = h};
    const RunRecord record = runner.run(spec, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
      inside = inside && y.norm() <= allowed;
    });
    return inside && record.outcome == Outcome::reached_end;
  };
  const double farthest = std::min(100 * guess, t_end / 10);
  // Too short a run to tell a stable step from one that had no time to grow.
  if (farthest < 2 * guess) return std::nullopt;
  double low = 0.1 * guess;
  if (!stays(low)) return std::nullopt;
  double high = low;
  for (;;) {
    high *= 1.02;
    if (high > farthest) return infinity;
    if (!stays(high)) break;
    low = high;
  }
  while (high - low > 1e-4 * high) {
    const double middle = (low + high) / 2;
    (stays(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace hmax
