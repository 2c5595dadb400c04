#include "limits/fidelity/fidelity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "catalogue/methods/unsuited.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "limits/by_steps/one_step_map.hpp"
#include "limits/fidelity/settled_state.hpp"
#include "limits/modes/mode_start.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

using Eigen::VectorXd;

void say(Fidelity& row, const std::string& sentence) {
  row.status += (row.status.empty() ? "" : "; ") + sentence;
}

double volume_of(const TissueBody& body, const VectorXd& q) {
  const Eigen::Matrix3Xd x = body.positions(0, q);
  double sum = 0;
  for (Eigen::Index t = 0; t < body.mesh().tetrahedron_count(); ++t) {
    const auto corners = body.mesh().tetrahedra.col(t);
    Eigen::Matrix3d edges;
    for (Eigen::Index a = 1; a < 4; ++a) edges.col(a - 1) = x.col(corners[a]) - x.col(corners[0]);
    sum += edges.determinant() / 6;
  }
  return sum;
}

/// f . q_exact of a body whose stiffnesses are `factor` times those of the model.
double exact_work(const FidelityModel& model, double factor) {
  if (factor == 1) return model.load.dot(model.equilibrium);
  const StaticSolution solution =
      found_equilibrium(with_stiffness(model.problem, factor), 1, {}, [] { return 0.0; });
  return solution.converged ? model.load.dot(solution.q) : Fidelity::none;
}

SettledState settle(const Method& method, const FidelityModel& model, double factor,
                    const FidelityQuestion& question) {
  const Problem problem = factor == 1 ? model.problem : with_stiffness(model.problem, factor);
  return settled_state(one_step_map(method, problem, question.h), model.equilibrium / std::max(1.0, factor),
                       question.watch);
}

/// The modulus that is shown where `factor` times that of the model is entered [Pa]; NaN where nothing
/// settles. A stiffness is that of the model under the whole load: small strains where the factor is large.
double modulus_shown(const Method& method, const FidelityModel& model, double factor,
                     const FidelityQuestion& question) {
  const SettledState found = settle(method, model, factor, question);
  if (!found.settled) return Fidelity::none;
  return young_of(model.problem) * factor * exact_work(model, factor) / model.load.dot(found.q);
}

/// Where the modulus shown no longer grows with the modulus entered.
double ceiling_of(const Method& method, const FidelityModel& model, const FidelityQuestion& question) {
  constexpr double stride = 100, most = 1e8;
  double before = modulus_shown(method, model, 1, question);
  for (double factor = stride; factor <= most; factor *= stride) {
    const double shown = modulus_shown(method, model, factor, question);
    if (std::isnan(shown)) return Fidelity::none;
    if (shown <= 0 || before <= 0) return Fidelity::none;
    // Beyond, E_shown = ceiling (1 - c / E): the last of a geometric sequence.
    if (shown < 1.05 * before) return shown + (shown - before) / (stride - 1);
    before = shown;
  }
  // Of exact equations all that is entered.
  return infinity;
}

/// E with which `wanted` is shown, by bisection of its logarithm; NaN where no E does.
double modulus_to_enter(const Method& method, const FidelityModel& model, const FidelityQuestion& question) {
  const double E = young_of(model.problem), wanted = *question.wanted;
  constexpr double stride = 4, most = 1e10;
  // Factors that show too little, and enough.
  double low = 0, high = 0;
  const auto look = [&](double factor) {
    const double shown = modulus_shown(method, model, factor, question);
    // What settles against the load is too soft.
    if (!std::isnan(shown)) (shown < wanted ? low : high) = factor;
    return !std::isnan(shown);
  };
  const double first = wanted / E;
  if (!look(first)) return Fidelity::none;
  for (double factor = first; low > 0 && high == 0;) {
    factor *= stride;
    if (factor > most || !look(factor)) return Fidelity::none;
  }
  for (double factor = first; low == 0;) {  // multipliers that are reset show more than is entered
    factor /= stride;
    if (factor * most < 1 || !look(factor)) return Fidelity::none;
  }
  while (high / low > 1 + 1e-5) {
    const double middle = std::sqrt(low * high);
    if (!look(middle)) return Fidelity::none;
  }
  return std::sqrt(low * high) * E;
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
  const std::complex<double> root = ab[0] / 2 + std::sqrt(std::complex<double>(ab[0] * ab[0] / 4 - ab[1], 0));
  const std::complex<double> rate = std::log(root) / h;
  return {std::abs(rate), -rate.real() / std::abs(rate)};
}

/// Steps of a run at most: a minute for large bodies.
constexpr double most_observed = 5000;

/// omega h and zeta omega h of a mode as it is shown, or of the model where nothing is.
std::pair<double, double> rates_of(const ShownMode& mode, double h) {
  const double omega = std::isnan(mode.omega_shown) ? mode.omega : mode.omega_shown;
  return {omega * h, std::max(0.0, mode.zeta_shown) * omega * h};  // 0 where it is NaN
}

/// What a run from rest shows of the stiffness: to a thousandth of the motion of the slowest mode, then the
/// mean over two of its periods. NaN where it still moves then.
double observed_stiffness(const VectorFunction& step, const FidelityModel& model, const Fidelity& row) {
  const Eigen::Index n = model.load.size();
  const auto [turn, decay] =
      rates_of(row.modes.empty() ? ShownMode{.omega = 0.1 / row.h} : row.modes.front(), row.h);
  const auto settling =
      static_cast<std::int64_t>(decay > 0 ? std::min(most_observed, 7 / decay + 100) : most_observed);
  const auto averaged =
      static_cast<std::int64_t>(std::clamp(4 * std::numbers::pi / turn, 1.0, most_observed));
  VectorXd y = VectorXd::Zero(2 * n), mean = VectorXd::Zero(n);
  for (std::int64_t i = 0; i < settling + averaged; ++i) {
    y = step(y);
    if (!y.allFinite()) return Fidelity::none;
    if (i >= settling) mean += y.head(n) / static_cast<double>(averaged);
  }
  const bool rests = (y.head(n) - mean).norm() <= 0.02 * mean.norm();
  return rests ? model.load.dot(model.equilibrium) / model.load.dot(mean) : Fidelity::none;
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

Fidelity::Observed observe(const VectorFunction& map, const FidelityModel& model, const Fidelity& row,
                           const FidelityQuestion& question, const VectorXd& settled) {
  const auto step = [&](const VectorXd& y) {
    if (question.watch) question.watch();
    return map(y);
  };
  Fidelity::Observed seen{.stiffness_shown = observed_stiffness(step, model, row), .modes = {}};
  for (std::size_t k = 0; k < row.modes.size(); ++k)
    seen.modes.push_back(observed_mode(step, model.problem.body->mass(), settled,
                                       model.shapes.col(static_cast<Eigen::Index>(k)), row.modes[k], row.h));
  return seen;
}

/// The largest relative difference; of damping ratios the difference itself.
double gap_of(const Fidelity& row) {
  double gap = std::abs(row.observed->stiffness_shown / row.stiffness_shown - 1);
  for (std::size_t k = 0; k < row.observed->modes.size(); ++k)
    if (const ShownMode& seen = row.observed->modes[k];
        !std::isnan(seen.omega_shown) && !std::isnan(row.modes[k].omega_shown))
      gap = std::max({gap, std::abs(seen.omega_shown / row.modes[k].omega_shown - 1),
                      std::abs(seen.zeta_shown - row.modes[k].zeta_shown)});
  return gap;
}

}  // namespace

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
  return with_settings(problem, std::move(settings));
}

FidelityModel fidelity_model(const Problem& problem, std::size_t modes) {
  if (!problem.body)
    throw InputError(fmt::format("{} is no body, and its stiffness is no material's; take a mesh with --mesh",
                                 problem.id));
  if (std::isinf(equilibrium_time(*problem.body)) ||
      (equilibrium_time(*problem.body) == 0 && !problem.body->is_autonomous()))
    throw InputError(
        "the load changes with time and never settles, so that nothing comes to rest; take gravity or press");
  if (!problem.body->settings().tools.empty())
    throw InputError(
        "the force of a tool depends on the body where a tool meets it, and measures no stiffness; take gravity or press");
  FidelityModel model{
      .problem = after_ramps(problem), .load = {}, .equilibrium = {}, .modes = {}, .shapes = {}};
  const TissueBody& body = *model.problem.body;
  const VectorXd still = VectorXd::Zero(body.dofs());
  model.load.resize(body.dofs());
  body.force(0, still, still, model.load);
  if (is_at_rest(body))
    throw InputError("nothing loads the body, so that no sag shows its stiffness; take a load with --load");
  const StaticSolution solution = found_equilibrium(model.problem, 1, {}, [] { return 0.0; });
  if (!solution.converged)
    throw InputError("no static equilibrium to compare with: " + status_of(model.problem, solution));
  model.equilibrium = solution.q;
  model.volume = volume_of(body, solution.q);

  VectorXd y = VectorXd::Zero(body.dim());
  y.head(body.dofs()) = solution.q;
  const Linearised near = linearised(model.problem, 0, y);
  std::vector<MechanicalMode> slow = near.modes.spectrum.mechanical;
  std::erase_if(slow, [](const MechanicalMode& each) { return !(each.kappa > 0); });
  std::ranges::sort(slow, {}, &MechanicalMode::kappa);
  // Of large bodies the ends are known alone.
  slow.resize(std::min({slow.size(), modes, near.modes.curve ? std::size_t{1} : modes}));
  if (near.modes.range || !near.point.model.mechanical) slow.clear();
  model.shapes.resize(body.dofs(), static_cast<Eigen::Index>(slow.size()));
  for (std::size_t k = 0; k < slow.size(); ++k) {
    const Mode mode = mode_of(slow[k]);
    model.modes.push_back({.omega = mode.omega.value_or(0), .zeta = mode.zeta.value_or(0)});
    model.shapes.col(static_cast<Eigen::Index>(k)) = shape_of_mode(near, slow[k]);
  }
  return model;
}

Fidelity fidelity(const Method& method, const FidelityModel& model, const FidelityQuestion& question) {
  if (const std::string why = why_unsuited(method, model.problem); !why.empty())
    throw InputError(fmt::format("{} {}", method.id, why));
  Fidelity row{.method = method, .h = question.h, .modes = {}, .status = {}};
  const VectorFunction step = one_step_map(method, model.problem, question.h);
  const SettledState found = settle(method, model, 1, question);
  row.steps = found.steps;
  if (!found.settled) {
    say(row, std::isfinite(found.residual)
                 ? fmt::format("its steps do not settle: {} of them leave a residual of {:.1e}", found.steps,
                               found.residual)
                 : "its steps leave the range of numbers");
    return row;
  }
  row.stiffness_shown = model.load.dot(model.equilibrium) / model.load.dot(found.q);
  row.volume_kept = volume_of(*model.problem.body, found.q) / model.volume;
  StepModes shown = shown_modes(step, found.q, question.h, model.problem.body->mass(), model.shapes,
                                model.modes, question.watch);
  // Beyond what differences resolve.
  if (shown.largest > 1 + 1e-5) {
    say(row,
        fmt::format("its steps grow by a factor of {} each, so that nothing settles; take a smaller step",
                    short_number(shown.largest, 4)));
    row.stiffness_shown = row.volume_kept = Fidelity::none;
    return row;
  }
  if (!shown.linear)
    say(row,
        "its iterations are not linear in the state, so that no eigenvalue tells what they make of a mode; "
        "runs do");
  row.modes = std::move(shown.modes);
  if (row.stiffness_shown < 0) say(row, "it settles against the load");
  if (question.ceiling || question.wanted) row.stiffness_ceiling = ceiling_of(method, model, question);
  if (question.wanted) {
    row.modulus_to_enter = modulus_to_enter(method, model, question);
    if (std::isnan(row.modulus_to_enter))
      say(row, std::isfinite(row.stiffness_ceiling)
                   ? fmt::format("it shows at most {} Pa, however stiff the material that is entered",
                                 short_number(row.stiffness_ceiling, 4))
                   : "no modulus was found that it shows as the one wanted");
  }
  if (question.verify) {
    row.observed = observe(step, model, row, question, found.q);
    row.gap = gap_of(row);
    if (std::isnan(row.observed->stiffness_shown))
      say(row, fmt::format("a run from rest still moves after {} steps", most_observed));
  }
  return row;
}

}  // namespace hmax
