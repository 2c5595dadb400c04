#include "limits/fidelity/fidelity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "analysis/amplification/numerical_damping.hpp"
#include "analysis/dynamics/growth.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/choice/simulators.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/text/sentences.hpp"
#include "limits/by_steps/one_step_map.hpp"
#include "limits/fidelity/run_to_rest.hpp"
#include "limits/fidelity/settled_state.hpp"
#include "limits/fidelity/steps_stiffness.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

using Eigen::VectorXd;

Problem stiffened(const FidelityModel& model, double factor) {
  return factor == 1 ? model.problem : with_stiffness(model.problem, factor);
}

/// f . q_exact of a body whose stiffnesses are `factor` times those of the model; NaN where it has no
/// equilibrium.
double exact_sag(const FidelityModel& model, double factor) {
  if (factor == 1) return model.load.dot(model.equilibrium);
  const StaticSolution solution = found_equilibrium(stiffened(model, factor), 1, {}, [] { return 0.0; });
  return solution.converged ? model.load.dot(solution.q) : Fidelity::none;
}

/// The factor with which the model sags so much: nearly in proportion to its inverse. NaN where no factor
/// does.
double factor_of_sag(const FidelityModel& model, double sag) {
  double factor = model.load.dot(model.equilibrium) / sag;
  for (int i = 0; i < 30 && factor > 0; ++i) {
    const double ratio = exact_sag(model, factor) / sag;
    if (std::abs(ratio - 1) <= 1e-7) return factor;
    factor *= ratio;
  }
  return Fidelity::none;
}

/// About which share of its distance the slowest motion goes in a step from rest.
double share_of_step(const FidelityModel& model, double factor, double h) {
  const double turn = (model.modes.empty() ? 0.1 / h : model.modes.front().omega * std::sqrt(factor)) * h;
  return std::min(1.0, turn * turn);
}

Problem without_load(const Problem& problem) {
  return with_settings(problem, [](TissueSettings& settings) {
    settings.gravity.setZero();
    settings.forces.clear();
  });
}

/// Growth beyond what differences resolve.
bool grows(const StepModes& modes) { return std::abs(modes.largest) > 1 + 1e-5; }

/// Where the steps come to rest with the load and without.
struct SettledStates {
  SettledState loaded;
  SettledState rest;
  StepModes modes = {};  ///< about `loaded`, where they were asked for
  bool by_run = false;   ///< `loaded` was sought from where a run came to rest
  [[nodiscard]] bool stays() const { return found() && !grows(modes); }
  [[nodiscard]] bool found() const { return loaded.settled && rest.settled; }
  [[nodiscard]] double sag(const FidelityModel& model) const { return model.load.dot(loaded.q - rest.q); }
};

/// Where steps of a model that nothing loads come to rest: where it is, but for methods that move it.
/// @param size  of displacements that count, as a norm [m]
SettledState settled_without_load(const VectorFunction& step, Eigen::Index n, double size, double share,
                                  const std::function<void()>& watch) {
  const VectorXd moved = step(VectorXd::Zero(2 * n)).head(n);
  // Rounding moves it, and the tolerance of equations.
  if (moved.norm() <= 1e-6 * share * size) return {.q = VectorXd::Zero(n), .settled = true};
  return settled_state(step, moved, share, watch, size);
}

/// @param start  near it; zero where nothing loads the model
SettledState settled_from(const VectorFunction& step, const VectorXd& start, const FidelityModel& model,
                          double share, const std::function<void()>& watch) {
  return start.isZero(0) ? settled_without_load(step, start.size(), model.sizes.norm(), share, watch)
                         : settled_state(step, start, share, watch);
}

/// @param near  a displacement near which they may rest
SettledStates settle(const Method& method, const FidelityModel& model, double factor,
                     const FidelityQuestion& question, const VectorXd& near) {
  const Problem problem = stiffened(model, factor);
  const double share = share_of_step(model, factor, question.h);
  SettledStates found;
  found.loaded =
      settled_from(step_of_model(method, model, problem, question.h), near, model, share, question.watch);
  found.rest = {.q = VectorXd::Zero(near.size()), .settled = true};
  // Methods of other models keep an equilibrium.
  if (found.loaded.settled && problem.body)
    found.rest = settled_without_load(one_step_map(method, without_load(problem), question.h), near.size(),
                                      near.norm(), share, question.watch);
  return found;
}

SettledStates settle(const Method& method, const FidelityModel& model, double factor,
                     const FidelityQuestion& question) {
  return settle(method, model, factor, question, model.equilibrium / std::max(1.0, factor));
}

StepModes modes_of(const Method& method, const FidelityModel& model, double factor,
                   const FidelityQuestion& question, const VectorXd& q) {
  const Problem problem = stiffened(model, factor);
  const bool compares = factor == 1;  // of other stiffnesses growth alone is asked
  return shown_modes(step_of_model(method, model, problem, question.h), q,
                     model.is_loaded() ? q : model.sizes, question.h, model.mass,
                     compares ? model.shapes : Eigen::MatrixXd(q.size(), 0),
                     compares ? model.modes : std::vector<ShownMode>{}, question.watch);
}

/// The same with the modes there; where nothing settles near the equilibrium of the model, or nothing stays,
/// of where a run from rest comes, if it stays there.
SettledStates settle_to_stay(const Method& method, const FidelityModel& model, double factor,
                             const FidelityQuestion& question) {
  const auto with_modes = [&](SettledStates found) {
    if (found.found()) found.modes = modes_of(method, model, factor, question, found.loaded.q);
    return found;
  };
  SettledStates found = with_modes(settle(method, model, factor, question));
  if (found.stays() || !model.is_loaded()) return found;
  const RunToRest run = run_to_rest(step_of_model(method, model, stiffened(model, factor), question.h),
                                    model.mass, share_of_step(model, factor, question.h), question.watch);
  found.loaded.steps += run.steps;
  if (run.q.size() == 0) return found;
  SettledStates other = with_modes(settle(method, model, factor, question, run.q));
  if (!other.stays() || !other.modes.linear) return found;  // else growth is not known
  other.loaded.steps += found.loaded.steps;
  other.by_run = true;
  return other;
}

/// Why steps do not settle.
std::string unsettled_in_words(const SettledState& found, const Method& method, const FidelityModel& model,
                               double h) {
  if (std::isfinite(found.residual))
    return fmt::format(
        "its steps do not settle near the equilibrium of the model: {} of them leave a residual of {:.1e}",
        found.steps, found.residual);
  Problem problem = model.problem;
  problem.y0.setZero();
  problem.y0.head(model.start.size()) = model.start + model.equilibrium;
  const RunRecord run = method.bind(problem).run({.t_end = h, .h = h, .jacobian = {1}}, {});
  return run.note.empty() ? "its steps leave the range of numbers"
                          : fmt::format("a step of it from the equilibrium of the model fails: {}", run.note);
}

/// "a factor of 1.4", "0.003 %".
std::string growth_in_words(double modulus) {
  return modulus < 1.1 ? short_number(100 * (modulus - 1), 3) + " %"
                       : "a factor of " + short_number(modulus, 4);
}

constexpr std::string_view not_linear =
    "its iterations are not linear in the state, so that no eigenvalue tells what they make of a mode";

/// The modulus that is shown where `factor` times that of the model is entered [Pa]; NaN where nothing
/// settles, or against the load.
double modulus_shown(const Method& method, const FidelityModel& model, double factor,
                     const FidelityQuestion& question) {
  const SettledStates found = settle_to_stay(method, model, factor, question);
  if (!found.stays()) return Fidelity::none;
  const double sag = found.sag(model);
  return sag > 0 ? young_of(model.problem) * factor_of_sag(model, sag) : Fidelity::none;
}

/// E with which the steps sag as the model does with the wanted one, by bisection of its logarithm; NaN where
/// no E does.
double modulus_to_enter(const Method& method, const FidelityModel& model, const FidelityQuestion& question) {
  const double E = young_of(model.problem), first = *question.wanted / E;
  const double wanted = exact_sag(model, first);
  if (!(wanted > 0)) return Fidelity::none;
  constexpr double most = 1e10;
  // Factors that sag too much, and little enough. Several rests may be there: first that near the
  // equilibrium.
  double low = 0, high = 0, before = 0;
  SettledStates found;
  const auto look = [&](double factor) {
    const SettledStates last =
        std::exchange(found, before == 0 ? settle_to_stay(method, model, factor, question)
                                         : settle(method, model, factor, question));
    if (before > 0 && (!found.found() || last.by_run)) {
      found = settle(method, model, factor, question, last.loaded.q * std::min(1.0, before / factor));
      found.by_run = last.by_run;
    }
    before = factor;
    if (!found.found() || !(found.sag(model) > 0)) return false;
    (found.sag(model) > wanted ? low : high) = factor;
    return true;
  };
  if (!look(first)) return Fidelity::none;
  if (std::abs(found.sag(model) / wanted - 1) < 1e-6) low = high = first;  // of exact steps
  // By strides that shrink where what lies beyond does not settle.
  const auto stride_on = [&](double& end, double stride) {
    for (double factor = first; end == 0;) {
      const SettledStates last = found;
      if (factor * stride > most || factor * stride * most < 1) return false;
      if (look(factor * stride)) {
        factor *= stride;
        continue;
      }
      found = last;
      before = factor;
      stride = std::sqrt(stride);
      if (std::abs(std::log(stride)) < 0.01) return false;
    }
    return true;
  };
  if (!stride_on(high, 4.0) || !stride_on(low, 0.25)) return Fidelity::none;
  while (high / low > 1 + 1e-5)
    if (!look(std::sqrt(low * high))) return Fidelity::none;
  const double factor = std::sqrt(low * high);
  if (!look(factor) || grows(modes_of(method, model, factor, question, found.loaded.q)))
    return Fidelity::none;
  return factor * E;
}

/// Frequency and damping ratio of a decaying sequence of one oscillation, from a fit of
/// x_(k+1) = a x_k - b x_(k-1) over all of it: roots of z^2 - a z + b. NaN where one of them turns about in
/// every step.
std::pair<double, double> oscillation_in(const std::vector<double>& x, double h) {
  Eigen::MatrixXd past(static_cast<Eigen::Index>(x.size()) - 2, 2);
  VectorXd next(past.rows());
  for (Eigen::Index k = 0; k < past.rows(); ++k) {
    past.row(k) << x[static_cast<std::size_t>(k) + 1], -x[static_cast<std::size_t>(k)];
    next[k] = x[static_cast<std::size_t>(k) + 2];
  }
  const VectorXd ab = past.colPivHouseholderQr().solve(next);
  const std::complex<double> half = std::sqrt(std::complex<double>(ab[0] * ab[0] / 4 - ab[1], 0));
  if (half.imag() == 0 && !(ab[0] / 2 > half.real())) return {Fidelity::none, Fidelity::none};
  // Of an overdamped oscillation both roots are real: omega^2 is the product of the rates, 2 zeta omega their
  // sum.
  const std::complex<double> a = std::log(ab[0] / 2 + half) / h, b = std::log(ab[0] / 2 - half) / h;
  const double omega = std::sqrt(std::abs(a * b));
  return {omega, -(a + b).real() / (2 * omega)};
}

/// Steps of a run at most: a minute for large bodies.
constexpr double most_observed = 5000;

/// omega h and zeta omega h of a mode as it is shown, or of the model where nothing is.
std::pair<double, double> rates_of(const ShownMode& mode, double h) {
  const double omega = std::isnan(mode.omega_shown) ? mode.omega : mode.omega_shown;
  return {omega * h, std::max(0.0, mode.zeta_shown) * omega * h};  // 0 where it is NaN
}

/// The mean displacement of a run from rest over two periods of the slowest mode, once a thousandth of its
/// motion is left; empty where it still moves then.
VectorXd observed_rest(const VectorFunction& step, Eigen::Index n, const Fidelity& row) {
  auto [turn, decay] =
      rates_of(row.modes.empty() ? ShownMode{.omega = 0.1 / row.h} : row.modes.front(), row.h);
  if (decay > turn)
    decay = turn * turn / (decay + std::sqrt(decay * decay - turn * turn));  // the slower of two
  const auto settling =
      static_cast<std::int64_t>(decay > 0 ? std::min(most_observed, 7 / decay + 100) : most_observed);
  const auto averaged =
      static_cast<std::int64_t>(std::clamp(4 * std::numbers::pi / turn, 1.0, most_observed));
  constexpr double still = 1e-10;
  VectorXd y = VectorXd::Zero(2 * n), mean = VectorXd::Zero(n);
  for (std::int64_t i = 0; i < settling + averaged; ++i) {
    const VectorXd next = step(y);
    if (!next.allFinite()) return {};
    // Where it turns back displacements rest for a step, and velocities change.
    if (std::max((next - y).head(n).norm(), row.h * (next - y).tail(n).norm()) <= still * next.head(n).norm())
      return next.head(n);
    y = next;
    if (i >= settling) mean += y.head(n) / static_cast<double>(averaged);
  }
  return (y.head(n) - mean).norm() <= 0.02 * mean.norm() ? mean : VectorXd();
}

/// A mode as a run about the settled state shows it: two periods, after half of one in which what the step
/// does not continue dies away. NaN where it decays within a few steps.
/// @param size   of displacements that matter, in the norm of M
/// @param start  as StepModes has it
ShownMode observed_mode(const VectorFunction& step, const MassMatrix<double>& mass, const VectorXd& settled,
                        double size, const VectorXd& shape, const VectorXd& start, ShownMode mode, double h) {
  constexpr double least_steps = 12, least_left = 1e-3;
  const auto [turn, decay] = rates_of(mode, h);
  const double visible = decay > 0 ? -std::log(least_left) / decay : most_observed;
  const double wanted = std::min({5 * std::numbers::pi / turn, visible, most_observed});
  mode.omega_shown = mode.zeta_shown = Fidelity::none;
  if (wanted < least_steps) return mode;
  const Eigen::Index n = settled.size();
  VectorXd y = 1e-3 * size * start;
  y.head(n) += settled;
  const VectorXd seen = mass.times(shape);
  std::vector<double> amplitude;
  const auto steps = static_cast<std::int64_t>(wanted);
  for (std::int64_t i = 0; i <= steps; ++i, y = step(y))
    if (i >= steps / 5) amplitude.push_back(seen.dot(y.head(n) - settled));
  std::tie(mode.omega_shown, mode.zeta_shown) = oscillation_in(amplitude, h);
  return mode;
}

Fidelity::Observed observed_fidelity(const FidelityModel& model, const Fidelity& row,
                                     const FidelityQuestion& question, const SettledStates& settled) {
  const auto watched = [&](const Problem& problem) -> VectorFunction {
    return [map = step_of_model(row.method, model, problem, row.h), &question](const VectorXd& y) {
      if (question.watch) question.watch();
      return map(y);
    };
  };
  const VectorFunction step = watched(model.problem);
  const Eigen::Index n = model.load.size();
  Fidelity::Observed seen;
  if (model.is_loaded()) {
    const VectorXd loaded = observed_rest(step, n, row);
    const VectorXd rest = settled.rest.q.isZero(0)
                              ? settled.rest.q
                              : observed_rest(watched(without_load(model.problem)), n, row);
    if (loaded.size() > 0 && rest.size() > 0)
      seen.stiffness_shown = model.load.dot(model.equilibrium) / model.load.dot(loaded - rest);
  }
  const VectorXd& sizes = model.is_loaded() ? settled.loaded.q : model.sizes;
  const double size = std::sqrt(sizes.dot(model.mass.times(sizes)));
  for (std::size_t k = 0; k < row.modes.size(); ++k)
    seen.modes.push_back(observed_mode(
        step, model.mass, settled.loaded.q, size, model.shapes.col(static_cast<Eigen::Index>(k)),
        settled.modes.starts.col(static_cast<Eigen::Index>(k)), row.modes[k], row.h));
  return seen;
}

/// The largest relative difference; of damping ratios the difference itself.
double gap_of(const Fidelity& row) {
  double gap =
      std::abs(row.observed->stiffness_shown / row.stiffness_shown - 1);  // NaN where it was not seen
  for (std::size_t k = 0; k < row.observed->modes.size(); ++k)
    if (const ShownMode& seen = row.observed->modes[k];
        !std::isnan(seen.omega_shown) && !std::isnan(row.modes[k].omega_shown))
      for (const double each : {std::abs(seen.omega_shown / row.modes[k].omega_shown - 1),
                                std::abs(seen.zeta_shown - row.modes[k].zeta_shown)})
        gap = std::fmax(gap, each);
  return gap;
}

/// Volume, momentum, and what is left without load.
void tell_of_body(Fidelity& row, const FidelityModel& model, const SettledStates& found) {
  row.volume_kept = volume_of(*model.problem.body, found.loaded.q) / model.volume;
  row.rest_moves = largest_displacement(found.rest.q);
  row.momentum = momentum_made(row.method, model.problem, model.equilibrium, row.h);
  if (row.rest_moves > 0.01 * largest_displacement(model.equilibrium))
    add_sentence(row.status, fmt::format("without load it moves {} mm from rest",
                                         short_number(1000 * row.rest_moves, 3)));
  if (const double made = std::max(row.momentum.linear, row.momentum.angular); made > 0.05)
    add_sentence(row.status, fmt::format("its inner forces alone make {} % of momentum in a step",
                                         short_number(100 * made, 2)));
}

/// Ceiling and modulus to enter.
void find_moduli(Fidelity& row, const FidelityModel& model, const FidelityQuestion& question) {
  row.stiffness_ceiling = stiffness_ceiling(row.method, model, question, row.stiffness_shown);
  if (std::isnan(row.stiffness_ceiling) && settings_of(model.problem).elastic_supports.empty())
    add_sentence(row.status,
                 "no ceiling was found: with a larger modulus it does not settle, or against the load");
  if (!question.wanted) return;
  if (std::isnan(exact_sag(model, *question.wanted / young_of(model.problem))))
    return add_sentence(row.status, fmt::format("the model with {} Pa has no equilibrium to compare with",
                                                short_number(*question.wanted, 4)));
  row.modulus_to_enter = modulus_to_enter(row.method, model, question);
  if (!std::isnan(row.modulus_to_enter)) return;
  add_sentence(row.status,
               *question.wanted >= row.stiffness_ceiling
                   ? fmt::format("it shows at most {} Pa, however stiff the material that is entered",
                                 short_number(row.stiffness_ceiling, 4))
                   : "no modulus was found with which it settles as the model does with the wanted one");
}

}  // namespace

std::vector<Method> methods_of_simulators(const Problem& problem) {
  std::vector<std::string> names{"symplectic_euler", "symplectic_euler:substeps=10", "implicit_euler"};
  names.insert(names.end(), iterated_by_simulators.begin(), iterated_by_simulators.end());
  std::vector<Method> methods;
  for (const std::string& name : names)
    if (Method method = find_method(name); suits(method, problem)) methods.push_back(std::move(method));
  return methods;
}

double stiffness_ceiling(const Method& method, const FidelityModel& model, const FidelityQuestion& question,
                         double stiffness_shown) {
  // Springs as supports stay, and sag under the stiffest body; k is no modulus.
  const TissueSettings& settings = settings_of(model.problem);
  if (!settings.elastic_supports.empty() || settings.springs.stiffness > 0) return Fidelity::none;
  const double E = young_of(model.problem);
  const auto shown = [&](double factor) {
    return factor == 1 ? stiffness_shown : modulus_shown(method, model, factor, question) / E;
  };
  return E * stiffness_ceiling(shown, 1e8);
}

Fidelity fidelity(const Method& method, const FidelityModel& model, const FidelityQuestion& question) {
  const bool asks_moduli = question.ceiling || question.wanted;
  if (asks_moduli &&
      require_body(model.problem, "and has no modulus to enter; leave out --ceiling and --enter")
              .settings()
              .springs.stiffness > 0)
    throw InputError(
        "k gives the springs their stiffness whatever the modulus is; leave k out, or --ceiling and --enter");
  Fidelity row{.method = method, .h = question.h, .modes = {}, .status = {}};
  SettledStates found = settle_to_stay(method, model, 1, question);
  row.steps = found.loaded.steps;
  if (!found.found()) {
    add_sentence(row.status, found.loaded.settled
                                 ? "without load " + unsettled_in_words(found.rest, method, model, row.h)
                                 : unsettled_in_words(found.loaded, method, model, row.h));
    return row;
  }
  StepModes& shown = found.modes;
  if (grows(shown)) {
    add_sentence(
        row.status,
        fmt::format("about its settled state its steps grow by {} each, so that it does not stay there",
                    growth_in_words(std::abs(shown.largest))));
    return row;
  }
  if (model.is_loaded()) {
    row.stiffness_shown = model.load.dot(model.equilibrium) / found.sag(model);
    row.settled_error = largest_change(model.problem, found.loaded.q - model.equilibrium) /
                        largest_change(model.problem, model.equilibrium);
  } else {
    add_sentence(
        row.status,
        "nothing loads the model in its start, so that no stiffness is shown; give another with --y0");
  }
  if (model.problem.body) tell_of_body(row, model, found);
  row.modes = std::move(shown.modes);
  if (found.by_run)
    add_sentence(
        row.status,
        "steps do not stay near the equilibrium of the model; this state was reached by a run from rest with "
        "kinetic damping");
  if (row.stiffness_shown < 0) add_sentence(row.status, "it settles against the load");
  if (!shown.linear)
    add_sentence(row.status, fmt::format("{}; runs do", not_linear));
  else if (row.modes.empty())
    add_sentence(row.status, model.why_no_modes);
  else if (std::isnan(row.modes.front().omega_shown))
    add_sentence(row.status, "no eigenvalue of its steps is like the slowest mode");
  if (asks_moduli) find_moduli(row, model, question);
  if (question.verify) {
    row.observed = observed_fidelity(model, row, question, found);
    row.gap = gap_of(row);
    row.contradiction = row.gap > 0.05;
    if (model.is_loaded() && std::isnan(row.observed->stiffness_shown))
      add_sentence(row.status, fmt::format("a run from rest still moves after {} steps", most_observed));
  }
  return row;
}

ShownDamping damping_by_formula(const Method& method, const FidelityModel& model, double h) {
  ShownDamping row{.method = method, .h = h, .modes = {}, .status = "by its formula of one mode"};
  double growing = 0;  // omega
  const auto shown_of = [&](double omega, double zeta) {
    const ShownOscillation shown = shown_oscillation(*method.amplification, omega, zeta, h);
    if (shown.spectral_radius > std::max(row.growth > 0 ? row.growth : 0, 1 + 1e-9)) {
      row.growth = shown.spectral_radius;
      growing = omega;
    }
    return shown;
  };
  for (ShownMode mode : model.modes) {
    mode.omega_shown = mode.zeta_shown = Fidelity::none;
    if (mode.zeta < 1) {
      const ShownOscillation shown = shown_of(mode.omega, mode.zeta);
      mode.omega_shown = shown.omega;
      mode.zeta_shown = shown.zeta;
    }
    mode.likeness = 1;
    row.modes.push_back(mode);
  }
  if (model.fastest > 0) shown_of(model.fastest, model.fastest_zeta);
  if (growing > 0)
    row.status += fmt::format("; the mode of {} rad/s grows by a factor of {} a step; take a smaller step",
                              short_number(growing, 4), short_number(row.growth, 4));
  return row;
}

ShownDamping shown_damping(const Method& method, const FidelityModel& model, double h,
                           const std::function<void()>& watch) {
  if (method.amplification && (!method.bind || depends_on_past(method, model.problem)))
    return damping_by_formula(method, model, h);
  ShownDamping row{.method = method, .h = h, .modes = {}, .status = {}};
  const VectorFunction step = step_of_model(method, model, model.problem, h);
  const SettledState found = settled_from(step, model.equilibrium, model, share_of_step(model, 1, h), watch);
  if (!found.settled) {
    row.status = unsettled_in_words(found, method, model, h);
    return row;
  }
  StepModes shown = shown_modes(step, found.q, model.sizes, h, model.mass, model.shapes, model.modes, watch);
  row.modes = std::move(shown.modes);
  if (grows(shown)) {
    row.growth = std::abs(shown.largest);
    row.status = fmt::format("{} grows by {} a step; take a smaller step", motion_in_words(shown.largest),
                             growth_in_words(row.growth));
  } else if (!shown.linear) {
    row.status = not_linear;
  } else if (model.modes.empty()) {
    row.status = model.why_no_modes;
  }
  return row;
}

}  // namespace hmax
