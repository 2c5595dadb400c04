#include "limits/fidelity/fidelity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "analysis/amplification/numerical_damping.hpp"
#include "analysis/dynamics/growth.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/text/sentences.hpp"
#include "limits/by_steps/one_step_map.hpp"
#include "limits/fidelity/settled_state.hpp"
#include "limits/fidelity/steps_stiffness.hpp"
#include "limits/modes/mode_start.hpp"
#include "problems/mesh/ten_node.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

using Eigen::VectorXd;

double volume_of(const TissueBody& body, const VectorXd& q) {
  TetMesh moved = body.mesh();
  moved.points = body.positions(0, q);
  double sum = 0;
  for (Eigen::Index e = 0; e < moved.element_count(); ++e) sum += element_volume(moved, e);
  return sum;
}

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
  TissueSettings settings = problem.body->settings();
  settings.gravity.setZero();
  settings.forces.clear();
  return with_settings(problem, std::move(settings));
}

/// Where the steps come to rest with the load and without.
struct Settled {
  SettledState loaded;
  SettledState rest;
  [[nodiscard]] bool found() const { return loaded.settled && rest.settled; }
  [[nodiscard]] double sag(const FidelityModel& model) const { return model.load.dot(loaded.q - rest.q); }
};

/// Where steps of a body that nothing loads come to rest: where it is, but for methods that move it.
/// @param size  of displacements that count, as a norm [m]
SettledState settled_without_load(const VectorFunction& step, Eigen::Index n, double size, double share,
                                  const std::function<void()>& watch) {
  const VectorXd moved = step(VectorXd::Zero(2 * n)).head(n);
  // Rounding moves it, and the tolerance of equations.
  if (moved.norm() <= 1e-6 * share * size) return {.q = VectorXd::Zero(n), .settled = true};
  return settled_state(step, moved, share, watch, size);
}

Settled settle(const Method& method, const FidelityModel& model, double factor,
               const FidelityQuestion& question) {
  const Problem problem = stiffened(model, factor);
  const double share = share_of_step(model, factor, question.h);
  const VectorXd start = model.equilibrium / std::max(1.0, factor);
  Settled found;
  found.loaded = settled_state(one_step_map(method, problem, question.h), start, share, question.watch);
  if (!found.loaded.settled) return found;
  found.rest = settled_without_load(one_step_map(method, without_load(problem), question.h), start.size(),
                                    start.norm(), share, question.watch);
  return found;
}

StepModes modes_of(const Method& method, const FidelityModel& model, double factor,
                   const FidelityQuestion& question, const VectorXd& q) {
  const Problem problem = stiffened(model, factor);
  const bool compares = factor == 1;  // of other stiffnesses growth alone is asked
  return shown_modes(one_step_map(method, problem, question.h), q, q, question.h, problem.body->mass(),
                     compares ? model.shapes : Eigen::MatrixXd(q.size(), 0),
                     compares ? model.modes : std::vector<ShownMode>{}, question.watch);
}

/// Growth beyond what differences resolve.
bool grows(const StepModes& modes) { return std::abs(modes.largest) > 1 + 1e-5; }

std::string unsettled_in_words(const SettledState& found) {
  return !std::isfinite(found.residual)
             ? "its steps leave the range of numbers"
             : fmt::format(
                   "its steps do not settle near the equilibrium of the model: {} of them leave a "
                   "residual of {:.1e}",
                   found.steps, found.residual);
}

/// "a factor of 1.4", "0.003 %".
std::string growth_in_words(double modulus) {
  return modulus < 1.1 ? short_number(100 * (modulus - 1), 3) + " %"
                       : "a factor of " + short_number(modulus, 4);
}

constexpr std::string_view not_linear =
    "its iterations are not linear in the state, so that no eigenvalue tells what they make of a mode";
constexpr std::string_view unknown_modes =
    "of so many modes the slow ones are not known, and none is compared";

/// The modulus that is shown where `factor` times that of the model is entered [Pa]; NaN where nothing
/// settles, or against the load.
double modulus_shown(const Method& method, const FidelityModel& model, double factor,
                     const FidelityQuestion& question) {
  const Settled found = settle(method, model, factor, question);
  if (!found.found() || grows(modes_of(method, model, factor, question, found.loaded.q)))
    return Fidelity::none;
  const double sag = found.sag(model);
  return sag > 0 ? young_of(model.problem) * factor_of_sag(model, sag) : Fidelity::none;
}

/// E with which the steps sag as the model does with the wanted one, by bisection of its logarithm; NaN where
/// no E does.
double modulus_to_enter(const Method& method, const FidelityModel& model, const FidelityQuestion& question) {
  const double E = young_of(model.problem), first = *question.wanted / E;
  const double wanted = exact_sag(model, first);
  if (!(wanted > 0)) return Fidelity::none;
  constexpr double stride = 4, most = 1e10;
  // Factors that sag too much, and little enough.
  double low = 0, high = 0;
  const auto look = [&](double factor) {
    const Settled found = settle(method, model, factor, question);
    if (!found.found() || !(found.sag(model) > 0)) return false;
    (found.sag(model) > wanted ? low : high) = factor;
    return true;
  };
  if (!look(first)) return Fidelity::none;
  for (double factor = first; low > 0 && high == 0;) {
    factor *= stride;
    if (factor > most || !look(factor)) return Fidelity::none;
  }
  for (double factor = first; low == 0;) {  // multipliers that are reset show more than is entered
    factor /= stride;
    if (factor * most < 1 || !look(factor)) return Fidelity::none;
  }
  while (high / low > 1 + 1e-5)
    if (!look(std::sqrt(low * high))) return Fidelity::none;
  const double factor = std::sqrt(low * high);
  const Settled found = settle(method, model, factor, question);
  if (!found.found() || grows(modes_of(method, model, factor, question, found.loaded.q)))
    return Fidelity::none;
  return factor * E;
}

/// Frequency and damping ratio of a decaying sequence of one oscillation, from a fit of
/// x_(k+1) = a x_k - b x_(k-1) over all of it: roots of z^2 - a z + b.
std::pair<double, double> oscillation_in(const std::vector<double>& x, double h) {
  Eigen::MatrixXd past(static_cast<Eigen::Index>(x.size()) - 2, 2);
  VectorXd next(past.rows());
  for (Eigen::Index k = 0; k < past.rows(); ++k) {
    past.row(k) << x[static_cast<std::size_t>(k) + 1], -x[static_cast<std::size_t>(k)];
    next[k] = x[static_cast<std::size_t>(k) + 2];
  }
  const VectorXd ab = past.colPivHouseholderQr().solve(next);
  const std::complex<double> half = std::sqrt(std::complex<double>(ab[0] * ab[0] / 4 - ab[1], 0));
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
  const auto [turn, decay] =
      rates_of(row.modes.empty() ? ShownMode{.omega = 0.1 / row.h} : row.modes.front(), row.h);
  const auto settling =
      static_cast<std::int64_t>(decay > 0 ? std::min(most_observed, 7 / decay + 100) : most_observed);
  const auto averaged =
      static_cast<std::int64_t>(std::clamp(4 * std::numbers::pi / turn, 1.0, most_observed));
  constexpr double still = 1e-10;
  VectorXd y = VectorXd::Zero(2 * n), mean = VectorXd::Zero(n);
  for (std::int64_t i = 0; i < settling + averaged; ++i) {
    const VectorXd next = step(y);
    if (!next.allFinite()) return {};
    if ((next - y).head(n).norm() <= still * next.head(n).norm()) return next.head(n);
    y = next;
    if (i >= settling) mean += y.head(n) / static_cast<double>(averaged);
  }
  return (y.head(n) - mean).norm() <= 0.02 * mean.norm() ? mean : VectorXd();
}

/// A mode as a run from its shape about the settled state shows it: two periods, after half of one in which
/// what the step does not continue dies away. NaN where it decays within a few steps.
ShownMode observed_mode(const VectorFunction& step, const VectorXd& mass, const VectorXd& settled,
                        const VectorXd& shape, ShownMode mode, double h) {
  constexpr double least_steps = 12, least_left = 1e-3;
  const auto [turn, decay] = rates_of(mode, h);
  const double visible = decay > 0 ? -std::log(least_left) / decay : most_observed;
  const double wanted = std::min({5 * std::numbers::pi / turn, visible, most_observed});
  mode.omega_shown = mode.zeta_shown = Fidelity::none;
  if (wanted < least_steps) return mode;
  const Eigen::Index n = settled.size();
  VectorXd y = VectorXd::Zero(2 * n);
  y.head(n) = settled + 1e-3 * std::sqrt(settled.dot(mass.cwiseProduct(settled))) * shape;
  std::vector<double> amplitude;
  const auto steps = static_cast<std::int64_t>(wanted);
  for (std::int64_t i = 0; i <= steps; ++i, y = step(y))
    if (i >= steps / 5) amplitude.push_back(shape.dot(mass.cwiseProduct(y.head(n) - settled)));
  std::tie(mode.omega_shown, mode.zeta_shown) = oscillation_in(amplitude, h);
  return mode;
}

Fidelity::Observed observe(const FidelityModel& model, const Fidelity& row, const FidelityQuestion& question,
                           const Settled& settled) {
  const auto watched = [&](const Problem& problem) -> VectorFunction {
    return [map = one_step_map(row.method, problem, row.h), &question](const VectorXd& y) {
      if (question.watch) question.watch();
      return map(y);
    };
  };
  const VectorFunction step = watched(model.problem);
  const Eigen::Index n = model.load.size();
  Fidelity::Observed seen;
  const VectorXd loaded = observed_rest(step, n, row);
  const VectorXd rest =
      settled.rest.q.isZero(0) ? settled.rest.q : observed_rest(watched(without_load(model.problem)), n, row);
  if (loaded.size() > 0 && rest.size() > 0)
    seen.stiffness_shown = model.load.dot(model.equilibrium) / model.load.dot(loaded - rest);
  for (std::size_t k = 0; k < row.modes.size(); ++k)
    seen.modes.push_back(observed_mode(step, model.problem.body->mass(), settled.loaded.q,
                                       model.shapes.col(static_cast<Eigen::Index>(k)), row.modes[k], row.h));
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

/// Ceiling and modulus to enter.
void find_moduli(Fidelity& row, const FidelityModel& model, const FidelityQuestion& question) {
  row.stiffness_ceiling = stiffness_ceiling(row.method, model, question, row.stiffness_shown);
  if (std::isnan(row.stiffness_ceiling) && model.problem.body->settings().elastic_supports.empty())
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

/// The slowest modes of the undamped body near `y`, with what its damping makes of each alone, x^T C x = 2
/// zeta omega: beta K at rest couples them a little where the body is deformed.
void add_modes(FidelityModel& model, const VectorXd& y, std::size_t modes) {
  TissueSettings settings = model.problem.body->settings();
  settings.alpha = settings.beta = settings.springs.damper = settings.springs.damper_time = 0;
  const Linearised near = linearised(with_settings(model.problem, std::move(settings)), 0, y);
  std::vector<MechanicalMode> slow = near.modes.spectrum.mechanical;
  std::erase_if(slow, [](const MechanicalMode& each) { return !(each.kappa > 0); });
  std::ranges::sort(slow, {}, &MechanicalMode::kappa);
  if (near.modes.range || !near.point.model.mechanical) slow.clear();
  const TissueBody& body = *model.problem.body;
  const Eigen::Index n = body.dofs();
  TissueBody::DofMatrix C;
  body.damping(0, y.head(n), VectorXd::Zero(n), C);
  const auto damped = [&](const MechanicalMode& mode, const VectorXd& x) {
    const double omega = std::sqrt(mode.kappa);
    return ShownMode{.omega = omega, .zeta = x.dot(C * x) / (2 * omega)};
  };
  if (!slow.empty()) {
    const ShownMode fastest = damped(slow.back(), shape_of_mode(near, slow.back()));
    model.fastest = fastest.omega;
    model.fastest_zeta = std::min(fastest.zeta, 0.999);
  }
  // Of large bodies the ends are known alone.
  slow.resize(std::min({slow.size(), modes, near.modes.curve ? std::size_t{1} : modes}));
  model.shapes.resize(n, static_cast<Eigen::Index>(slow.size()));
  for (std::size_t k = 0; k < slow.size(); ++k) {
    const VectorXd x = shape_of_mode(near, slow[k]);
    model.modes.push_back(damped(slow[k], x));
    model.shapes.col(static_cast<Eigen::Index>(k)) = x;
  }
}

}  // namespace

std::vector<Method> methods_of_simulators(const Problem& problem) {
  std::vector<Method> methods;
  for (const char* name : {"symplectic_euler", "symplectic_euler:substeps=10", "implicit_euler",
                           "newton_truncated", "projective_dynamics", "vbd", "vbd:iterations=1,substeps=10",
                           "xpbd", "xpbd:iterations=1,substeps=10", "pbd"})
    if (Method method = find_method(name); suits(method, problem)) methods.push_back(std::move(method));
  return methods;
}

double young_of(const Problem& problem) { return problem.body->settings().materials.front().young; }

Problem with_stiffness(const Problem& problem, double factor) {
  TissueSettings settings = problem.body->settings();
  for (TissueMaterial& material : settings.materials) {
    material.young *= factor;
    material.fibre_young *= factor;
  }
  settings.springs.stiffness *= factor;
  settings.skin.young *= factor;
  // Damping is that of the material: beta K would grow with it.
  settings.beta /= factor;
  settings.springs.damper_time /= factor;
  return with_settings(problem, std::move(settings));
}

FidelityModel settled_model(const Problem& problem, const std::function<void()>& watch, std::size_t modes) {
  if (std::isinf(equilibrium_time(*problem.body)) ||
      (equilibrium_time(*problem.body) == 0 && !problem.body->is_autonomous()))
    throw InputError(
        "the load changes with time and never settles, so that nothing comes to rest; take gravity or press");
  FidelityModel model{
      .problem = after_ramps(problem), .load = {}, .equilibrium = {}, .modes = {}, .shapes = {}};
  const TissueBody& body = *model.problem.body;
  model.equilibrium = VectorXd::Zero(body.dofs());
  model.load.resize(body.dofs());
  body.force(0, model.equilibrium, model.equilibrium, model.load);
  if (!is_at_rest(body)) {
    StaticSettings settings;
    if (watch) settings.seen = [&](const StaticIterate&) { watch(); };
    const StaticSolution solution = found_equilibrium(model.problem, 1, settings, [] { return 0.0; });
    if (!solution.converged)
      throw InputError("no static equilibrium to compare with: " + status_of(model.problem, solution));
    model.equilibrium = solution.q;
  }
  model.volume = volume_of(body, model.equilibrium);

  VectorXd y = VectorXd::Zero(body.dim());
  y.head(body.dofs()) = model.equilibrium;
  add_modes(model, y, modes);
  return model;
}

FidelityModel fidelity_model(const Problem& problem, const std::function<void()>& watch, std::size_t modes) {
  if (!problem.body)
    throw InputError(fmt::format("{} is no body, and its stiffness is no material's; take a mesh with --mesh",
                                 problem.id));
  if (!problem.body->settings().tools.empty())
    throw InputError(
        "the force of a tool depends on the body where a tool meets it, and measures no stiffness; take gravity or press");
  FidelityModel model = settled_model(problem, watch, modes);
  if (model.equilibrium.isZero(0))
    throw InputError("nothing loads the body, so that no sag shows its stiffness; take a load with --load");
  return model;
}

double stiffness_ceiling(const Method& method, const FidelityModel& model, const FidelityQuestion& question,
                         double stiffness_shown) {
  // Springs as supports stay, and sag under the stiffest body; k is no modulus.
  const TissueSettings& settings = model.problem.body->settings();
  if (!settings.elastic_supports.empty() || settings.springs.stiffness > 0) return Fidelity::none;
  const double E = young_of(model.problem);
  const auto shown = [&](double factor) {
    return factor == 1 ? stiffness_shown : modulus_shown(method, model, factor, question) / E;
  };
  return E * stiffness_ceiling(shown, 1e8);
}

Fidelity fidelity(const Method& method, const FidelityModel& model, const FidelityQuestion& question) {
  const bool asks_moduli = question.ceiling || question.wanted;
  if (asks_moduli && model.problem.body->settings().springs.stiffness > 0)
    throw InputError(
        "k gives the springs their stiffness whatever the modulus is; leave k out, or --ceiling and --enter");
  Fidelity row{.method = method, .h = question.h, .modes = {}, .status = {}};
  const Settled found = settle(method, model, 1, question);
  row.steps = found.loaded.steps;
  if (!found.found()) {
    add_sentence(row.status, found.loaded.settled ? "without load " + unsettled_in_words(found.rest)
                                                  : unsettled_in_words(found.loaded));
    return row;
  }
  StepModes shown = modes_of(method, model, 1, question, found.loaded.q);
  if (grows(shown)) {
    add_sentence(
        row.status,
        fmt::format("about its settled state its steps grow by {} each, so that it does not stay there",
                    growth_in_words(std::abs(shown.largest))));
    return row;
  }
  row.stiffness_shown = model.load.dot(model.equilibrium) / found.sag(model);
  row.volume_kept = volume_of(*model.problem.body, found.loaded.q) / model.volume;
  row.settled_error =
      largest_displacement(found.loaded.q - model.equilibrium) / largest_displacement(model.equilibrium);
  row.rest_moves = largest_displacement(found.rest.q);
  row.momentum = momentum_made(method, model.problem, model.equilibrium, question.h);
  row.modes = std::move(shown.modes);
  if (row.stiffness_shown < 0) add_sentence(row.status, "it settles against the load");
  if (row.rest_moves > 0.01 * largest_displacement(model.equilibrium))
    add_sentence(row.status, fmt::format("without load it moves {} mm from rest",
                                         short_number(1000 * row.rest_moves, 3)));
  if (const double made = std::max(row.momentum.linear, row.momentum.angular); made > 0.05)
    add_sentence(row.status, fmt::format("its inner forces alone make {} % of momentum in a step",
                                         short_number(100 * made, 2)));
  if (!shown.linear)
    add_sentence(row.status, fmt::format("{}; runs do", not_linear));
  else if (row.modes.empty())
    add_sentence(row.status, std::string(unknown_modes));
  else if (std::isnan(row.modes.front().omega_shown))
    add_sentence(row.status, "no eigenvalue of its steps is like the slowest mode");
  if (asks_moduli) find_moduli(row, model, question);
  if (question.verify) {
    row.observed = observe(model, row, question, found);
    row.gap = gap_of(row);
    row.contradiction = row.gap > 0.05;
    if (std::isnan(row.observed->stiffness_shown))
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
  const VectorFunction step = one_step_map(method, model.problem, h);
  const TissueBody& body = *model.problem.body;
  const double share = share_of_step(model, 1, h);
  const Eigen::Index n = body.dofs();
  VectorXd sizes = model.equilibrium;
  SettledState found;
  if (!sizes.isZero(0)) {
    found = settled_state(step, model.equilibrium, share, watch);
  } else {
    const auto& points = body.mesh().points;
    sizes.setConstant(0.01 * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm());
    found = settled_without_load(step, n, sizes.norm(), share, watch);
  }
  if (!found.settled) {
    row.status = unsettled_in_words(found);
    return row;
  }
  StepModes shown = shown_modes(step, found.q, sizes, h, body.mass(), model.shapes, model.modes, watch);
  row.modes = std::move(shown.modes);
  if (grows(shown)) {
    row.growth = std::abs(shown.largest);
    row.status = fmt::format("{} grows by {} a step; take a smaller step", motion_in_words(shown.largest),
                             growth_in_words(row.growth));
  } else if (!shown.linear) {
    row.status = not_linear;
  } else if (model.modes.empty()) {
    row.status = unknown_modes;
  }
  return row;
}

}  // namespace hmax
