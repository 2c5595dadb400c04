#include "limits/by_steps/predict_by_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "analysis/dynamics/growth.hpp"
#include "analysis/spectrum/lanczos.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "core/text/sentences.hpp"
#include "limits/by_steps/old_jacobian.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "limits/verification.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

/// Up to which an observed limit is the predicted one, relative: of linear maps, and of truncated iterations,
/// whose orbits fluctuate.
constexpr double tolerance_linear = 0.01, tolerance_truncated = 0.05;
/// ln of the factor of a step up to which growth is not counted: undamped motions that old Jacobians or
/// explicit parts let grow more slowly are as good as stable in runs of a thousand steps.
constexpr double weak_growth = 5e-4;
constexpr std::int64_t watched_steps = 1024;

/// The range of |lambda| [1/s], as far as the modes are known; nothing moves of itself where `fastest` is 0.
struct RateRange {
  double slowest = infinity, fastest = 0;
};
RateRange rates_of(const ModeSet& modes) {
  RateRange rates;
  for (const Complex lambda : modes.spectrum.lambda)
    rates.fastest = std::max(rates.fastest, std::abs(lambda));
  for (const Complex lambda : modes.spectrum.lambda)
    if (std::abs(lambda) > 1e-7 * rates.fastest) rates.slowest = std::min(rates.slowest, std::abs(lambda));
  return rates;
}

/// The step sizes among which the limit is sought, by the rates of the model or, where it has none, of the
/// Jacobian that its steps have; infinite ones where neither has any.
StepMapSettings settings_of(const Linearised& near, bool linear, const StepQuestion& question,
                            const LinearModel& jacobian) {
  RateRange rates = rates_of(near.modes);
  if (rates.fastest == 0) rates = rates_of(mode_set(jacobian, near.point.is_body));
  StepMapSettings settings{.linear = linear};
  settings.least = 0.5 / rates.fastest;
  settings.most = std::clamp(100 / rates.slowest, 1e4 / rates.fastest, 1e7 / rates.fastest);
  settings.weak_growth = weak_growth;
  // Thousands of steps resolve that beside undamped motions. Implicit-explicit steps take too long for as
  // many.
  settings.long_power = question.options ? 128 : settings.power;
  settings.inner = energy_product(near.point.model);
  settings.watch = question.watch;
  return settings;
}

/// A limit and the motion that begins to grow there.
struct Found {
  Prediction row;
  StepMapLimit limit;
  StepMapSettings settings;
};

/// Whose Jacobian a run has.
std::string words_of_jacobian(const StepChoices& options, bool same_state) {
  if (options.is_frozen())
    return same_state ? "the frozen Jacobian is that of the initial state, which is this state"
                      : "the frozen Jacobian is that of the initial state, not of this state; "
                        "`advise` freezes that of the start of its motion";
  if (options.jacobian.every > 1)
    return "near this state a Jacobian of the last steps is the exact one but for terms of second order";
  return "the Jacobian is that of this state";
}

void say(Prediction& row, const std::string& sentence) { add_sentence(row.note, sentence); }

void put_limit(Prediction& row, const StepMapLimit& limit, const StepMapSettings& settings) {
  row.modes.clear();
  row.limiting.reset();
  row.h_max = limit.h_max;
  row.bound = std::isinf(limit.h_max) ? Bound::accuracy
              : limit.h_max > 0       ? Bound::stability
                                      : Bound::every_step;
  const std::string sought = std::isinf(limit.h_max) ? fmt::format("no step up to {:.3g} s", settings.most)
                             : limit.h_max > 0
                                 ? std::string("from h_max on a step")
                                 : fmt::format("already a step of {:.3g} s", 1e-3 * settings.least);
  const std::string strides = fmt::format(", sought in strides of {:.0f} %", 100 * (settings.stride - 1));
  if (settings.linear)
    say(row, fmt::format("{} has a spectral radius above {:.5g}{}", sought, std::exp(weak_growth), strides));
  else
    say(row,
        fmt::format(
            "{} lets a motion grow: a truncated iteration is homogeneous and not linear in the state, so "
            "that the limit is that of the mean growth over orbits of {} steps from seeded starts, not "
            "of every start{}",
            sought, settings.power * settings.blocks / 2, strides));
  if (!limit.resolved)
    say(row,
        "the iteration did not resolve slow growth at every step size, so that the limit may be smaller");
}

/// The model, the state whose Jacobian is taken, and the limit.
Found found_limit(const Method& method, const Problem& problem, const Linearised& near,
                  const StepQuestion& question, const LinearModel& jacobian) {
  const StepChoices options = question.options.value_or(StepChoices{});
  const bool by_modes = question.options && !options.is_frozen() && !options.is_truncated();
  Found found;
  found.settings = settings_of(near, !options.is_truncated(), question, jacobian);
  // A model that grows does so with every method.
  found.row = predict(question.options ? method : find_method("linearly_implicit_euler"), near);
  found.row.method = method.id;
  if (found.row.growing && question.options) {
    if (found.row.h_max && !by_modes)
      say(found.row,
          "that is the limit of exact Jacobians and exact linear solves; what growth makes of other steps "
          "is not computed");
    return found;
  }
  if (found.row.growing) {
    found.row.bound = Bound::model;
    found.row.h_max.reset();
    found.row.limiting = found.row.growing;
    found.row.note = growth_in_words(*found.row.growing, near.point);
    return found;
  }
  const bool same = near.point.model.t == 0 && near.point.model.y == problem.y0;
  if (question.options) say(found.row, words_of_jacobian(options, same));
  const Eigen::Index n = near.point.model.y.size();
  if (by_modes || std::isinf(found.settings.most)) {
    found.limit = {.h_max = infinity, .motion = start_vector(n)};
    return found;
  }
  found.limit =
      first_growing_step(step_maps(method, near.point.model, jacobian, options.linear), n, found.settings);
  put_limit(found.row, found.limit, found.settings);
  return found;
}

/// The problem with the Jacobian that a run has: that of its start, where a run starts elsewhere.
Problem as_run(const Problem& free, const StepQuestion& question, const LinearModel& jacobian) {
  if (!question.options || !question.options->is_frozen()) return free;
  Problem changed = free;
  std::visit(
      [&]<class Sys>(const Sys& system) {
        const RightHandSide rhs = [system](double t, const VectorXd& y, VectorXd& dydt) {
          // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): mostly of another type
          typename Sys::State in = y, out = y;
          system.rhs(t, in, out);
          dydt = out;
        };
        changed.system = with_jacobian_of(jacobian, rhs, is_autonomous(system));
      },
      free.system);
  changed.extended.reset();
  return changed;
}

/// How far a state is from rest: in energy, or where there is none by its numbers.
Distance distance_from(const VectorXd& rest, const LinearOperator& inner) {
  return [rest, inner](const Eigen::Ref<const VectorXd>& y) {
    const VectorXd d = y - rest;
    if (!d.allFinite()) return infinity;
    return inner ? std::sqrt(std::max(0.0, d.dot(inner(d)))) : d.norm();
  };
}

/// Runs at the steps that simulators take and far beyond.
Finding watched_without_limit(const Problem& problem, const ShowSteps& run, const Distance& distance,
                              double farthest) {
  Finding finding{
      .seen = {.h_max = infinity, .gap = std::numeric_limits<double>::quiet_NaN(), .agrees = true}};
  Observation& seen = finding.seen;
  for (const double h : steps_without_limit(problem, farthest)) {
    seen.steps = 512;
    seen.agrees = !grows_at(run, distance, h, seen.steps);
    if (seen.agrees) continue;
    seen.h_max = std::numeric_limits<double>::quiet_NaN();
    finding.why = fmt::format("runs of {} steps of {} s grow", seen.steps, to_text(h));
    break;
  }
  return finding;
}

/// The step at which runs begin to grow by more than weak_growth a step: from 2 % on both sides of the
/// prediction outwards, then by halves.
double onset_of_growth(const ShowSteps& run, const Distance& distance, double predicted) {
  // Half of the run lies between the quarters that are compared.
  const double least = weak_growth * static_cast<double>(watched_steps) / 2;
  const auto grows = [&](double h) { return observed_growth(run, distance, h, watched_steps) > least; };
  double low = 0.98 * predicted, high = 1.02 * predicted;
  while (grows(low) && low > 1e-2 * predicted) high = std::exchange(low, low / 1.2);
  while (!grows(high) && high < 1e2 * predicted) low = std::exchange(high, high * 1.2);
  while (high - low > 5e-4 * high) {
    const double middle = (low + high) / 2;
    (grows(middle) ? high : low) = middle;
  }
  return (low + high) / 2;
}

Finding watched_limit(const Found& found, const ShowSteps& run, const Distance& distance) {
  Finding finding{
      .seen = {.h_max = onset_of_growth(run, distance, *found.row.h_max), .steps = watched_steps}};
  Observation& seen = finding.seen;
  seen.gap = seen.h_max / *found.row.h_max - 1;
  const double tolerance = found.settings.linear ? tolerance_linear : tolerance_truncated;
  seen.agrees = std::abs(seen.gap) <= tolerance;
  if (seen.agrees) return finding;
  // Where growth sets in gradually its onset says little.
  const double slow = 1.5 * weak_growth * static_cast<double>(watched_steps);
  if (observed_growth(run, distance, 1.02 * *found.row.h_max, watched_steps) < slow)
    finding.excuse("growth beyond this limit is too slow for the runs to show where it begins");
  else
    finding.why =
        fmt::format("integration shows another limit, beyond the tolerance of {} %", 100 * tolerance);
  return finding;
}

void verify_steps(Found& found, const Method& method, const Problem& problem, const Linearised& near,
                  const StepQuestion& question, const LinearModel& jacobian) {
  const Problem free = after_ramps(problem);
  if (std::string why = why_not_verified(method, free, near); !why.empty()) return say(found.row, why);
  RunSpec spec;
  if (question.options) {
    spec.jacobian = question.options->jacobian;
    spec.linear_solve = question.options->linear;
  }
  const VectorXd& rest = near.point.model.y;
  const LinearOperator& inner = found.settings.inner;
  const Distance length = distance_from(VectorXd::Zero(rest.size()), inner);
  const VectorXd noise = start_vector(rest.size());
  VectorXd motion = found.limit.motion / length(found.limit.motion) + 0.01 / length(noise) * noise;
  motion /= motion.cwiseAbs().maxCoeff();
  const double size = small_displacement(problem, near, motion, 1e-7).size;
  const auto outcome = std::make_shared<Outcome>(Outcome::reached_end);
  const ShowSteps run =
      steps_of(method, as_run(free, question, jacobian), rest, size * motion, outcome, spec);
  const Distance distance = distance_from(rest, inner);
  Finding finding = std::isinf(*found.row.h_max)
                        ? watched_without_limit(problem, run, distance, found.settings.most)
                        : watched_limit(found, run, distance);
  if (driven_away(near, free)) finding.excuse_drive();
  finding.seen.step_defect = step_defect(method);
  if (!finding.why.empty()) say(found.row, finding.why);
  found.row.observed = finding.seen;
}

/// The same model with K times `factor`.
LinearModel stiffer(const LinearModel& model, double factor) {
  LinearModel changed = model;
  std::visit([&](auto& K) { K *= factor; }, changed.mechanical->K);
  changed.J = [J_of = model.J, factor, n = model.mechanical->mass.size()] {
    AnyMatrix J = J_of();
    // Sparse structures are stepped by K and C alone.
    if (auto* whole = std::get_if<Eigen::MatrixXd>(&J)) whole->bottomLeftCorner(n, n) *= factor;
    return J;
  };
  return changed;
}

}  // namespace

bool needs_step_map(const Method& method, const Prediction& row) {
  return row.bound == Bound::unknown && method.needs_split && method.fixed_step && method.bind;
}

Prediction predict_by_steps(const Method& method, const Problem& problem, const Linearised& near,
                            const StepQuestion& question) {
  const bool frozen = question.options && question.options->is_frozen();
  const LinearModel jacobian = frozen ? linear_model(problem, 0, problem.y0) : near.point.model;
  Found found = found_limit(method, problem, near, question, jacobian);
  const bool has_claim =
      !found.row.growing && (found.row.bound == Bound::stability || found.row.bound == Bound::accuracy);
  const bool moves = std::isfinite(found.settings.most);
  if (question.verified && has_claim && moves) verify_steps(found, method, problem, near, question, jacobian);
  return found.row;
}

double tolerated_stiffening(const Method& method, const Problem& problem, const Linearised& near,
                            const StepChoices& options, double h, const std::function<void()>& watch) {
  constexpr double most = 64, stride = 1.25, resolution = 1.02;
  const LinearModel& model = near.point.model;
  if (!model.mechanical) return std::numeric_limits<double>::quiet_NaN();
  const LinearModel jacobian = linear_model(problem, 0, problem.y0);
  const StepMapSettings settings =
      settings_of(near, !options.is_truncated(), {.options = options, .watch = watch}, jacobian);
  const VectorXd start = start_vector(model.y.size());
  const auto grows = [&](double factor) {
    if (watch) watch();
    return growth_of_steps(step_maps(method, stiffer(model, factor), jacobian, options.linear)(h), start,
                           settings)
        .grows;
  };
  if (grows(1)) return 0;
  double low = 1, high = stride;
  while (!grows(high)) {
    if (high >= most) return infinity;
    low = std::exchange(high, high * stride);
  }
  while (high / low > resolution) {
    const double middle = std::sqrt(low * high);
    (grows(middle) ? high : low) = middle;
  }
  return low;
}

}  // namespace hmax
