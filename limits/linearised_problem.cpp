#include "limits/linearised_problem.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "analysis/spectrum/entry_rounding.hpp"
#include "analysis/statics/equilibrium.hpp"
#include "catalogue/methods/method.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/model.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "core/size_limits.hpp"
#include "core/text/sentences.hpp"
#include "limits/kinks.hpp"
#include "limits/modes/mode_curve.hpp"
#include "limits/modes/mode_range.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// A state in words, if it is short.
std::string words_of(const Eigen::VectorXd& y) {
  if (y.size() > 4) return fmt::format("of {} numbers", y.size());
  std::string text;
  for (const double value : y) text += (text.empty() ? "" : ", ") + fmt::format("{:.6g}", value);
  return "(" + text + ")";
}

/// @throws InputError  where squares of eigenvalues, which stiffness is, leave the range of numbers
void require_usual_rates(const Spectrum& spectrum) {
  constexpr double most = 1e140;
  for (const Complex lambda : spectrum.lambda)
    if (!(std::abs(lambda) <= most))
      throw input_error(
          "the model has an eigenvalue {}, and beyond {:.0e} 1/s the products of rates leave "
          "the range of numbers; give masses, stiffness and damping in units of one size",
          std::isfinite(std::abs(lambda)) ? fmt::format("of {:.3g} 1/s", std::abs(lambda)) : "without a size",
          most);
}

/// @throws InputError  where eigenvalues would be those of an M^-1 K that is full and too large
void require_writable_jacobian(const LinearModel& model) {
  if (!model.mechanical || model.mechanical->symmetric) return;
  const MassMatrix<double>& M = model.mechanical->mass;
  if (M.is_diagonal() || M.size() <= most_coupled_masses) return;
  throw input_error(
      "the matrices are not symmetric, and the mass couples {} unknowns, of which limits are known up to {}; lump the mass, "
      "which changes the limit, or see with a run whether a step holds",
      M.size(), most_coupled_masses);
}

}  // namespace

LinearModel linear_model(const Problem& problem, double t, const Eigen::VectorXd& y) {
  return std::visit(
      [&]<class Sys>(const Sys& system) { return linearise(system, t, typename Sys::State(y)); },
      problem.system);
}

void ask(OperatingPoint& point, const Problem& problem) {
  std::visit(
      [&]<class Sys>(const Sys& system) {
        point.model_at = [system, t = point.model.t](const Eigen::VectorXd& y) {
          return linearise(system, t, typename Sys::State(y));
        };
        point.radius_bound = nullptr;
        if constexpr (BoundedSpectrumSystem<Sys>)
          if (has_spectral_radius(system))
            point.radius_bound = [system, t = point.model.t, y = point.model.y] {
              return system.spectral_radius(t, y);
            };
      },
      problem.system);
}

OperatingPoint operating_point(const Problem& problem, double t, const Eigen::VectorXd& y) {
  OperatingPoint point{.problem = problem.id,
                       .material = problem.material,
                       .parameters = problem.parameters,
                       .is_body = problem.kind() == ModelKind::body,
                       .model = linear_model(problem, t, y),
                       .linearity = linearity_of(problem)};
  ask(point, problem);
  point.state = fmt::format("{} at t = {} s, Jacobian {}", words_of(problem.shown.state(y)),
                            to_text(problem.shown.time(t)), name_of(point.model.origin));
  return point;
}

namespace {
/// What is known of the negative stiffnesses of K by its few digits: the undamped modes, and of each what
/// rounding may change its stiffness by.
class RoundedStiffness {
 public:
  RoundedStiffness(const MechanicalPart& part, double rounding) : part_(part), rounding_(rounding) {}

  /// Whether the negative stiffness nearest to kappa may be that of a rigid-body mode.
  [[nodiscard]] bool may_be_rigid(double kappa) {
    const std::vector<MechanicalMode>& modes = shapes().modes;
    const auto nearest = std::ranges::min_element(
        modes, {}, [&](const MechanicalMode& mode) { return std::abs(mode.kappa - kappa); });
    return is_rigid(nearest - modes.begin());
  }
  [[nodiscard]] bool may_all_be_rigid() {
    for (std::size_t i = 0; i < shapes().modes.size(); ++i)
      if (!is_rigid(static_cast<Eigen::Index>(i))) return false;
    return true;
  }

 private:
  [[nodiscard]] bool is_rigid(Eigen::Index i) {
    const double kappa = shapes().modes[static_cast<std::size_t>(i)].kappa;
    return kappa >= 0 || -kappa <= rounding_of_form(part_.K, rounding_, shapes().shapes.col(i));
  }
  [[nodiscard]] const MechanicalModes& shapes() {
    if (!shapes_) {
      MechanicalPart undamped = part_;
      undamped.damping = Damping::none;
      std::visit([](auto& C) { C.setZero(); }, undamped.C);
      shapes_ = mechanical_modes(undamped, true);
    }
    return *shapes_;
  }

  const MechanicalPart& part_;
  double rounding_;
  std::optional<MechanicalModes> shapes_;  ///< made when they are needed first
};

/// Of K of a user, whose decimals may be few: negative stiffnesses within their rounding are rigid-body
/// modes. Of models whose shapes are not at hand the share of the largest stiffness decides.
void round_negative_stiffness(const LinearModel& model, ModeSet& modes) {
  const double rounding = rounding_of_stiffness(model);
  if (rounding == 0 || modes.range) return;
  RoundedStiffness known(*model.mechanical, rounding);
  const bool has_shapes = !modes.curve && model.mechanical->mass.size() <= most_dense_modes;
  auto& oscillations = modes.spectrum.mechanical;
  double largest = 0;
  for (const MechanicalMode& mode : oscillations) largest = std::max(largest, mode.kappa);
  const auto is_rounding = [&](double kappa) {
    if (has_shapes) return kappa < 0 && known.may_be_rigid(kappa);
    if (!(kappa < 0 && -kappa <= rounding * largest)) return false;
    modes.rounded = std::max(modes.rounded, -kappa / largest);
    return true;
  };
  for (std::size_t i = 0; i < oscillations.size(); ++i) {
    if (!is_rounding(oscillations[i].kappa)) continue;
    oscillations[i].kappa = 0;
    std::ranges::copy(eigenvalues_of(oscillations[i]),
                      modes.spectrum.lambda.begin() + 2 * static_cast<std::ptrdiff_t>(i));
  }
  if (modes.curve && is_rounding(modes.curve->kappa_min)) modes.curve->kappa_min = 0;
  if (!oscillations.empty()) return;
  // Where damping couples the modes: what grows as no more than such a stiffness makes it.
  double radius = 0;
  for (const Complex lambda : modes.spectrum.lambda) radius = std::max(radius, std::norm(lambda));
  for (Complex& lambda : modes.spectrum.lambda) {
    if (!(lambda.real() > 0 && lambda.imag() == 0 && std::norm(lambda) <= rounding * radius)) continue;
    if (has_shapes && !known.may_all_be_rigid()) return;
    if (!has_shapes) modes.rounded = std::max(modes.rounded, std::norm(lambda) / radius);
    lambda = 0;
  }
}

/// Says in the status of a point that a negative stiffness counts as 0.
void tell_rounded(Linearised& near) {
  if (near.modes.rounded == 0) return;
  const std::string words = fmt::format(
      "a negative stiffness of {:.2g} of the largest counts as 0, because the digits of K may have made it; write K "
      "with more digits if it is one",
      near.modes.rounded);
  near.point.state += "; " + words;
  add_sentence(near.point.status, words);
}
}  // namespace

double rounding_of_stiffness(const LinearModel& model) {
  return model.mechanical && model.mechanical->symmetric ? entry_rounding(model.mechanical->K) : 0;
}

ModeSet mode_set(const LinearModel& model, bool is_body) {
  ModeSet modes;
  if (!set_curve(model, modes, most_dense_modes, is_body) &&
      !set_range(model, modes, most_dense_coupled, is_body)) {
    require_writable_jacobian(model);
    if (!set_largest(model, modes)) modes.spectrum = spectrum_of(model);
  }
  if (!is_body) round_negative_stiffness(model, modes);
  require_usual_rates(modes.spectrum);
  return modes;
}

Linearised linearised(const Problem& problem, double t, const Eigen::VectorXd& y) {
  Linearised near{.point = operating_point(problem, t, y)};
  near.modes = mode_set(near.point.model, near.point.is_body);
  tell_rounded(near);
  return near;
}

bool factors_take_seconds(const Problem& problem) {
  return problem.body && problem.body->dofs() > most_cheaply_factored;
}

bool is_at_rest(const TissueBody& body) {
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(body.dofs());
  Eigen::VectorXd f = rest;
  TissueBody::DofMatrix K;
  const double t = equilibrium_time(body);
  body.force(t, rest, rest, f);
  body.stiffness(t, rest, rest, K);
  const double rounding =
      1e-13 * K.diagonal().cwiseAbs().maxCoeff() * body.mesh().points.cwiseAbs().maxCoeff();
  return f.cwiseAbs().maxCoeff() <= rounding;
}

namespace {
/// Says where the contact of a tool is not in a linear model.
void look_at_contact(OperatingPoint& point, const TissueBody& body) {
  if (std::ranges::any_of(body.tool_reaches(point.model.t, point.model.y),
                          [](const auto& reach) { return reach.penetration == 0; }))
    point.missing =
        "the tool does not touch the body in this state: its contact is not in the limit, which may be smaller";
}

/// Says where fibres neither pull nor buckle yet. Motion about such a state changes the stiffness in every
/// oscillation, which can amplify it below the limit of taut fibres (docs/reference/tissue.md).
void look_at_fibres(OperatingPoint& point, const TissueBody& body) {
  if (body.settings().model.is_linear) return;
  const bool has_fibres = std::ranges::any_of(
      body.settings().materials, [](double E) { return E > 0; }, &TissueMaterial::fibre_young);
  if (has_fibres && point.model.y.head(body.dofs()).isZero(0))
    point.state +=
        "; fibres buckle from here on, and h_max takes all as taut: stable steps may be smaller, see --verify";
}

/// @throws InputError  where the rates of the initial state are no numbers: matrices that are say nothing
/// then
void require_rates(const Problem& problem) {
  if (!rhs_of(problem, 0, problem.y0).allFinite())
    throw input_error(
        "the rates of {} in its initial state are not finite; give another state, or correct the model",
        problem.id);
}

/// Whether more than supports that start at once, which drag at their neighbours, acts on a body at rest at
/// time 0.
bool is_loaded_at_once(const TissueBody& body) {
  const TissueSettings& settings = body.settings();
  const auto moved = [](const Support& support) {
    return !support.travel.isZero(0) && support.profile.value(0) != 0;
  };
  const auto pressed = [](const PressingForce& load) {
    return !load.force.isZero(0) && load.profile.value(0) != 0;
  };
  const auto touched = [](const auto& reach) { return reach.penetration > 0; };
  return !settings.gravity.isZero(0) || std::ranges::any_of(settings.supports, moved) ||
         std::ranges::any_of(settings.forces, pressed) ||
         std::ranges::any_of(body.tool_reaches(0, Eigen::VectorXd::Zero(body.dim())), touched);
}

/// Under a load the equilibrium of a body is found with its stiffness, half as many unknowns.
EquilibriumSearch equilibrium_of_body(const Problem& problem, const EquilibriumWatcher& watcher) {
  const TissueBody& body = *problem.body;
  EquilibriumSearch search;
  search.outcome = EquilibriumOutcome::found;
  search.state = problem.y0;
  if (body.steady_from() != equilibrium_time(body)) {
    if (is_at_rest(body) || !is_loaded_at_once(body)) return search;
    search.outcome = EquilibriumOutcome::no_equilibrium;
    search.message =
        "no equilibrium was looked for: a load never settles, and others act on the body at rest";
    return search;
  }
  // A tool at the end of its path may stand within a body that does not move, and touch nothing of it.
  if (body.is_autonomous() && is_at_rest(body)) return search;
  StaticSettings settings{.tolerance = 1e-12};
  if (factors_take_seconds(problem)) settings.inner = InnerSolver::conjugate_gradients;
  if (watcher) settings.seen = [&](const StaticIterate& iterate) { watcher(iterate.residual); };
  const StaticSolution solution = found_equilibrium(problem, 1, settings, [] { return 0.0; });
  // One that is not stable tells that the body buckles.
  if (!solution.converged && !solution.unstable) {
    search.outcome = EquilibriumOutcome::no_equilibrium;
    search.message = fmt::format("no equilibrium was found: {}", cause_of(problem, solution));
    return search;
  }
  search.state.head(body.dofs()) = solution.q;
  return search;
}

EquilibriumSearch equilibrium_of(const Problem& problem, const EquilibriumWatcher& watcher) {
  if (problem.body) return equilibrium_of_body(problem, watcher);
  return std::visit(
      [&]<class Sys>(const Sys& system) {
        return find_equilibrium(system, 0, typename Sys::State(problem.y0));
      },
      problem.system);
}
}  // namespace

namespace {
/// Matrices are the same in every state; zero is an equilibrium.
OperatingPoint point_of_matrices(const Problem& problem) {
  OperatingPoint point = operating_point(problem, 0, Eigen::VectorXd::Zero(problem.y0.size()));
  point.kind = StateKind::matrices;
  point.at_equilibrium = true;
  point.state = fmt::format("the matrices{}, {} states",
                            times_of_matrices(problem).empty() ? "" : " at t = 0 s", problem.y0.size());
  return point;
}
}  // namespace

namespace {
OperatingPoint point_at_rest(const Problem& problem) {
  require_rates(problem);
  OperatingPoint point = operating_point(problem, 0, problem.y0);
  point.kind = StateKind::rest;
  point.at_equilibrium = !problem.body || is_at_rest(*problem.body);
  point.state = fmt::format("rest {}{}", point.state, point.at_equilibrium ? "" : "; the load acts on it");
  return point;
}

OperatingPoint point_at_equilibrium(const Problem& problem, const EquilibriumWatcher& watcher) {
  const EquilibriumSearch search = equilibrium_of(problem, watcher);
  if (!search.found()) require_rates(problem);
  // One variable for all returns: another would be copied with its matrices.
  OperatingPoint point = search.found() ? operating_point(problem, equilibrium_time(problem), search.state)
                                        : operating_point(problem, 0, problem.y0);
  point.at_equilibrium = search.found();
  if (!search.found()) {
    point.kind = problem.body ? StateKind::rest : StateKind::initial;
    point.status = search.message;
    point.state = fmt::format("initial state {}; {}", point.state, search.message);
    return point;
  }
  point.kind = StateKind::equilibrium;
  take_stiffest_side(point, problem);
  point.state = fmt::format(
      "equilibrium {}{}", point.state,
      search.conserved > 0 ? ", reachable: what the model conserves is that of the initial state" : "");
  return point;
}
}  // namespace

OperatingPoint operating_point(const Problem& problem, AskedState at, const EquilibriumWatcher& watcher) {
  if (problem.matrices) return point_of_matrices(problem);
  OperatingPoint point =
      at == AskedState::rest ? point_at_rest(problem) : point_at_equilibrium(problem, watcher);
  if (problem.body) {
    look_at_contact(point, *problem.body);
    look_at_fibres(point, *problem.body);
  }
  return point;
}

Linearised linearised(const Problem& problem, AskedState at, const EquilibriumWatcher& watcher) {
  Linearised near{.point = operating_point(problem, at, watcher)};
  near.modes = mode_set(near.point.model, near.point.is_body);
  tell_rounded(near);
  return near;
}

SmallDisplacement small_displacement(const Problem& problem, const Linearised& near,
                                     const Eigen::VectorXd& direction, double most) {
  // Of the size of the states of the problem, whatever their unit.
  double scale = std::max(near.point.model.y.lpNorm<Eigen::Infinity>(), problem.y0.lpNorm<Eigen::Infinity>());
  if (problem.body) scale = std::max(scale, diagonal_of(problem.body->mesh()));
  const double first = 1e-6 * (scale > 0 ? scale : 1);
  const auto change_on = [&](double size) {
    const Eigen::VectorXd y = near.point.model.y + size * direction;
    const LinearModel displaced = linear_model(problem, near.point.model.t, y);
    return relative_distance(near.point.model, displaced);
  };
  const auto change_at = [&](double size) {
    return problem.body ? change_on(size) : std::max(change_on(size), change_on(-size));
  };
  // Beside numbers that are not zero smaller ones are lost; a kink is one at any size.
  constexpr int usual = 3, about_zero = 30;
  SmallDisplacement small{.size = first};
  double change = change_at(first), size = first;
  for (int tenth = 1; change > most && tenth <= usual; ++tenth) change = change_at(small.size = size /= 10);
  if (!problem.body && near.point.model.y.isZero(0) && !is_driven(problem))
    for (int tenth = usual; change > most && tenth < about_zero; ++tenth) change = change_at(size /= 10);
  if (!(change > most)) small.size = size;
  // Runs look a thousandth of the limit to both sides of it.
  small.is_linear = !(change > std::max(most, 1e-3));
  return small;
}

}  // namespace hmax
