#include "bench/predict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "analysis/amplification.hpp"
#include "analysis/coupled_motion.hpp"
#include "analysis/equilibrium.hpp"
#include "analysis/growth.hpp"
#include "bench/measured_amplification.hpp"
#include "bench/mode_curve.hpp"
#include "bench/mode_start.hpp"
#include "bench/planar.hpp"
#include "bench/tissue_problem.hpp"
#include "integrators/spectral_radius.hpp"
#include "problems/tissue/body.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A state in words, if it is short.
std::string words_of(const Eigen::VectorXd& y) {
  if (y.size() > 4) return fmt::format("of {} numbers", y.size());
  std::string text;
  for (const double value : y) text += (text.empty() ? "" : ", ") + fmt::format("{:.6g}", value);
  return "(" + text + ")";
}

/// The amplification as far as the method can be analysed on this model, or why not.
std::string obstacle(const Method& method, const Linearised& near) {
  if (method.needs_second_order && !near.model.mechanical)
    return "the method steps positions and velocities, which the problem does not have";
  if (method.needs_split && !near.model.J_stiff) return "the problem declares no stiff part";
  return {};
}

/// lambda with the larger imaginary part only: methods and models are real.
std::vector<Complex> without_conjugates(const std::vector<Complex>& lambda) {
  std::vector<Complex> kept;
  for (const Complex each : lambda)
    if (each.imag() >= 0) kept.push_back(each);
  return kept;
}

/// |A - B| / |A|.
double distance_between(const AnyMatrix& A, const AnyMatrix& B) {
  if (!is_sparse(A) || !is_sparse(B)) return (dense(A) - dense(B)).norm() / dense(A).norm();
  using Sparse = Eigen::SparseMatrix<double>;
  return Sparse(std::get<Sparse>(A) - std::get<Sparse>(B)).norm() / std::get<Sparse>(A).norm();
}

/// Beyond this many rows parts of a Jacobian are not looked into for common modes.
constexpr Eigen::Index most_dense_parts = 400;

/// The share of every eigenvalue that is declared stiff. Where both parts have the same eigenvectors the
/// Rayleigh quotient with them says it.
std::optional<std::vector<Complex>> stiff_parts(const Linearised& near, const std::vector<Complex>& lambda) {
  if (distance_between(near.model.J, *near.model.J_stiff) <= 1e-13) return lambda;
  if (rows(near.model.J) > most_dense_parts) return std::nullopt;
  const Eigen::MatrixXd J = dense(near.model.J), stiff = dense(*near.model.J_stiff);
  if ((J * stiff - stiff * J).norm() > 1e-10 * J.norm() * stiff.norm()) return std::nullopt;
  const Eigenvectors vectors = eigenvectors_of(near.model);
  if (vectors.defective) return std::nullopt;
  std::vector<Complex> parts;
  for (const Complex each : lambda) {
    const auto at =
        std::ranges::min_element(vectors.lambda, {}, [&](Complex l) { return std::abs(l - each); });
    const auto i = static_cast<Eigen::Index>(at - vectors.lambda.begin());
    parts.push_back((vectors.left.row(i) * stiff.cast<Complex>() * vectors.right.col(i)).value());
  }
  return parts;
}

/// The spectral radius by which a stabilised method chooses its stages: the bound of the system, or what the
/// estimate of the stepper comes to.
double radius_told(const Problem& problem, const Linearised& near) {
  return std::visit(
      [&]<class Sys>(const Sys& system) -> double {
        if constexpr (BoundedSpectrumSystem<Sys>)
          if (has_spectral_radius(system)) return system.spectral_radius(near.model.t, near.model.y);
        double radius = 0;
        for (const Complex lambda : near.spectrum.lambda) radius = std::max(radius, std::abs(lambda));
        return SpectralRadius<Eigen::VectorXd>::margin * radius;
      },
      problem.system);
}

bool solves_nonlinear_equations(const Method& method) {
  return !method.is_explicit && method.family != "rosenbrock" && method.needs_jacobian;
}

bool is_linear(const Problem& problem) {
  const auto* oscillator = std::get_if<Oscillator>(&problem.system);
  return oscillator != nullptr && oscillator->parameters().k3 == 0;
}

/// @throws InputError  where squares of eigenvalues, which stiffness is, leave the range of numbers
void require_usual_rates(const Spectrum& spectrum) {
  constexpr double most = 1e140;
  for (const Complex lambda : spectrum.lambda)
    if (!(std::abs(lambda) <= most))
      throw InputError(fmt::format(
          "the model has an eigenvalue of {:.3g} 1/s, and beyond {:.0e} the products of rates leave "
          "the range of numbers; give masses, stiffness and damping in units of one size",
          std::abs(lambda), most));
}

LinearModel linear_model(const Problem& problem, double t, const Eigen::VectorXd& y) {
  return std::visit(
      [&]<class Sys>(const Sys& system) { return linearise(system, t, typename Sys::State(y)); },
      problem.system);
}

/// Whether the Jacobian elsewhere is the same to rounding: the model is linear.
bool has_constant_jacobian(const Problem& problem, const Linearised& near) {
  const Eigen::VectorXd elsewhere = near.model.y + Eigen::VectorXd::Ones(near.model.y.size());
  return distance_between(near.model.J, linear_model(problem, near.model.t, elsewhere).J) <= 1e-12;
}

}  // namespace

std::string_view name_of(Bound bound) {
  switch (bound) {
    case Bound::stability:
      return "stability";
    case Bound::accuracy:
      return "accuracy";
    case Bound::newton:
      return "newton";
    case Bound::model:
      return "model";
    case Bound::every_step:
      return "every_step";
    case Bound::error_control:
      return "error_control";
    case Bound::unknown:
      break;
  }
  return "unknown";
}

Linearised linearised(const Problem& problem, double t, const Eigen::VectorXd& y) {
  Linearised near{.model = linear_model(problem, t, y), .spectrum = {}, .state = {}};
  if (!set_curve(near)) near.spectrum = spectrum_of(near.model);
  require_usual_rates(near.spectrum);
  near.state =
      fmt::format("{} at t = {} s, Jacobian {}", words_of(y), to_text(t), name_of(near.model.origin));
  return near;
}

namespace {
/// A body is at rest where forces are nothing beside those that rounding of its points makes; under a load
/// its balance is found with its stiffness, half as many unknowns.
std::optional<EquilibriumSearch> balance_of_body(const Problem& problem) {
  if (!problem.body || !problem.body->is_autonomous() || !problem.y0.isZero(0)) return std::nullopt;
  const TissueBody& body = *problem.body;
  const StaticModel model = static_model(problem, 1);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(body.dofs()), f = q;
  StaticModel::Matrix K;
  model.force(q, f);
  model.stiffness(q, K);
  const double rounding =
      1e-13 * K.diagonal().cwiseAbs().maxCoeff() * body.mesh().points.cwiseAbs().maxCoeff();
  EquilibriumSearch search{EquilibriumOutcome::found, problem.y0, 0, 0, {}};
  if (f.cwiseAbs().maxCoeff() <= rounding) return search;
  const StaticSolution solution = solve_static(model, {.tolerance = 1e-12}, [] { return 0.0; });
  if (!solution.converged) return std::nullopt;
  search.state.head(body.dofs()) = solution.q;
  return search;
}

EquilibriumSearch equilibrium_of(const Problem& problem) {
  if (const auto balance = balance_of_body(problem)) return *balance;
  return std::visit(
      [&]<class Sys>(const Sys& system) {
        return find_equilibrium(system, 0, typename Sys::State(problem.y0));
      },
      problem.system);
}
}  // namespace

LinearModel linear_model(const Problem& problem) {
  const EquilibriumSearch search = equilibrium_of(problem);
  return linear_model(problem, 0, search.found() ? search.state : problem.y0);
}

Linearised linearised(const Problem& problem) {
  const EquilibriumSearch search = equilibrium_of(problem);
  Linearised near = linearised(problem, 0, search.found() ? search.state : problem.y0);
  near.at_equilibrium = search.found();
  if (!search.found())
    near.state = fmt::format("initial state {}; {}", near.state, search.message);
  else
    near.state = fmt::format(
        "equilibrium {}{}", near.state,
        search.conserved > 0 ? ", reachable: what the model conserves is that of the initial state" : "");
  return near;
}

namespace {

/// What sets the step where no step is unstable.
Bound bound_without_limit(const Method& method, const Problem& problem, const Linearised& near) {
  return solves_nonlinear_equations(method) && !has_constant_jacobian(problem, near) ? Bound::newton
                                                                                     : Bound::accuracy;
}

void is_of_growing_model(Prediction& row, Complex lambda) {
  row.bound = Bound::model;
  row.limiting = mode_of(lambda);
  row.note = "the model itself grows: an eigenvalue has a positive real part";
}

/// Names what limits the step: nothing, or a mode.
void conclude(Prediction& row, double h_max, Complex lambda, const Method& method, const Problem& problem,
              const Linearised& near) {
  row.h_max = h_max;
  if (std::isinf(h_max)) {
    row.bound = bound_without_limit(method, problem, near);
    return;
  }
  row.limiting = mode_of(lambda);
  row.bound = h_max > 0 ? Bound::stability : Bound::every_step;
  if (h_max == 0) row.note = "a mode that the model keeps is amplified by every step, however small";
}

/// Where only the ends of a spectrum are known the limit is the least along the curve of all modes between.
void predict_on_curve(Prediction& row, const Method& method, const Problem& problem, const Linearised& near) {
  if (near.curve->kappa_min < 0)
    return is_of_growing_model(row, eigenvalues_of(near.curve->at(near.curve->kappa_min))[0]);
  LimitOnCurve limit = limit_on_curve(*method.amplification, near, radius_told(problem, near));
  row.modes = std::move(limit.modes);
  conclude(row, limit.h_max, limit.lambda, method, problem, near);
  if (row.note.empty()) row.note = limit.note;
}

/// Where the steps couple modes the whole model has one limit.
void predict_coupled(Prediction& row, const Method& method, const Problem& problem, const Linearised& near) {
  row.coupled = true;
  row.state += "; the steps couple the modes, so that all of them are taken together";
  const std::vector<Complex> lambda = without_conjugates(near.spectrum.lambda);
  for (const Complex each : lambda)
    row.modes.push_back({mode_of(each), std::numeric_limits<double>::quiet_NaN(), Eigenmode(each)});
  if (const auto growing = growing_modes(lambda); !growing.empty())
    return is_of_growing_model(row, lambda[growing.front()]);
  const MechanicalPart& part = *near.model.mechanical;
  const auto limit = CoupledMotion(*method.amplification->motion, part).first_exit(*method.amplification);
  if (!limit) {
    row.note = fmt::format(
        "{} degrees of freedom whose modes are coupled are too many to look for the limit of this method",
        part.mass.size());
    return;
  }
  const auto pair = eigenvalues_of(limit->shape);
  conclude(row, limit->h_max, pair[0].imag() != 0 ? pair[0] : pair[1], method, problem, near);
}

}  // namespace

Prediction predict(const Method& method, const Problem& problem, const Linearised& near) {
  Prediction row;
  row.problem = problem.id;
  row.material = problem.material;
  row.method = method.id;
  row.parameters = problem.parameters;
  row.state = near.state;
  if (!method.amplification) {
    row.bound = Bound::error_control;
    row.note = "the method chooses its steps as it runs";
    return row;
  }
  row.note = obstacle(method, near);
  if (!row.note.empty()) return row;

  const Amplification& amplification = *method.amplification;
  if (near.curve) {
    if (method.needs_split && distance_between(near.model.J, *near.model.J_stiff) > 1e-13)
      row.note = "the stiff part and the rest of this model have no common modes";
    else if (amplification.motion && !amplification.motion->lumped.empty() && near.curve->beta != 0)
      row.note = "the method solves for a part of the damping alone, which couples the modes of this model";
    else
      predict_on_curve(row, method, problem, near);
    return row;
  }
  if (amplification.motion && couples_modes(*amplification.motion, *near.model.mechanical)) {
    predict_coupled(row, method, problem, near);
    return row;
  }
  StepLimit limit;
  std::vector<Complex> lambda;
  std::vector<Eigenmode> told;
  if (method.amplification->of_oscillation) {
    // Both eigenvalues of an oscillation share its limit.
    const std::vector<MechanicalMode>& modes = near.spectrum.mechanical;
    limit = largest_stable_step(*method.amplification, modes);
    // Named by the upper one, or by the faster of two real ones.
    for (const MechanicalMode& mode : modes) {
      const auto pair = eigenvalues_of(mode);
      lambda.push_back(pair[0].imag() != 0 ? pair[0] : pair[1]);
    }
    told = std::vector<Eigenmode>(lambda.begin(), lambda.end());
  } else {
    lambda = without_conjugates(near.spectrum.lambda);
    told = std::vector<Eigenmode>(lambda.begin(), lambda.end());
    const double radius = radius_told(problem, near);
    for (Eigenmode& mode : told) mode.radius = radius;
    if (method.needs_split) {
      const auto parts = stiff_parts(near, lambda);
      if (!parts) {
        row.note = "the stiff part and the rest of this model have no common modes";
        return row;
      }
      for (std::size_t i = 0; i < told.size(); ++i) told[i].stiff = (*parts)[i];
    }
    limit = largest_stable_step(*method.amplification, told);
  }
  for (std::size_t i = 0; i < lambda.size(); ++i)
    row.modes.push_back({mode_of(lambda[i]), limit.of_modes[i], told[i]});

  if (!limit.growing.empty())
    is_of_growing_model(row, lambda[limit.growing.front()]);
  else
    conclude(row, limit.h_max, lambda[limit.limiting], method, problem, near);
  return row;
}

namespace {

RunRecord take_steps(const Runner& runner, double h, std::int64_t steps, const Sink& sink) {
  RunSpec spec{.t_end = h * static_cast<double>(steps), .h = h};
  spec.max_steps = steps + 2;
  return runner.run(spec, sink);
}

/// Runs of the real code from rest + displacement, shown step by step. Where time drives the problem a run
/// from rest is taken off: what is left moves as the free model does.
ShowSteps steps_of(const Method& method, const Problem& problem, const Eigen::VectorXd& rest,
                   const Eigen::VectorXd& displacement, const std::shared_ptr<Outcome>& outcome) {
  const auto from = [&](const Eigen::VectorXd& start) {
    Problem started = problem;
    started.y0 = start;
    return method.bind(started);
  };
  const bool driven = is_driven(problem);
  const Runner displaced = from(rest + displacement), undisturbed = from(rest);
  return [=](double h, std::int64_t steps, const auto& show) {
    std::vector<double> path;
    if (driven)
      take_steps(undisturbed, h, steps, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
        path.insert(path.end(), y.begin(), y.end());
      });
    const auto wanted = static_cast<std::size_t>(steps + 1) * static_cast<std::size_t>(rest.size());
    if (driven && path.size() < wanted) return false;
    std::size_t at = 0;
    Eigen::VectorXd free(rest.size());
    const RunRecord record =
        take_steps(displaced, h, steps, [&](double, const Eigen::Ref<const Eigen::VectorXd>& y) {
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

/// What the method makes of mode `i` of the row: an oscillation as a whole where it steps positions and
/// velocities.
Growth growth_of(const Method& method, const Prediction& row, const Linearised& near, std::size_t i) {
  return method.amplification->of_oscillation
             ? method.amplification->of_oscillation(near.curve
                                                        ? oscillation_of(near, row.modes.at(i).mode.lambda)
                                                        : near.spectrum.mechanical.at(i))
             : method.amplification->of_eigenmode(row.modes.at(i).told);
}

/// The logarithm of the largest factor below one by which a step of size h multiplies part of the motion.
/// @param only  a mode beside which nothing else is to be seen
double decay_beside(const Method& method, const Prediction& row, const Linearised& near, double h,
                    std::optional<std::size_t> only) {
  double slowest = 0;
  for (std::size_t i = only.value_or(0); i < (only ? *only + 1 : row.modes.size()); ++i) {
    const Growth growth = growth_of(method, row, near, i);
    if (!growth.polynomial) {
      // The roots of a foreign method that looks back are not known: a weakly damped mode may outlast the
      // start.
      if (method.amplification->measured && remembers(method)) slowest = std::max(slowest, 0.995);
      continue;
    }
    for (const Complex root : growth.polynomial->roots(h))
      if (const double size = std::abs(root); size < 1 - 1e-4) slowest = std::max(slowest, size);
  }
  return std::log(slowest);
}

/// The logarithm of what a run from a mode shows of its growth at h. The run begins in the root near
/// exp(lambda h); another one, which only methods of several steps have, begins as small as rounding and has
/// to grow by so much more.
double visible_growth(const Method& method, const Growth& growth, Complex lambda, double h) {
  const double whole = std::log(growth.spectral_radius(h));
  if (!growth.polynomial || method.amplification->of_oscillation) return whole;
  const std::vector<Complex> roots = growth.polynomial->roots(h);
  const auto near = std::ranges::min_element(
      roots, {}, [&](Complex root) { return std::abs(root - std::exp(lambda * h)); });
  // Where that root decays, what is left is soon the other one.
  if (std::abs(*near) < 1 - 1e-4 || std::log(std::abs(*near)) > whole / 2) return whole;
  constexpr double from_rounding = 150;  // 2 ln 1e16, beside what is visible
  return whole / from_rounding;
}

/// What runs from the limiting mode of a row show beside its limit.
ExpectedGrowth expected_of_mode(const Method& method, const Prediction& row, const Linearised& near,
                                Complex limiting, bool mode_alone) {
  const auto at = std::ranges::min_element(
      row.modes, {}, [&](const ModeMargin& m) { return std::abs(m.mode.lambda - limiting); });
  const auto i = static_cast<std::size_t>(at - row.modes.begin());
  const Growth growth = growth_of(method, row, near, i);
  const std::optional<std::size_t> only = mode_alone ? std::optional(i) : std::nullopt;
  return {.above = std::max(visible_growth(method, growth, limiting, 1.001 * *row.h_max), 1e-12),
          .beside = decay_beside(method, row, near, *row.h_max, only)};
}

/// The same where the steps couple all modes: what grows is a small part of the start.
ExpectedGrowth expected_of_all(const Method& method, const Linearised& near, double h_max) {
  const CoupledMotion motion(*method.amplification->motion, *near.model.mechanical);
  constexpr double from_small_part = 8;  // as 150 is for what begins as rounding
  double slowest = 0;
  for (const Complex root : motion.roots(h_max))
    if (const double size = std::abs(root); size < 1 - 1e-4) slowest = std::max(slowest, size);
  return {.above = std::max(std::log(motion.spectral_radius(1.001 * h_max)) / from_small_part, 1e-12),
          .beside = std::log(slowest)};
}

/// How much of `direction` is small enough for the model to be linear: the Jacobian changes by less than a
/// part in ten thousand. About rest at zero nothing is lost by that.
double small_displacement(const Problem& problem, const Linearised& near, const Eigen::VectorXd& direction) {
  double size = 1e-6 * std::max(1.0, near.model.y.cwiseAbs().maxCoeff());
  const auto change = [&] {
    const Eigen::VectorXd y = near.model.y + size * direction;
    return distance_between(near.model.J, linear_model(problem, near.model.t, y).J);
  };
  for (int tenth = 0; tenth < 3 && change() > 1e-4; ++tenth) size /= 10;
  return size;
}

/// A driven linear oscillator moves about its forced motion as the free one moves about zero, and at steps
/// far beyond every time scale only the latter can be told from rounding.
void take_off_drive(Problem& problem, Eigen::VectorXd& rest) {
  if (!is_linear(problem)) return;
  OscillatorParameters parameters = std::get<Oscillator>(problem.system).parameters();
  parameters.P = 0;
  problem.system = Oscillator(parameters);
  rest.setZero();
}

}  // namespace

void verify(Prediction& row, const Method& method, const Problem& problem, const Linearised& near) {
  if (!method.fixed_step ||
      (row.bound != Bound::stability && row.bound != Bound::accuracy && row.bound != Bound::newton))
    return;
  if (!std::ranges::any_of(row.modes, [](const ModeMargin& margin) { return margin.mode.omega > 0; })) return;
  // The limiting mode, or the slowest.
  const Complex wanted = row.limiting ? row.limiting->lambda : row.modes.front().mode.lambda;
  Problem free = problem;
  Eigen::VectorXd rest = near.model.y;
  take_off_drive(free, rest);
  double slowest = infinity, fastest = 0;
  for (const ModeMargin& margin : row.modes) {
    if (margin.mode.omega > 0) slowest = std::min(slowest, margin.mode.omega);
    fastest = std::max(fastest, margin.mode.omega);
  }
  const ModeStart start = start_from_mode(near, rest, wanted, fastest);
  const Distance& distance = start.distance;
  const double size = is_linear(problem) ? 1 : small_displacement(problem, near, start.displacement);
  const auto outcome = std::make_shared<Outcome>(Outcome::reached_end);
  const ShowSteps run = steps_of(method, free, rest, size * start.displacement, outcome);
  Observation seen;
  if (row.bound != Bound::stability) {
    const double h = 1e6 / slowest;
    seen.steps = 4096;
    seen.agrees = !grows_at(run, distance, h);
    if (!seen.agrees && *outcome == Outcome::newton_failed) {
      row.bound = Bound::newton;
      row.note = fmt::format(
          "no step is unstable, but at {} s, a million times the slowest time scale, Newton's "
          "method does not solve the equations of a step: it is what limits the step",
          to_text(h));
    }
    seen.h_max = seen.agrees ? infinity : std::numeric_limits<double>::quiet_NaN();
    seen.gap = std::numeric_limits<double>::quiet_NaN();
  } else {
    const ExpectedGrowth expected = row.coupled
                                        ? expected_of_all(method, near, *row.h_max)
                                        : expected_of_mode(method, row, near, wanted, start.mode_alone);
    const ObservedLimit limit =
        observe_limit(run, distance, *row.h_max,
                      {.above = expected.above, .beside = expected.beside, .linear = start.defective});
    seen = {.h_max = limit.h,
            .gap = limit.h / *row.h_max - 1,
            .steps = limit.steps,
            .agrees = limit.below_decays && limit.above_grows};
  }
  if (!seen.agrees && seen.steps >= most_observed_steps)
    row.note =
        fmt::format("growth beyond this limit is too slow to be seen in {} steps", most_observed_steps);
  seen.step_defect = step_defect(method);
  row.observed = seen;
  if (!is_linear(problem) && is_driven(problem) && !seen.agrees)
    row.note =
        "the force moves the model away from this state, so that small motions are those about another; the limit "
        "along the motion says more";
}

}  // namespace hmax
