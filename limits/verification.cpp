#include "limits/verification.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/amplification/amplification.hpp"
#include "analysis/dynamics/growth.hpp"
#include "analysis/spectrum/extreme_eigenvalues.hpp"
#include "catalogue/models/free_parts.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "core/process/memory_share.hpp"
#include "core/size_limits.hpp"
#include "core/text/sentences.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/modes/limit_in_runs.hpp"
#include "limits/modes/mode_start.hpp"

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

/// A driven linear oscillator moves about its forced motion as the free one moves about zero, and at steps
/// far beyond every time scale only the latter can be told from rounding.
void take_off_drive(Problem& problem, Eigen::VectorXd& rest) {
  if (problem.kind() != ModelKind::oscillator || !is_affine(linearity_of(problem))) return;
  OscillatorParameters parameters = std::get<Oscillator>(problem.system).parameters();
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

std::string why_not_verified(const Method& method, const Problem& free, const Linearised& near) {
  const Eigen::Index states = near.point.model.y.size();
  if (is_driven(free) && states > most_driven_states)
    return fmt::format("not verified: a force moves the {} states of the model during the runs", states);
  if (near.point.is_body && !near.point.at_equilibrium)
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
  bool conserve = false;  ///< some are zero
};
Rates rates_of(const Prediction& row, bool has_free_motions) {
  Rates rates;
  for (const ModeMargin& margin : row.modes)
    rates.fastest = std::max(rates.fastest, std::abs(margin.mode.lambda));
  const double least = has_free_motions ? 1e-7 * rates.fastest : noise_of(row.modes.size(), rates.fastest);
  for (const ModeMargin& margin : row.modes)
    if (const double rate = std::abs(margin.mode.lambda); rate > least)
      rates.slowest = std::min(rates.slowest, rate);
    else
      rates.conserve = true;
  return rates;
}

/// Whether the model itself grows so fast that runs show this in place of a limit.
bool grows_in_runs(const Prediction& row, const Method& method) {
  if (!row.growing || !row.h_max) return false;
  // Half a run of the usual length lies between the quarters that are compared.
  const double growth = row.growing->lambda.real() * (*row.h_max / method.parts) * ExpectedGrowth{}.least / 2;
  return !(growth <= ExpectedGrowth{}.visible / 4);
}

/// Takes out of a displacement from rest, and of its velocity, the rigid motions that supports leave: these
/// go on in proportion to time, which is no instability.
void take_out_free_motions(const Eigen::MatrixXd& motions, const MassMatrix<double>& mass,
                           Eigen::VectorXd& y) {
  for (Eigen::Index at : {Eigen::Index(0), mass.size()}) {
    auto part = y.segment(at, mass.size());
    part -= motions * (motions.transpose() * mass.times(Eigen::VectorXd(part)));
  }
}

/// From the mode that limits the row, or the slowest.
/// @param free_rigid  motions that supports leave
ModeStart start_of(const Prediction& row, const Method& method, const Linearised& near,
                   const Eigen::VectorXd& rest, const Rates& rates, const Eigen::MatrixXd& free_rigid) {
  const auto& part = near.point.model.mechanical;
  const Complex slowest = row.modes.front().mode.lambda;
  ModeStart start =
      row.coupled && row.bound == Bound::stability
          ? start_from_shape(*part, rest, row.coupled->displacement, *row.h_max / method.parts)
          : start_from_mode(near, rest, row.limiting ? row.limiting->lambda : slowest, rates.fastest);
  if (free_rigid.cols() > 0) take_out_free_motions(free_rigid, part->mass, start.displacement);
  return start;
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

/// The steps at which a method that is unstable at no step is run: those that users take, and far beyond.
FarSteps far_steps(const Problem& problem, const ModeStart& start, const Rates& rates) {
  // Longer steps of large matrices take a factor: minutes.
  if (!problem.body && start.large) return short_far_steps(rates.fastest);
  // Of a large structure: where a step carries what velocities there are too far, it is not linear. What a
  // model conserves rounding moves in proportion to h |lambda|.
  const double farthest = (start.mode_alone || rates.conserve ? 1e3 : 1e6) / rates.slowest;
  return {.h = steps_without_limit(problem, farthest), .most = start.mode_alone ? 512 : 4096};
}

/// Runs of a method that is unstable at no step.
/// @param nonlinear  whether steps solve nonlinear equations
/// @param outcome    of the last run
Finding watch_without_limit(bool nonlinear, const ModeStart& start, const ShowSteps& run,
                            const Outcome& outcome, const FarSteps& far) {
  Finding finding{.note = far.note};
  Observation& seen = finding.seen;
  const double farthest = far.h.back();
  seen.agrees = true;
  for (const double h : far.h) {
    seen.steps = h < farthest ? 100 : far.most;
    seen.agrees = !grows_at(run, start.distance, h, seen.steps);
    if (seen.agrees) continue;
    seen.excused = outcome == Outcome::newton_failed;
    finding.unsolved = seen.excused && nonlinear;
    finding.why = seen.excused
                      ? fmt::format("no step is unstable, but {} the equations of a step of {} s{}{}",
                                    nonlinear ? "Newton's method does not solve" : "rounding leaves unsolved",
                                    to_text(h), h < farthest ? "" : ", far beyond the slowest time scale",
                                    nonlinear ? ": it limits the step" : "")
                      : fmt::format("no step is unstable by the analysis, but runs of {} steps of {} s grow",
                                    seen.steps, to_text(h));
    break;
  }
  seen.h_max = seen.agrees ? infinity : std::numeric_limits<double>::quiet_NaN();
  seen.gap = std::numeric_limits<double>::quiet_NaN();
  return finding;
}

/// Runs on both sides of a limit.
Finding watch_limit(const Prediction& row, const Method& method, const Linearised& near,
                    const ModeStart& start, const ShowSteps& run) {
  const ObservedLimit limit = observe_limit(row, method, near, start, run);
  Finding finding{.seen = {.h_max = limit.h * method.parts,
                           .gap = limit.h / (*row.h_max / method.parts) - 1,
                           .steps = limit.steps,
                           .agrees = limit.below_decays && limit.above_grows}};
  if (finding.seen.agrees) return finding;
  finding.why = fmt::format("integration does not show this limit: {} steps of {} of it {}", limit.steps,
                            limit.below_decays ? 1.001 : 0.999, limit.below_decays ? "do not grow" : "grow");
  if (limit.steps >= most_steps(near))
    finding.excuse(fmt::format("growth beyond this limit is too slow to be seen in {} steps", limit.steps));
  return finding;
}

/// What runs from `start` show of a row.
Finding watch_runs(const Prediction& row, const Method& method, const Linearised& near,
                   const ModeStart& start, const ShowSteps& run, const Outcome& outcome,
                   const FarSteps& far) {
  const bool nonlinear = method.solves_nonlinear_equations() && !is_affine(near.point.linearity);
  return row.bound == Bound::stability ? watch_limit(row, method, near, start, run)
                                       : watch_without_limit(nonlinear, start, run, outcome, far);
}

/// Puts into the row what was seen, and why it does not agree.
void conclude(Prediction& row, const Method& method, const Finding& finding) {
  Observation& seen = row.observed.emplace(finding.seen);
  seen.step_defect = step_defect(method.analysed());
  if (finding.unsolved) row.bound = Bound::newton;
  add_sentence(row.note, finding.note);
  if (!seen.agrees) add_sentence(row.note, finding.why);
  if (!seen.has_steps_of_analysis())
    row.note = joined(row.note, fmt::format("its steps are not those of its analysis, they differ by {}",
                                            to_text(seen.step_defect)));
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

void Finding::excuse(std::string reason) {
  if (seen.agrees) return;
  seen.excused = true;
  why = std::move(reason);
}

void Finding::excuse_states(std::string reason) {
  excuse(std::move(reason));
  // Limits of different states are no prediction and observation of one.
  if (!seen.agrees) seen.gap = std::numeric_limits<double>::quiet_NaN();
}

void Finding::excuse_drive() {
  excuse_states(
      "the force moves the model away from this state, so that the runs show the limit of other states; the safe step "
      "along the motion says more");
}

FarSteps short_far_steps(double fastest) {
  const double h = 10 / fastest;
  return {.h = {h},
          .most = 12,
          .note = fmt::format(
              "verified at a step of {:.3g} s alone: longer ones of so many unknowns take minutes", h)};
}

double memory_of_runs(const Method& method, const Problem& problem) {
  const auto states = static_cast<double>(problem.y0.size());
  // Some hundred vectors, the histories of multistep methods among them.
  double bytes = 100 * sizeof(double) * states;
  if (is_driven(problem)) bytes += sizeof(double) * states * static_cast<double>(most_observed_steps);
  if (method.needs_jacobian) bytes += bytes_of_factor(static_cast<double>(unknowns_of(problem)));
  return bytes;
}

bool driven_away(const Linearised& near, const Problem& free) {
  return near.point.linearity != Linearity::linear && is_driven(free);
}

bool has_claim(const Prediction& row, const Method& method) {
  const bool of_steps =
      row.bound == Bound::stability || row.bound == Bound::accuracy || row.bound == Bound::newton;
  return method.fixed_step && !row.unstable_from && of_steps && !grows_in_runs(row, method);
}

void verify_from(const ModeStart& start, const ShowSteps& run, Prediction& row, const Method& method,
                 const Linearised& near, const FarSteps& far) {
  conclude(row, method, watch_runs(row, method, near, start, run, Outcome::reached_end, far));
}

void verify(Prediction& row, const Method& method, const Problem& problem, const Linearised& near,
            const std::function<void()>& watch) {
  if (grows_in_runs(row, method))
    row.note += "; not verified: runs would show the growth of the model itself";
  if (!has_claim(row, method)) return;
  const Eigen::MatrixXd free_rigid =
      problem.body ? free_motions(*problem.body) : free_motions_of_matrices(near);
  const Rates rates = rates_of(row, free_rigid.cols() > 0);
  if (rates.fastest == 0) return;  // nothing moves
  const Method& step = method.analysed();
  Problem free = after_ramps(problem);
  if (std::string why = why_not_verified(step, free, near); !why.empty()) {
    add_sentence(row.note, why);
    return;
  }
  const MemoryShare memory(memory_of_runs(step, free));
  Eigen::VectorXd rest = near.point.model.y;
  take_off_drive(free, rest);
  const ModeStart start = start_of(row, method, near, rest, rates, free_rigid);
  // Where a mode is watched alone little is seen that is not its own.
  const double most_change = start.mode_alone ? 1e-7 : 1e-4;
  // Near zero, where no offset hides a displacement of one.
  const bool linear = is_affine(near.point.linearity) && !near.point.is_body && rest.isZero(0);
  const SmallDisplacement small = linear ? SmallDisplacement{.size = 1}
                                         : small_displacement(problem, near, start.displacement, most_change);
  const auto outcome = std::make_shared<Outcome>(Outcome::reached_end);
  const ShowSteps run = watched(steps_of(step, free, rest, small.size * start.displacement, outcome), watch);
  Finding finding = watch_runs(row, method, near, start, run, *outcome, far_steps(problem, start, rates));
  if (!problem.body && !small.is_linear && (!finding.seen.excused || row.bound == Bound::stability))
    finding.excuse_states(
        "not verified: the model is not linear within the smallest motions about this state that runs can show");
  if (driven_away(near, free)) finding.excuse_drive();
  if (row.bound != Bound::stability && free_rigid.cols() > 0 && rounding_of_stiffness(near.point.model) > 0)
    finding.excuse(
        "the few digits of the stiffness let its rigid-body modes grow in steps that are that long");
  conclude(row, method, finding);
}

}  // namespace hmax
