#include "advice/motion/motion_limits.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "advice/motion/uncertainty.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "limits/by_steps/predict_by_steps.hpp"
#include "limits/predict.hpp"
#include "limits/steps/linearly_implicit.hpp"

namespace hmax {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
/// Of so many states at most the maps of steps are looked at: seconds for each candidate.
constexpr Eigen::Index most_states_stepped = 2000;

/// Of so few states limits are looked for all along the motion.
constexpr Eigen::Index small = 20;

/// At most so many states of a path, the first among them.
Path thinned(const Path& path, std::size_t most) {
  Path few;
  const std::size_t stride = std::max<std::size_t>(1, (path.at.size() + most - 1) / most);
  for (std::size_t i = 0; i < path.at.size(); i += stride) {
    few.at.push_back(path.at[i]);
    few.y.push_back(path.y[i]);
  }
  return few;
}

/// Of so many states of the reference the modes are found: of models without a mesh all eigenvalues, which
/// take n^3, of bodies the fastest and what may be negative, a second or two for 40,000 degrees of freedom.
std::size_t affordable_states(const Problem& problem) {
  if (problem.body) return factors_take_seconds(problem) ? 5 : 10;
  const auto n = static_cast<double>(problem.y0.size());
  return static_cast<std::size_t>(std::clamp(4e9 / (n * n * n), 3.0, 50.0));
}

/// The states at which limits are looked for: some of the reference, of small problems without a mesh four
/// hundred of the motion, which may be fast between two instants of the reference.
Path path_of(const AnalysedModel& model, const Watcher& watcher) {
  const Problem& problem = model.motion.problem;
  const ReferenceMotion& reference = model.reference;
  if (auto path = path_of_matrices(problem, model.motion.t_end)) return *std::move(path);
  if (!problem.body && !problem.stiff && problem.y0.size() <= small) try {
      return motion_path(problem, model.motion.t_end, 400, watcher);
    } catch (const InputError&) {  // what the explicit method of the path does not follow
    }
  return thinned({.at = reference.t, .y = reference.y}, affordable_states(problem));
}

/// The smaller of two limits of which either may be missing.
double lesser(double a, double b) { return std::isnan(a) || b < a ? b : a; }

/// How many times the square of the fastest frequency grows along the motion, from the limits of the central
/// difference, 2 / omega.
double stiffening_along(const TrajectoryLimit& along) {
  const double start = along.h_max.front();
  return along.least > 0 && std::isfinite(along.least) && std::isfinite(start)
             ? std::pow(start / along.least, 2)
             : 1;
}

bool is_truncated(const Candidate& candidate) { return candidate.linear_solve.iterations > 0; }
bool is_frozen(const Candidate& candidate) { return candidate.jacobian.every == JacobianUpdate::frozen; }

StepChoices choices_of(const Candidate& candidate) {
  return {.jacobian = candidate.jacobian, .linear = candidate.linear_solve};
}

/// The least limit of the maps of steps at all places; NaN where none has one.
/// @param at_start  that of the method itself there
CandidateLimit limit_by_steps(const Candidate& candidate, const CandidateLimit& at_start,
                              const AnalysedModel& model, const Watcher& watcher) {
  StepQuestion question{.options = std::nullopt, .watch = watcher};
  if (takes_step_options(candidate.method)) question.options = choices_of(candidate);
  CandidateLimit limit;
  const auto look = [&](const Linearised& place) {
    const Problem still = with_frozen_matrices(model.motion.problem, place.point.model.t);
    const Prediction here = predict_by_steps(candidate.method, still, place, question);
    if (here.h_max) limit.h_max = lesser(limit.h_max, *here.h_max);
    if (!here.h_max && limit.status.empty()) limit.status = here.note;
  };
  // A frozen Jacobian is that of the start: there the method steps as it is.
  if (is_frozen(candidate) && !is_truncated(candidate))
    limit = at_start;
  else
    look(model.near);
  std::ranges::for_each(model.elsewhere, look);
  if (!std::isnan(limit.h_max)) limit.status.clear();
  return limit;
}

/// The limit of the largest bodies where the Jacobian is that of the start, as of an undamped spring that
/// stiffens as much as the motion makes the fastest mode stiffen.
CandidateLimit limit_of_frozen_spring(const Candidate& candidate, const AnalysedModel& model) {
  const auto method = linearly_implicit_method(candidate.method.id);
  if (!method) return {};
  const double exit = frozen_spring_exit(*method, model.stiffened);
  return {.h_max = std::isinf(exit) ? infinity : model.fastest > 0 ? exit / model.fastest : unknown};
}

/// @param at_start, along  of the method as it is: at the start, and the least of all places
CandidateLimit limit_of(const Candidate& candidate, const CandidateLimit& at_start,
                        const CandidateLimit& along, const AnalysedModel& model, const Watcher& watcher) {
  const bool is_of_modes = !is_frozen(candidate) && !is_truncated(candidate) &&
                           !(candidate.method.needs_split && std::isnan(along.h_max));
  if (is_of_modes) return along;
  const Eigen::Index states = model.motion.problem.y0.size();
  if (states <= small) return limit_by_steps(candidate, at_start, model, watcher);
  if (states <= most_states_stepped) return {.pending = true};
  return is_frozen(candidate) && !is_truncated(candidate) ? limit_of_frozen_spring(candidate, model)
                                                          : CandidateLimit{};
}

/// Where the maps of steps are looked at besides the start: of a body where it is stiffest.
std::vector<Linearised> places_of(const AnalysedModel& model, const Path& path,
                                  const std::optional<TrajectoryLimit>& central) {
  const Problem& problem = model.motion.problem;
  std::vector<Linearised> places;
  if (problem.body) {
    const bool stiffens = central && central->least < central->h_max.front();
    if (stiffens && problem.y0.size() <= most_states_stepped)
      places.push_back(linearised(problem, central->t_least, central->y_least));
  } else if (problem.y0.size() <= small) {
    const Path few = thinned(path, 10);
    for (std::size_t i = 1; i < few.at.size(); ++i)
      places.push_back(linearised(problem, few.at[i], few.y[i]));
    if (central && central->y_least.size() > 0)
      places.push_back(linearised(problem, central->t_least, central->y_least));
  }
  return places;
}

/// The least limit of the method as it is: at the start, and along the motion.
CandidateLimit limit_of_modes(const Prediction& start, const std::optional<TrajectoryLimit>& along) {
  CandidateLimit limit{.h_max = lesser(start.h_max.value_or(unknown), along ? along->least : unknown)};
  if (std::isnan(limit.h_max)) limit.status = start.note;
  limit.of_start = start.h_max && !(along && !std::isnan(along->least));
  if (limit.of_start)
    limit.status = fmt::format("h_max is that of the start; along the motion no limit is known{}{}",
                               along && !along->note.empty() ? ": " : "", along ? along->note : "");
  return limit;
}

/// d ln h / d ln K of the limit at the start, with what else the stiffness of the material changes; NaN where
/// it is not known, or so small that something else than the stiffness sets the limit: no power of it tells
/// when that ends.
double stiffness_exponent(const Method& method, const AnalysedModel& model) {
  constexpr double least = 0.4;
  double exponent = unknown;
  if (model.stiffer) {
    const double here = predict(method, model.near).h_max.value_or(unknown),
                 there = predict(method, *model.stiffer).h_max.value_or(unknown);
    exponent = std::log(there / here) / std::log(1 + stiffness_spread);
  } else if (model.near.point.model.mechanical->damping == Damping::none) {
    exponent = -0.5;
  }
  return exponent <= -least ? exponent : unknown;
}

/// The factor of the stiffness at which the limit is a share of what it is. As far as it is cheap, the
/// exponent is that over the whole way: it changes where damping gives way to springs.
double stiffness_at(const Method& method, const AnalysedModel& model, double share) {
  constexpr int most = 20;
  constexpr double resolution = 1e-3;
  double factor = std::pow(share, 1 / stiffness_exponent(method, model));
  if (!model.with_stiffness || model.motion.problem.y0.size() > small) return factor;
  const double here = predict(method, model.near).h_max.value_or(unknown);
  for (int i = 0; i < most && std::abs(std::log(factor)) > resolution; ++i) {
    const auto there = model.with_stiffness(factor);
    const double reached = there ? predict(method, *there).h_max.value_or(unknown) / here : unknown;
    if (std::abs(std::log(reached / share)) < resolution) return factor;
    factor = std::pow(share, std::log(factor) / std::log(reached));
    if (!std::isfinite(factor)) return unknown;
  }
  return factor;
}

/// Whether the limit of modes takes a second for each state of a body.
bool is_costly(const Method& method, const Problem& problem) {
  return problem.body && method.stages_by_radius;
}

}  // namespace

void predict_limits(AnalysedModel& model, const std::vector<Candidate>& all, const Watcher& watcher,
                    const std::function<void(std::size_t)>& progress) {
  const Problem& problem = model.motion.problem;
  model.path = path_of(model, watcher);
  std::vector<Method> asked;
  for (const Candidate& candidate : all)
    if (!is_costly(candidate.method, problem)) asked.push_back(candidate.method);
  asked.push_back(find_method("central_difference"));
  const auto along = limits_along(asked, problem, model.path, watcher);
  if (problem.body && along.back()) model.stiffened = stiffening_along(*along.back());
  for (const MechanicalMode& mode : model.near.modes.spectrum.mechanical)
    model.fastest = std::max(model.fastest, std::sqrt(std::max(mode.kappa, 0.0)));
  model.elsewhere = places_of(model, model.path, along.back());
  std::size_t k = 0;  // of `asked`
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (progress) progress(i);
    if (is_costly(all[i].method, problem)) {
      model.limits.push_back({.pending = true});
      continue;
    }
    const Prediction start = predict(all[i].method, model.near);
    model.limits.push_back(limit_of(all[i], {start.h_max.value_or(unknown), start.note},
                                    limit_of_modes(start, along[k++]), model, watcher));
  }
}

CandidateLimit pending_limit(const Candidate& candidate, const AnalysedModel& model, const Watcher& watcher) {
  const Prediction start = predict(candidate.method, model.near);
  if (is_costly(candidate.method, model.motion.problem))
    return limit_of_modes(
        start, limits_along({&candidate.method, 1}, model.motion.problem, model.path, watcher).front());
  return limit_by_steps(candidate, {.h_max = start.h_max.value_or(unknown), .status = start.note}, model,
                        watcher);
}

double stiffening_margin(const Candidate& candidate, double h_max, const AnalysedModel& model, double h,
                         const Watcher& watcher) {
  if (!(h > 0) || is_truncated(candidate) || candidate.jacobian.every > 1 || candidate.method.needs_split)
    return unknown;
  if (!model.near.point.model.mechanical) return unknown;
  if (!is_frozen(candidate))
    return std::isfinite(h_max) ? stiffness_at(candidate.method, model, h / h_max) : h_max;
  const Problem& problem = model.motion.problem;
  if (problem.y0.size() <= most_states_stepped && takes_step_options(candidate.method)) {
    const auto tolerated = [&](const Linearised& place) {
      return tolerated_stiffening(candidate.method, problem, place, choices_of(candidate), h, watcher);
    };
    if (model.elsewhere.empty()) return tolerated(model.near);
    double least = unknown;
    for (const Linearised& place : model.elsewhere) least = lesser(least, tolerated(place));
    return least;
  }
  const auto method = linearly_implicit_method(candidate.method.id);
  if (!method || !(model.fastest > 0)) return unknown;
  return tolerated_stiffness(*method, h * model.fastest).most / model.stiffened;
}

}  // namespace hmax
