#include "catalogue/models/equilibria/support_advice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "analysis/statics/static_solution.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/equilibria/resisting_model.hpp"
#include "catalogue/models/free_parts.hpp"
#include "catalogue/models/tissue_parameters.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/numbers.hpp"
#include "integrators/linear/sparse_solver.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// Degrees of freedom of a mesh up to which a factor of K takes less than a second.
constexpr Eigen::Index most_held = 20'000;

constexpr std::string_view general = "take a smaller load or a stiffer material";

/// One end of a body as its support.
struct HeldEnd {
  int axis;    ///< as `--set axis=` has it
  double sag;  ///< linear, with that end held [m]
  Problem problem;
};

/// The share of the extent that supports hold, of a problem.
double held_share(const Problem& problem) {
  const auto found =
      std::ranges::find(problem.parameters, support_name, &std::pair<std::string, double>::first);
  const double share = found == problem.parameters.end() ? 0 : found->second;
  return share > 0 ? share : TissueParameters{}.support;
}

/// The points within `share` of the extent from the end that an axis names: 1 the low end along x, -1 the
/// high one.
std::vector<TetMesh::Index> points_of_end(const TetMesh& mesh, int axis, double share) {
  const Eigen::RowVectorXd along = (axis > 0 ? -1 : 1) * mesh.points.row(std::abs(axis) - 1);
  const double far = along.maxCoeff(), reach = share * (far - along.minCoeff());
  std::vector<TetMesh::Index> points;
  for (TetMesh::Index i = 0; i < mesh.point_count(); ++i)
    if (along[i] >= far - reach) points.push_back(i);
  return points;
}

/// The end with the least linear sag.
std::optional<HeldEnd> best_end(const Problem& problem) {
  std::optional<HeldEnd> best;
  const double share = held_share(problem);
  for (const int axis : {1, -1, 2, -2, 3, -3}) {
    TissueSettings settings = problem.body->settings();
    settings.supports = {{.points = points_of_end(problem.body->mesh(), axis, share)}};
    if (static_cast<Eigen::Index>(settings.supports.front().points.size()) ==
        problem.body->mesh().point_count())
      continue;
    Problem held = with_settings(problem, std::move(settings));
    const std::optional<double> sag = linear_sag(*held.body);
    if (!sag || (best && best->sag <= *sag)) continue;
    best = HeldEnd{axis, *sag, std::move(held)};
  }
  if (best) best->problem.y0 = Eigen::VectorXd::Zero(best->problem.body->dim());
  return best;
}

}  // namespace

std::optional<double> linear_sag(const TissueBody& body) {
  if (body.dofs() == 0 || body.dofs() > most_held || !loose_dofs(body).empty()) return std::nullopt;
  const double t = equilibrium_time(body);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix K;
  body.stiffness(t, rest, rest, K);
  Eigen::VectorXd sag = rest;
  body.force(t, rest, rest, sag);
  SparseSolver<double> solver;
  if (!solver.factor(K)) return std::nullopt;
  solver.solve(sag);
  return sag.allFinite() ? std::optional(largest_displacement(sag)) : std::nullopt;
}

namespace {

struct SupportAdvice {
  std::string words;
  bool is_the_cause = false;  ///< another support was seen to have an equilibrium
};

SupportAdvice advice_without_equilibrium(const Problem& problem) {
  const TissueBody& body = *problem.body;
  if (!loose_dofs(body).empty()) return {};
  const TissueSettings& settings = body.settings();
  const bool hangs = settings.forces.empty() && settings.tools.empty() && body.is_autonomous();
  const std::optional<double> present = hangs ? linear_sag(body) : std::nullopt;
  if (!present) return {std::string(general)};
  const double size =
      (body.mesh().points.rowwise().maxCoeff() - body.mesh().points.rowwise().minCoeff()).maxCoeff();
  const std::string now = fmt::format("linear elasticity makes this support sag by {}, in a body of {}",
                                      millimetres(*present), millimetres(size));
  const std::optional<HeldEnd> best = best_end(problem);
  // Another end that is hardly better is not worth another search.
  if (!best || best->sag > 0.7 * *present)
    return {fmt::format("{}, and no other end holds it better; {}", now, general)};
  const StaticSolution solution =
      found_equilibrium(best->problem, 1, {.tolerance = 1e-9}, [] { return 0.0; });
  if (!solution.converged)
    return {fmt::format(
        "{}; --set axis={} would sag by {}, and has no equilibrium either; {}, or more points as supports",
        now, best->axis, millimetres(best->sag), general)};
  const bool named = std::ranges::any_of(problem.parameters, [](const auto& each) {
    return each.first.starts_with(fmt::format("{}:", support_name));
  });
  return {
      fmt::format("the support is the cause: {}; with --set axis={}{} it sags by {} and has an equilibrium",
                  now, best->axis, named ? " in place of --support" : "", millimetres(best->sag)),
      true};
}

/// What the body would do with a model that resists inversion, in words; empty where there is no other.
std::string words_of_resisting_model(const Problem& problem) {
  const auto other = with_resisting_model(problem);
  if (!other) return {};
  const StaticSolution solution = found_equilibrium(*other, 1, {.tolerance = 1e-9}, [] { return 0.0; });
  const std::string_view id = other->body->settings().model.id;
  if (outcome_of(*other, solution) != "converged") return fmt::format("; {} has no equilibrium either", id);
  return fmt::format("; {} has an equilibrium, at {}, and inverts no element", id,
                     millimetres(largest_displacement(solution.q)));
}

}  // namespace

std::string remedy_without_equilibrium(const Problem& problem) {
  return advice_without_equilibrium(problem).words;
}

std::string status_without_equilibrium(const Problem& problem, const StaticSolution& solution) {
  // A search that may go on says so itself.
  if (solution.converged || !(solution.remedy.empty() || solution.unstable || solution.barred))
    return status_of(problem, solution);
  const SupportAdvice advice = advice_without_equilibrium(problem);
  if (advice.is_the_cause) return cause_of(problem, solution) + "; " + advice.words;
  const bool by_elements = solution.barred || outcome_of(problem, solution) == "inverted";
  return status_of(problem, solution) + (by_elements ? words_of_resisting_model(problem) : "");
}

}  // namespace hmax
