#include "limits/verification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "analysis/amplification/amplification.hpp"
#include "analysis/dynamics/coupled_motion.hpp"
#include "analysis/dynamics/growth.hpp"
#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "catalogue/models/free_parts.hpp"
#include "catalogue/models/planar.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "core/process/memory_share.hpp"
#include "core/size_limits.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/modes/mode_start.hpp"
#include "limits/problem_linearity.hpp"

namespace hmax {

namespace {

RunRecord take_steps(const Runner& runner, RunSpec spec, double h, std::int64_t steps, const Sink& sink) {
  spec.t_end = h * static_cast<double>(steps);
  spec.h = h;
  spec.max_steps = steps + 2;
  return runner.run(spec, sink);
}

}  // namespace

ShowSteps steps_of(const Method& method, const Problem& problem, const Eigen::VectorXd& rest,
                   const Eigen::VectorXd& displacement, const std::shared_ptr<Outcome>& outcome,
                   const RunSpec& spec) {
  const auto from = [&](const Eigen::VectorXd& start) {
    Problem started = problem;
    started.y0 = start;
    return method.bind(started);
  };
  const bool driven = is_driven(problem);
  const Runner displaced = from(rest + displacement), undisturbed = from(rest);
  return [=](double h, std::int64_t steps, const auto& show) {
    const auto wanted = static_cast<std::size_t>(steps + 1) * static_cast<std::size_t>(rest.size());
    std::vector<double> path;
    if (driven) {
      path.reserve(wanted);
      take_steps(undisturbed, spec, h, steps, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
        path.insert(path.end(), y.begin(), y.end());
      });
      if (path.size() < wanted) {
        *outcome = Outcome::diverged;
        return false;
      }
    }
    std::size_t at = 0;
    Eigen::VectorXd free(rest.size());
    const RunRecord record =
        take_steps(displaced, spec, h, steps, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
          if (!driven) return show(y);
          if (at + static_cast<std::size_t>(y.size()) > path.size()) return;
          free = y - Eigen::Map<const Eigen::VectorXd>(path.data() + at, y.size()) + rest;
          at += static_cast<std::size_t>(y.size());
          show(free);
        });
    *outcome = record.outcome;
    return record.outcome == Outcome::reached_end;
  };
}

namespace {

/// What the method makes of mode `i` of the row: an oscillation as a whole where it steps positions and
/// velocities.
Growth growth_of(const Method& method, const Prediction& row, const Linearised& near, std::size_t i) {
  return method.amplification->of_oscillation
             ? method.amplification->of_oscillation(near.modes.curve
                                                        ? oscillation_of(near, row.modes.at(i).mode.lambda)
                                                        : near.modes.spectrum.mechanical.at(i))
             : method.amplification->of_eigenmode(row.modes.at(i).told);
}

/// The largest |root| that dies away.
double fading(const std::vector<Complex>& roots) {
  double slowest = 0;
  for (const Complex root : roots)
    if (const double size = std::abs(root); size < 1 - 1e-4) slowest = std::max(slowest, size);
  return slowest;
}

/// The logarithm of the largest factor below one by which a step of size h multiplies part of the motion.
/// @param only  a mode beside which nothing else is to be seen
double decay_beside(const Method& method, const Prediction& row, const Linearised& near, double h,
                    std::optional<std::size_t> only) {
  double slowest = 0;
  for (std::size_t i = only.value_or(0); i < (only ? *only + 1 : row.modes.size()); ++i) {
    const Growth growth = growth_of(method, row, near, i);
    if (growth.polynomial) slowest = std::max(slowest, fading(growth.polynomial->roots(h)));
    // The roots of a foreign method that looks back are not known: a weakly damped mode may outlast the
    // start.
    else if (method.amplification->measured && method.steps_back > 0)
      slowest = std::max(slowest, 0.995);
  }
  return std::log(slowest);
}

/// The root by which the motion of a mode goes on, nearest to exp(lambda h); others only methods of several
/// steps have.
std::vector<Complex>::const_iterator principal_root(const std::vector<Complex>& roots, Complex lambda,
                                                    double h) {
  return std::ranges::min_element(roots, {},
                                  [&](Complex root) { return std::abs(root - std::exp(lambda * h)); });
}

/// The logarithm of what a run from a mode shows of its growth at h. The run begins in the principal root;
/// another one begins as small as rounding and has to grow by so much more.
double visible_growth(const Method& method, const Growth& growth, Complex lambda, double h) {
  const double whole = std::log(growth.spectral_radius(h));
  if (!growth.polynomial || method.amplification->of_oscillation) return whole;
  const std::vector<Complex> roots = growth.polynomial->roots(h);
  const auto near = principal_root(roots, lambda, h);
  // Where that root decays, what is left is soon the other one.
  if (std::abs(*near) < 1 - 1e-4 || std::log(std::abs(*near)) > whole / 2) return whole;
  constexpr double from_rounding = 150;  // 2 ln 1e16, beside what is visible
  return whole / from_rounding;
}

/// The longest run: so many numbers are stepped at most, seconds of a body.
std::int64_t most_steps(const Linearised& near) {
  constexpr double most_numbers = 5e7, fewest = 8192;
  const auto states = static_cast<double>(near.point.model.y.size());
  return static_cast<std::int64_t>(
      std::clamp(most_numbers / states, fewest, static_cast<double>(most_observed_steps)));
}

/// How runs beside a limit are watched, and what they are expected to show.
struct Watch {
  ExpectedGrowth expected;
  ShowSteps run;
  Distance distance;
};

/// The eigenvalue with which an overdamped oscillation creeps back, beside a fast one; nothing for others.
std::optional<double> creeping(const MechanicalMode& mode) {
  const auto pair = eigenvalues_of(mode);
  if (pair[0].imag() != 0 || pair[0] == pair[1]) return std::nullopt;
  return std::max(pair[0].real(), pair[1].real());
}

/// Where fast damping sets the limit of an oscillation, what creeps fades so slowly that it would be waited
/// for the longest, and hides a growth that begins small: it is taken out, twice, since other modes creep
/// with roots nearby, of which the square of the distance is left.
void take_out_creep(Watch& watch, const Eigen::VectorXd& rest, const StepPolynomial& polynomial,
                    const MechanicalMode& mode, double h_max) {
  const std::optional<double> lambda = creeping(mode);
  if (!lambda) return;
  const auto root_of_creep = [polynomial, lambda = *lambda](double h) {
    const std::vector<Complex> roots = polynomial.roots(h);
    return *principal_root(roots, lambda, h);
  };
  const Complex creep = root_of_creep(h_max);
  // Not where it is what grows, and not where it dies away by itself.
  constexpr double soon = 0.9;
  if (creep.real() < soon || std::abs(creep.imag()) > 1e-9) return;
  std::vector<Complex> others = polynomial.roots(h_max);
  others.erase(std::ranges::find(others, creep));
  watch.expected.beside = std::log(fading(others));
  watch.run = without_roots(watch.run, rest, [root_of_creep](double h) {
    return std::vector<Complex>(2, root_of_creep(h).real());
  });
}

/// Runs from the limiting mode of a row, watched by their distance from rest.
Watch watch_all(const Method& method, const Prediction& row, const Linearised& near, const ModeStart& start,
                const ShowSteps& run, std::size_t i) {
  const Growth growth = growth_of(method, row, near, i);
  const Complex lambda = row.limiting->lambda;
  const double above = visible_growth(method, growth, lambda, 1.001 * *row.h_max),
               close =
                   visible_growth(method, growth, lambda, (1 + 1e-3 * ExpectedGrowth{}.share) * *row.h_max);
  Watch watch{.expected = {.above = std::max(above, 1e-12),
                           .close = std::max(close, 0.0),
                           .beside = decay_beside(method, row, near, *row.h_max,
                                                  start.mode_alone ? std::optional(i) : std::nullopt),
                           .linear = start.defective,
                           .fall = start.mode_alone ? 10.0 : 37.0,
                           .most = most_steps(near)},
              .run = run,
              .distance = start.distance};
  // A mode starts in the only root of a one-step method, and the displacement of an oscillation in both roots
  // of a step that knows no more than it and its velocity: the one that grows is there from the start.
  const bool of_oscillation = method.amplification->of_oscillation != nullptr;
  if (growth.polynomial && (!of_oscillation || lambda.imag() != 0) &&
      growth.polynomial->roots(*row.h_max).size() == (of_oscillation ? 2U : 1U))
    watch.expected.fall = 5;
  // Beats of an oscillation at 0.999 of its limit last a hundred steps.
  if (start.large) {
    watch.expected.least = 256;
    watch.expected.resolution = 2e-4;
  }
  const bool single = near.point.model.y.size() == 2;
  if ((start.mode_alone || single) && growth.polynomial && method.amplification->of_oscillation)
    take_out_creep(watch, start.rest, *growth.polynomial, oscillation_of(near, row.limiting->lambda),
                   *row.h_max);
  return watch;
}

/// Whether runs on both sides of a limit grow and decay like powers of the largest root, as closely as tells
/// one side from the other: neither rounding nor another motion has a visible part in them.
bool is_power(const Watch& watch, const Growth& growth, double h_max) {
  const std::int64_t steps = steps_to_see(watch.expected), half = steps / 2;
  return std::ranges::all_of(std::array{0.999 * h_max, 1.001 * h_max}, [&](double h) {
    const double of_root = std::log(growth.spectral_radius(h)) * static_cast<double>(half);
    return std::abs(observed_growth(watch.run, watch.distance, h, steps) - of_root) <=
           0.25 * watch.expected.visible;
  });
}

/// The same watched by the amplitude of the mode alone, of which methods of first order make powers of one
/// root after a while: the least growth shows. Where that is not the principal one, the latter is taken out:
/// what is left has begun as small as the error of the first steps. Nothing where roots do not tell.
std::optional<Watch> watch_mode(const Method& method, const Prediction& row, const Linearised& near,
                                const ModeStart& start, const ShowSteps& run, std::size_t i) {
  const bool of_oscillation = method.amplification->of_oscillation != nullptr;
  if (of_oscillation ? !start.motion : !start.amplitude) return std::nullopt;
  const Growth growth = growth_of(method, row, near, i);
  Watch watch = watch_all(method, row, near, start, run, i);
  if (of_oscillation) {
    const MotionOf motion = start.motion(*row.h_max);
    watch.distance = [motion](const Eigen::Ref<const Eigen::VectorXd>& y) {
      const Eigen::Vector2d z = motion(y);
      return std::hypot(z[0], z[1]);
    };
    return watch;
  }
  watch.distance = start.amplitude;
  watch.expected.visible = 1e-5;
  watch.expected.fall = 20;
  // What a step multiplies by one number shows its growth within a few steps.
  if (start.large) {
    watch.expected.least = 4;
    watch.expected.resolution = 1e-5;
  }
  if (!growth.polynomial) return watch;
  const double h = 1.001 * *row.h_max;
  const Complex lambda = row.limiting->lambda;
  const std::vector<Complex> roots = growth.polynomial->roots(h);
  const auto principal = principal_root(roots, lambda, h);
  const auto growing = std::ranges::max_element(roots, {}, [](Complex r) { return std::abs(r); });
  double beside = 0;
  for (auto root = roots.begin(); root != roots.end(); ++root)
    if (root != principal && root != growing) beside = std::max(beside, std::abs(*root));
  if (beside > 1 - 1e-4) return std::nullopt;
  watch.expected.above = std::max(std::log(std::abs(*growing)), 1e-12);
  watch.expected.close = 0;
  if (principal == growing) return watch;
  watch.expected.beside = std::log(beside);
  watch.run = without_roots(run, start.rest, [=, polynomial = *growth.polynomial](double step) {
    const std::vector<Complex> all = polynomial.roots(step);
    const Complex root = *principal_root(all, lambda, step);
    return std::vector<Complex>{root, std::conj(root)};
  });
  watch.expected.visible = ExpectedGrowth{}.visible;
  if (is_power(watch, growth, *row.h_max)) return watch;
  // Rounding keeps such a root in motion, by now more, by now less.
  watch.expected.visible = std::log(10.0);
  watch.expected.share = 0.5;
  watch.expected.resolution = 1e-4;
  return watch;
}

/// The limit of a large structure by the recurrence that the mode obeys from step to step: runs of a dozen
/// steps. Nothing where it is not seen to obey one on both sides.
std::optional<ObservedLimit> observe_recurrence(const Method& method, const Prediction& row,
                                                const ModeStart& start, const ShowSteps& run) {
  if (!method.amplification->motion || !start.motion || !start.large) return std::nullopt;
  const std::size_t degree = method.amplification->motion->degree();
  const double h_max = *row.h_max;
  const MotionOf motion = start.motion(h_max);
  const auto steps = static_cast<std::int64_t>(6 * degree);
  std::map<double, double> known;
  bool lost = false;  // at a step that obeys no recurrence
  const auto per_step = [&](double h) {
    const auto [at, is_new] = known.try_emplace(h);
    if (is_new) {
      const std::optional<double> growth =
          growth_of_recurrence(run, motion, degree, h, steps, start.disturbance);
      lost = lost || !growth;
      at->second = growth.value_or(0);
    }
    return at->second;
  };
  per_step(0.999 * h_max);
  per_step(1.001 * h_max);
  if (lost) return std::nullopt;
  const ExpectedGrowth expected{.above = 1,
                                .beside = -infinity,
                                .visible = 1e-5,
                                .resolution = 2e-4,
                                .least = static_cast<double>(steps)};
  const GrowthAt growth = [&](double h, std::int64_t n) {
    const std::int64_t half = n / 2;
    return per_step(h) * static_cast<double>(half);
  };
  ObservedLimit limit = observe_limit(growth, h_max, expected);
  limit.steps = steps;
  if (lost) return std::nullopt;
  return limit;
}

/// The same where the steps couple all modes, from the shape that begins to grow.
Watch watch_coupled(const Prediction& row, const Linearised& near, const ModeStart& start,
                    const ShowSteps& run) {
  const StepPolynomial& shape = *row.coupled->of_shape;
  const double close = (1 + 1e-3 * ExpectedGrowth{}.share) * *row.h_max;
  Watch watch{.expected = {.above = std::max(std::log(shape.spectral_radius(1.001 * *row.h_max)), 1e-12),
                           .close = std::max(std::log(shape.spectral_radius(close)), 0.0),
                           .beside = std::log(fading(shape.roots(*row.h_max))),
                           .most = most_steps(near)},
              .run = run,
              .distance = start.distance};
  take_out_creep(watch, start.rest, shape, row.coupled->shape, *row.h_max);
  return watch;
}

/// Whether something beside the limiting mode grows below the limit of that mode.
bool others_grow(const Prediction& row, const ModeStart& start, const ShowSteps& run,
                 const ObservedLimit& of_mode) {
  const double h = 0.999 * std::min(*row.h_max, of_mode.h);
  if (!start.large || !start.beside)
    return observed_growth(run, start.distance, h, of_mode.steps) > ExpectedGrowth{}.visible;
  // Of a large structure as few steps as show a mode that is one percent faster, where positions and
  // velocities are stepped, else ten. Beats of those nearest to the limit last longer, together they do not
  // double the distance.
  constexpr std::int64_t few = 24;
  return observed_growth(run, start.beside, h, few) > std::log(2.0);
}

/// Limits are seen soonest in the amplitude of the mode that sets them, as long as no other grows below.
ObservedLimit observe(const Method& method, const Prediction& row, const Linearised& near,
                      const ModeStart& start, const ShowSteps& run) {
  if (row.coupled) {
    const auto of_shape = observe_recurrence(method, row, start, run);
    if (of_shape && !others_grow(row, start, run, *of_shape)) return *of_shape;
    const Watch coupled = watch_coupled(row, near, start, run);
    return observe_limit(coupled.run, coupled.distance, *row.h_max, coupled.expected);
  }
  const auto at = std::ranges::min_element(
      row.modes, {}, [&](const ModeMargin& m) { return std::abs(m.mode.lambda - row.limiting->lambda); });
  const auto i = static_cast<std::size_t>(at - row.modes.begin());
  std::optional<ObservedLimit> of_mode = observe_recurrence(method, row, start, run);
  if (!of_mode)
    if (const auto mode = watch_mode(method, row, near, start, run, i))
      of_mode = observe_limit(mode->run, mode->distance, *row.h_max, mode->expected);
  if (of_mode && !others_grow(row, start, run, *of_mode)) return *of_mode;
  const Watch all = watch_all(method, row, near, start, run, i);
  return observe_limit(all.run, all.distance, *row.h_max, all.expected);
}

}  // namespace

double small_displacement(const Problem& problem, const Linearised& near, const Eigen::VectorXd& direction,
                          double most) {
  // Of the size of the states of the problem, whatever their unit.
  const auto largest = [](const Eigen::VectorXd& y) { return y.size() == 0 ? 0 : y.cwiseAbs().maxCoeff(); };
  const double scale = std::max(largest(near.point.model.y), largest(problem.y0));
  double size = 1e-6 * (problem.body ? std::max(scale, 1.0) : scale > 0 ? scale : 1);
  const auto change = [&] {
    const Eigen::VectorXd y = near.point.model.y + size * direction;
    return relative_distance(near.point.model, linear_model(problem, near.point.model.t, y));
  };
  for (int tenth = 0; tenth < 3 && change() > most; ++tenth) size /= 10;
  return size;
}

namespace {

/// A driven linear oscillator moves about its forced motion as the free one moves about zero, and at steps
/// far beyond every time scale only the latter can be told from rounding.
void take_off_drive(Problem& problem, Eigen::VectorXd& rest) {
  const auto* oscillator = std::get_if<Oscillator>(&problem.system);
  if (oscillator == nullptr || !is_affine(linearity_of(problem))) return;
  OscillatorParameters parameters = oscillator->parameters();
  parameters.P = 0;
  problem.system = Oscillator(parameters);
  rest.setZero();
}

}  // namespace

std::vector<double> steps_without_limit(const Problem& problem, double farthest) {
  std::vector<double> steps;
  if (problem.body) steps = {1e-3, 1e-2, 1e-1};
  std::erase_if(steps, [&](double h) { return h >= farthest; });
  steps.push_back(farthest);
  return steps;
}

std::string why_not_verified(const Method& method, const Problem& problem, const Problem& free,
                             const Linearised& near) {
  const Eigen::Index states = near.point.model.y.size();
  if (is_driven(free) && states > most_driven_states)
    return fmt::format("not verified: a force moves the {} states of the model during the runs", states);
  if (problem.body && !near.point.at_equilibrium)
    return near.point.status.empty()
               ? "not verified: the load moves the body away from rest; leave out --at rest, or set g=0"
               : "not verified: no equilibrium was found, so that the body moves away from this state; supports and "
                 "a load that leave it one, or --set g=0, can be verified";
  if (is_too_slow(method, states))
    return fmt::format("not verified: {} factors a dense matrix of {} rows in every step", method.engine,
                       states);
  return {};
}

namespace {

/// The slowest and the fastest of the modes of a row, by |lambda| [1/s], without those that are zero but for
/// rounding.
struct Rates {
  double slowest = infinity, fastest = 0;
};
Rates rates_of(const Prediction& row, bool has_free_motions) {
  Rates rates;
  for (const ModeMargin& margin : row.modes)
    rates.fastest = std::max(rates.fastest, std::abs(margin.mode.lambda));
  const double least = has_free_motions ? 1e-7 * rates.fastest : 0;
  for (const ModeMargin& margin : row.modes)
    if (const double rate = std::abs(margin.mode.lambda); rate > least)
      rates.slowest = std::min(rates.slowest, rate);
  return rates;
}

/// Takes out of a displacement from rest, and of its velocity, the rigid motions that supports leave: these
/// go on in proportion to time, which is no instability.
void take_out_free_motions(const Eigen::MatrixXd& motions, const MassMatrix<double>& mass,
                           Eigen::VectorXd& y) {
  const auto without = [&](auto part) {
    part -= motions * (motions.transpose() * mass.times(Eigen::VectorXd(part)));
  };
  without(y.head(mass.size()));
  without(y.tail(mass.size()));
}

/// The motions that matrices of a user leave without stiffness, as many as a body in space has, with columns
/// orthonormal in M; of large ones none, as they take a factor.
Eigen::MatrixXd free_motions_of_matrices(const Linearised& near) {
  const auto& part = near.point.model.mechanical;
  if (near.point.kind != StateKind::matrices || !part || !part->symmetric ||
      part->mass.size() > most_dense_modes)
    return {};
  constexpr Eigen::Index most = 6;
  const double rigid = std::max(rigid_share, rounding_of_stiffness(near.point.model));
  const ExtremeStiffnesses all = smallest_stiffnesses(*part, std::min(part->mass.size(), most));
  double largest = 0;
  for (const Complex lambda : near.modes.spectrum.lambda) largest = std::max(largest, std::norm(lambda));
  Eigen::MatrixXd motions(part->mass.size(), 0);
  for (std::size_t i = 0; i < all.kappa.size(); ++i) {
    if (std::abs(all.kappa[i]) > rigid * largest) continue;
    motions.conservativeResize(Eigen::NoChange, motions.cols() + 1);
    motions.rightCols(1) = all.shapes.col(static_cast<Eigen::Index>(i));
  }
  return motions;
}

/// About what the runs of a verification take [bytes]: states, the factors of an implicit method, and where a
/// force drives the problem its motion, state by state.
double memory_of(const Method& method, const Problem& problem) {
  const auto states = static_cast<double>(problem.y0.size());
  // Some hundred vectors, the histories of multistep methods among them.
  double bytes = 100 * sizeof(double) * states;
  if (is_driven(problem)) bytes += sizeof(double) * states * static_cast<double>(most_observed_steps);
  if (method.needs_jacobian) bytes += bytes_of_factor(problem.body ? states / 2 : states);
  return bytes;
}

/// What runs have shown, and the words for it where they do not agree with the prediction.
struct Finding {
  Observation seen;
  std::string contradiction{}, excuse{};
};

/// The steps at which a method that is unstable at no step is run: those that users take, and far beyond.
FarSteps far_steps(const Problem& problem, const ModeStart& start, const Rates& rates) {
  // Longer steps of large matrices take a factor: minutes.
  if (!problem.body && start.large) return short_far_steps(rates.fastest);
  // Of a large structure: where a step carries what velocities there are too far, it is not linear.
  const double farthest = (start.mode_alone ? 1e3 : 1e6) / rates.slowest;
  return {.h = steps_without_limit(problem, farthest), .most = start.mode_alone ? 512 : 4096};
}

/// Runs of a method that is unstable at no step.
Finding watch_without_limit(Prediction& row, const ModeStart& start, const ShowSteps& run,
                            const Outcome& outcome, const FarSteps& far) {
  Finding finding;
  Observation& seen = finding.seen;
  const double farthest = far.h.back();
  if (!far.note.empty()) row.note = far.note;
  seen.agrees = true;
  for (const double h : far.h) {
    seen.steps = h < farthest ? 100 : far.most;
    seen.agrees = !grows_at(run, start.distance, h, seen.steps);
    if (seen.agrees) continue;
    if (outcome == Outcome::newton_failed) {
      row.bound = Bound::newton;
      finding.excuse = fmt::format(
          "no step is unstable, but Newton's method does not solve the equations of a step of {} s{}: it limits "
          "the step",
          to_text(h), h < farthest ? "" : ", far beyond the slowest time scale");
    }
    finding.contradiction = fmt::format(
        "no step is unstable by the analysis, but runs of {} steps of {} s grow", seen.steps, to_text(h));
    break;
  }
  seen.h_max = seen.agrees ? infinity : std::numeric_limits<double>::quiet_NaN();
  seen.gap = std::numeric_limits<double>::quiet_NaN();
  return finding;
}

/// Runs on both sides of a limit.
Finding watch_limit(const Prediction& row, const Method& method, const Linearised& near,
                    const ModeStart& start, const ShowSteps& run) {
  const ObservedLimit limit = observe(method, row, near, start, run);
  return {.seen = {.h_max = limit.h,
                   .gap = limit.h / *row.h_max - 1,
                   .steps = limit.steps,
                   .agrees = limit.below_decays && limit.above_grows},
          .contradiction =
              limit.below_decays
                  ? fmt::format("integration does not show this limit: {} steps of 1.001 of it do not grow",
                                limit.steps)
                  : fmt::format("integration does not show this limit: {} steps of 0.999 of it grow",
                                limit.steps)};
}

/// What runs from `start` show of a row.
Finding watch_runs(Prediction& row, const Method& method, const Linearised& near, const ModeStart& start,
                   const ShowSteps& run, const Outcome& outcome, const FarSteps& far) {
  Finding finding = row.bound == Bound::stability ? watch_limit(row, method, near, start, run)
                                                  : watch_without_limit(row, start, run, outcome, far);
  if (!finding.seen.agrees && finding.seen.steps >= most_steps(near))
    finding.excuse =
        fmt::format("growth beyond this limit is too slow to be seen in {} steps", finding.seen.steps);
  return finding;
}

/// Puts into the row what was seen and why it does not agree.
void conclude(Prediction& row, const Method& method, Finding finding) {
  Observation& seen = finding.seen;
  seen.excused = !seen.agrees && !finding.excuse.empty();
  const std::string of_model = row.growing ? row.note + "; " : "";
  if (!seen.agrees) row.note = of_model + (seen.excused ? finding.excuse : finding.contradiction);
  seen.step_defect = step_defect(method);
  if (!seen.has_steps_of_analysis())
    row.note += fmt::format("{}its steps are not those of its analysis, they differ by {}",
                            row.note.empty() ? "" : "; ", to_text(seen.step_defect));
  row.observed = seen;
}

/// The same run, watched at every step.
ShowSteps watched(ShowSteps run, const std::function<void()>& watch) {
  if (!watch) return run;
  return [run = std::move(run), watch](double h, std::int64_t steps, const auto& show) {
    return run(h, steps, [&](const Eigen::Ref<const Eigen::VectorXd>& y) {
      watch();
      show(y);
    });
  };
}

}  // namespace

FarSteps short_far_steps(double fastest) {
  const double h = 10 / fastest;
  return {.h = {h},
          .most = 12,
          .note = fmt::format(
              "verified at a step of {:.3g} s alone: longer ones of so many unknowns take minutes", h)};
}

bool driven_away(const Linearised& near, const Problem& free) {
  return near.point.linearity != Linearity::linear && is_driven(free);
}

bool grows_in_runs(const Prediction& row) {
  if (!row.growing || !row.h_max) return false;
  // Half a run of the usual length lies between the quarters that are compared.
  const double growth = row.growing->lambda.real() * *row.h_max * ExpectedGrowth{}.least / 2;
  return !(growth <= ExpectedGrowth{}.visible / 4);
}

bool has_claim(const Prediction& row, const Method& method) {
  if (grows_in_runs(row)) return false;
  const bool of_steps =
      row.bound == Bound::stability || row.bound == Bound::accuracy || row.bound == Bound::newton;
  return method.fixed_step && !row.unstable_from && of_steps;
}

void verify_from(const ModeStart& start, const ShowSteps& run, Prediction& row, const Method& method,
                 const Linearised& near, const FarSteps& far) {
  conclude(row, method, watch_runs(row, method, near, start, run, Outcome::reached_end, far));
}

void verify_parts(Prediction& row, const Method& method,
                  const std::function<void(Prediction& of_part)>& verify_part) {
  Prediction of_part = row;
  of_part.method = method.part->id;
  scale_steps(of_part, 1 / method.parts);
  verify_part(of_part);
  scale_steps(of_part, method.parts);
  row.bound = of_part.bound;
  row.note = of_part.note;
  row.observed = of_part.observed;
}

void verify(Prediction& row, const Method& method, const Problem& problem, const Linearised& near,
            const std::function<void()>& watch) {
  if (method.part)
    return verify_parts(row, method,
                        [&](Prediction& of_part) { verify(of_part, *method.part, problem, near, watch); });
  if (grows_in_runs(row)) row.note += "; not verified: runs would show the growth of the model itself";
  if (!has_claim(row, method)) return;
  const Eigen::MatrixXd free_rigid =
      problem.body ? free_motions(*problem.body) : free_motions_of_matrices(near);
  const Rates rates = rates_of(row, free_rigid.cols() > 0);
  if (rates.fastest == 0) return;  // nothing moves
  Problem free = after_ramps(problem);
  if (std::string why = why_not_verified(method, problem, free, near); !why.empty()) {
    row.note = std::move(why);
    return;
  }
  const MemoryShare memory(memory_of(method, free));
  // The limiting mode, or the slowest.
  const Complex wanted = row.limiting ? row.limiting->lambda : row.modes.front().mode.lambda;
  Eigen::VectorXd rest = near.point.model.y;
  take_off_drive(free, rest);
  ModeStart start =
      row.coupled && row.bound == Bound::stability
          ? start_from_shape(*near.point.model.mechanical, rest, row.coupled->displacement, *row.h_max)
          : start_from_mode(near, rest, wanted, rates.fastest);
  if (free_rigid.cols() > 0)
    take_out_free_motions(free_rigid, near.point.model.mechanical->mass, start.displacement);
  // Where a mode is watched alone little is seen that is not its own.
  const double most_change = start.mode_alone ? 1e-7 : 1e-4;
  // Near zero, where no offset hides a displacement of one.
  const bool linear = is_affine(near.point.linearity) && !problem.body && rest.isZero(0);
  const double size = linear ? 1 : small_displacement(problem, near, start.displacement, most_change);
  const auto outcome = std::make_shared<Outcome>(Outcome::reached_end);
  const ShowSteps run = watched(steps_of(method, free, rest, size * start.displacement, outcome), watch);
  Finding finding = watch_runs(row, method, near, start, run, *outcome, far_steps(problem, start, rates));
  if (!finding.seen.agrees && driven_away(near, free)) {
    finding.excuse = driven_away_words;
    // Limits of different states are no prediction and observation of one.
    finding.seen.gap = std::numeric_limits<double>::quiet_NaN();
  }
  if (!finding.seen.agrees && row.bound != Bound::stability && free_rigid.cols() > 0 &&
      rounding_of_stiffness(near.point.model) > 0)
    finding.excuse =
        "the few digits of the stiffness let its rigid-body modes grow in steps that are that long";
  conclude(row, method, std::move(finding));
}

}  // namespace hmax
