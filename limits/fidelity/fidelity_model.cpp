#include "limits/fidelity/fidelity_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include "analysis/statics/equilibrium.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/support_advice.hpp"
#include "catalogue/models/equilibria/tool_report.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/input_error.hpp"
#include "limits/by_steps/one_step_map.hpp"
#include "limits/kinks.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/modes/mode_curve.hpp"
#include "limits/undamped_modes.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/ten_node.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

using Eigen::VectorXd;

VectorXd at_rest(const VectorXd& q) {
  VectorXd y = VectorXd::Zero(2 * q.size());
  y.head(q.size()) = q;
  return y;
}

/// Mass, start and load of a problem with positions and velocities.
FidelityModel unsettled_model(Problem problem) {
  FidelityModel model{.problem = std::move(problem)};
  std::visit(
      [&](const auto& system) {
        using Dofs = typename std::remove_cvref_t<decltype(system)>::Dofs;
        const Eigen::Index n = system.dofs();
        const Dofs q = model.problem.y0.head(n), v = Dofs::Zero(n);
        Dofs f = v;
        system.force(0, q, v, f);
        model.start = q;
        model.load = f;
        model.mass = mass_of(system);
      },
      model.problem.system);
  model.equilibrium = VectorXd::Zero(model.start.size());
  return model;
}

void settle_body(FidelityModel& model, const std::function<void()>& watch) {
  const TissueBody& body = *model.problem.body;
  if (!is_at_rest(body)) {
    StaticSettings settings;
    if (watch) settings.seen = [&](const StaticIterate&) { watch(); };
    const StaticSolution solution = found_equilibrium(model.problem, 1, settings, [] { return 0.0; });
    if (!solution.converged) {
      const std::string remedy = remedy_without_equilibrium(model.problem);
      throw InputError("no static equilibrium to compare with: " + cause_of(model.problem, solution) +
                       (remedy.empty() ? "" : "; ") + remedy);
    }
    model.equilibrium = solution.q;
  }
  model.volume = volume_of(body, model.equilibrium);
  model.sizes = model.equilibrium;
  if (!model.sizes.isZero(0)) return;
  model.sizes.setConstant(0.01 * diagonal_of(body.mesh()));
}

void settle_other(FidelityModel& model) {
  const Eigen::Index n = model.start.size();
  // Matrices have zero for an equilibrium, and may be large.
  VectorXd found = VectorXd::Zero(n);
  if (!model.problem.matrices) {
    const EquilibriumSearch search = std::visit(
        [&]<class Sys>(const Sys& system) {
          return find_equilibrium(system, 0, typename Sys::State(at_rest(model.start)));
        },
        model.problem.system);
    if (!search.found()) throw InputError("no static equilibrium to compare with: " + search.message);
    found = search.state.head(n);
  }
  const double size = std::max(model.start.norm(), found.norm());
  constexpr double rounding = 1e-9;
  if ((found - model.start).norm() > rounding * size) model.equilibrium = found - model.start;
  // Zero has no size: there as 1e-4.
  model.sizes = model.is_loaded() ? model.equilibrium : VectorXd::Constant(n, size > 0 ? 0.01 * size : 1e-4);
}

/// Formulas of accelerations tell no masses: those d > 0 that make diag(d) K symmetric, d_i K_ij = d_j K_ji,
/// the first of each connected part 1. Nothing where there are none.
std::optional<VectorXd> symmetrising_masses(const Eigen::MatrixXd& K) {
  const Eigen::Index n = K.rows();
  VectorXd d = VectorXd::Zero(n);
  std::vector<Eigen::Index> reached;
  for (Eigen::Index first = 0; first < n; ++first) {
    if (d[first] > 0) continue;
    d[first] = 1;
    for (reached.push_back(first); !reached.empty();) {
      const Eigen::Index i = reached.back();
      reached.pop_back();
      for (Eigen::Index j = 0; j < n; ++j) {
        if (d[j] > 0 || K(i, j) * K(j, i) == 0) continue;
        d[j] = d[i] * K(i, j) / K(j, i);
        if (!(d[j] > 0) || !std::isfinite(d[j])) return std::nullopt;
        reached.push_back(j);
      }
    }
  }
  return d;
}

/// Gives the model of formulas the masses that make its stiffness symmetric, where there are some.
void find_masses(FidelityModel& model, MechanicalPart& part) {
  if (part.symmetric || model.problem.matrices || model.problem.body || rows(part.K) > most_dense_modes)
    return;
  const auto masses = symmetrising_masses(dense(part.K));
  if (!masses) return;
  const auto scaled = [&](const AnyMatrix& A) { return Eigen::MatrixXd(masses->asDiagonal() * dense(A)); };
  MechanicalPart found =
      mechanical_part(VectorXd(masses->cwiseProduct(part.mass.lumped())), scaled(part.K), scaled(part.C));
  if (!found.symmetric) return;
  part = std::move(found);
  model.mass = part.mass;
  model.load = model.load.cwiseProduct(*masses);
}

ShownMode shown_mode(const MechanicalMode& mode) {
  const double omega = std::sqrt(mode.kappa);
  return {.omega = omega, .zeta = mode.gamma / (2 * omega)};
}

/// The slowest undamped modes near the equilibrium, with their damping ratios.
void add_modes(FidelityModel& model, std::size_t modes) {
  OperatingPoint point = operating_point(model.problem, 0, at_rest(model.start + model.equilibrium));
  take_stiffest_side(point, model.problem);
  find_masses(model, *point.model.mechanical);
  model.shapes.resize(model.start.size(), 0);
  if (!point.model.mechanical->symmetric) {
    model.why_no_modes = "the stiffness of the model is not symmetric, and no mode is compared";
    return;
  }
  const bool at_kink = point.at_kink;
  UndampedModes found = undamped_modes(std::move(point), modes);
  if (!found.stiff)
    throw input_error(
        "{} has no positive stiffness in its equilibrium, and neither stiffness nor a mode to show; start it near another "
        "one, or change its parameters",
        model.problem.id);
  if (found.fastest) {
    const ShownMode fastest = shown_mode(*found.fastest);
    model.fastest = fastest.omega;
    model.fastest_zeta = std::min(fastest.zeta, 0.999);
  }
  if (at_kink) {
    model.why_no_modes = "the slopes of the model jump at its equilibrium, and no mode is compared";
    return;
  }
  if (found.slowest.empty())
    model.why_no_modes = "the slow modes of a model of this size are not computed, and none is compared";
  for (const MechanicalMode& mode : found.slowest) model.modes.push_back(shown_mode(mode));
  model.shapes = std::move(found.shapes);
}

void require_rest(const Problem& problem) {
  if (!is_second_order(problem))
    throw input_error(
        "{} has no positions and velocities, of which steps show stiffness and modes; take another model",
        problem.id);
  if (is_driven(problem))
    throw InputError(
        "the load changes with time and never settles, so that nothing comes to rest; take one that stays, like gravity");
}

}  // namespace

double volume_of(const TissueBody& body, const VectorXd& q) {
  TetMesh moved = body.mesh();
  moved.points = body.positions(0, q);
  double sum = 0;
  for (Eigen::Index e = 0; e < moved.element_count(); ++e) sum += element_volume(moved, e);
  return sum;
}

double young_of(const Problem& problem) { return settings_of(problem).materials.front().young; }

Problem with_stiffness(const Problem& problem, double factor) {
  return with_settings(problem, [&](TissueSettings& settings) {
    for (TissueMaterial& material : settings.materials) {
      material.young *= factor;
      material.fibre_young *= factor;
    }
    settings.springs.stiffness *= factor;
    settings.skin.young *= factor;
    // Damping is that of the material: beta K would grow with it.
    settings.beta /= factor;
    settings.springs.damper_time /= factor;
  });
}

VectorFunction step_of_model(const Method& method, const FidelityModel& model, const Problem& problem,
                             double h) {
  VectorFunction step = one_step_map(method, problem, h);
  if (model.start.isZero(0)) return step;
  return [step = std::move(step), start = at_rest(model.start)](const VectorXd& y) -> VectorXd {
    return step(start + y) - start;
  };
}

FidelityModel settled_model(const Problem& problem, const std::function<void()>& watch, std::size_t modes) {
  const Problem settled = after_ramps(problem);
  require_rest(settled);
  FidelityModel model = unsettled_model(settled);
  if (problem.body)
    settle_body(model, watch);
  else
    settle_other(model);
  add_modes(model, modes);
  return model;
}

FidelityModel fidelity_model(const Problem& problem, const std::function<void()>& watch, std::size_t modes) {
  if (has_tool(problem))
    throw InputError(
        "the force of a tool depends on the body where a tool meets it, and measures no stiffness; take gravity or press");
  FidelityModel model = settled_model(problem, watch, modes);
  if (problem.body && model.equilibrium.isZero(0))
    throw InputError("nothing loads the body, so that no sag shows its stiffness; take a load with --load");
  return model;
}

}  // namespace hmax
