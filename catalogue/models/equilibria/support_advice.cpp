#include "catalogue/models/equilibria/support_advice.hpp"

#include <algorithm>
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
#include "integrators/linear/conjugate_gradients.hpp"
#include "integrators/linear/sparse_solver.hpp"
#include "problems/matrices/condensation.hpp"
#include "problems/mesh/mesh_parts.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

/// Degrees of freedom of a body whose ends are compared: six solutions take about a second.
constexpr Eigen::Index most_held = 20'000;
/// Those up to which a factor of K is faster than conjugate gradients.
constexpr Eigen::Index most_by_factor = 6'000;

constexpr std::string_view general = "take a smaller load or a stiffer material";

bool is_held_by_springs(const TissueBody& body) { return !body.settings().elastic_supports.empty(); }

/// The largest displacement of K u = f; nothing where K is not positive definite, or regular only by
/// rounding, so that a residual is left. Conjugate gradients end at one that leaves three digits of it.
std::optional<double> largest_solution(const TissueBody::DofMatrix& K, const Eigen::VectorXd& f) {
  Eigen::VectorXd u = f;
  if (K.rows() <= most_by_factor) {
    SparseSolver<double> solver;
    if (!solver.factor(K)) return std::nullopt;
    solver.solve(u);
  } else {
    constexpr double tolerance = 1e-4;
    ConjugateGradients<double> solver;
    if (!solver.prepare(K) || !solver.solve(f, u, tolerance, 0).solved) return std::nullopt;
  }
  constexpr double singular = 1e-2;
  return (f - K * u).norm() <= singular * f.norm() ? std::optional(largest_displacement(u)) : std::nullopt;
}

/// A parameter of a problem; nothing where it does not have it.
std::optional<double> parameter(const Problem& problem, std::string_view name) {
  const auto found = std::ranges::find(problem.parameters, name, &std::pair<std::string, double>::first);
  return found == problem.parameters.end() ? std::nullopt : std::optional(found->second);
}

/// The unit vector to the end that an axis names: 1 the low end along x, -1 the high one.
Eigen::Vector3d towards_end(int axis) {
  return (axis > 0 ? -1 : 1) * Eigen::Vector3d::Unit(std::abs(axis) - 1);
}

/// A body at rest that nothing holds, under its weight; and how far it sags where an end is held.
class UnheldBody {
 public:
  explicit UnheldBody(const Problem& problem)
      : mesh_(problem.body->mesh()), share_(parameter(problem, support_name).value_or(0)) {
    if (!(share_ > 0)) share_ = TissueParameters{}.support;
    TissueSettings settings = settings_of(problem);
    settings.supports.clear();
    settings.elastic_supports.clear();
    settings.beta = settings.mass_step = 0;
    const TissueBody body(mesh_, std::move(settings));
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(body.dofs());
    body.stiffness(0, rest, rest, K_);
    load_.resize(body.dofs());
    body.force(0, rest, rest, load_);
  }

  [[nodiscard]] std::vector<TetMesh::Index> points(int axis) const {
    return points_of_end(mesh_, towards_end(axis), share_);
  }

  /// By linear elasticity; nothing where the end does not hold all of the body, or holds every point.
  [[nodiscard]] std::optional<double> sag(int axis) const {
    const std::vector<TetMesh::Index> held = points(axis);
    if (static_cast<Eigen::Index>(held.size()) == mesh_.point_count() || !free_parts(mesh_, held).empty())
      return std::nullopt;
    std::vector<char> is_held(static_cast<std::size_t>(mesh_.point_count()), 0);
    for (const TetMesh::Index i : held) is_held[static_cast<std::size_t>(i)] = 1;
    std::vector<Eigen::Index> kept;
    for (Eigen::Index row = 0; row < load_.size(); ++row)
      if (is_held[static_cast<std::size_t>(row / 3)] == 0) kept.push_back(row);
    return largest_solution(block_of(K_, kept, kept), load_(kept));
  }

 private:
  const TetMesh& mesh_;
  double share_;
  TissueBody::DofMatrix K_;
  Eigen::VectorXd load_;
};

/// The sag with each end that holds the body, least first.
std::vector<EndSag> sags_of_ends(const UnheldBody& body) {
  std::vector<EndSag> ends;
  for (const int axis : {1, -1, 2, -2, 3, -3})
    if (const std::optional<double> sag = body.sag(axis)) ends.push_back({axis, *sag});
  std::ranges::stable_sort(ends, {}, &EndSag::sag);
  return ends;
}

/// Whether nothing but its weight acts on a body.
bool hangs(const TissueBody& body) {
  const TissueSettings& settings = body.settings();
  return settings.forces.empty() && settings.tools.empty() && body.is_autonomous();
}

}  // namespace

std::optional<double> linear_sag(const TissueBody& body) {
  if (body.dofs() == 0 || body.dofs() > most_held || free_motions(body).cols() > 0) return std::nullopt;
  const double t = equilibrium_time(body);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix K;
  body.stiffness(t, rest, rest, K);
  Eigen::VectorXd load = rest;
  body.force(t, rest, rest, load);
  return largest_solution(K, load);
}

std::optional<SuggestedSupport> suggested_support(const Problem& problem) {
  constexpr double clearly = 0.5;
  if (!problem.support_by_default || !hangs(*problem.body) || problem.body->dofs() > most_held ||
      settings_of(problem).gravity.isZero(0))
    return std::nullopt;
  const int axis = static_cast<int>(parameter(problem, "axis").value_or(TissueParameters{}.axis));
  const std::vector<EndSag> ends = sags_of_ends(UnheldBody(problem));
  const auto now = std::ranges::find(ends, axis, &EndSag::axis);
  if (now == ends.end() || !(ends.front().sag < clearly * now->sag)) return std::nullopt;
  return SuggestedSupport{ends.front().axis, ends.front().sag, axis, now->sag};
}

std::string name_of_end(int axis) {
  return fmt::format("{} {}", axis > 0 ? "low" : "high", "xyz"[std::abs(axis) - 1]);
}

std::string in_words(const SuggestedSupport& suggested) {
  return fmt::format(
      "support: with the end fixed by default, {}, the body sags {} by linear elasticity; with {} it sags {}, the least "
      "of the six ends: --set axis={}",
      name_of_end(suggested.axis_now), millimetres(suggested.sag_now), name_of_end(suggested.axis),
      millimetres(suggested.sag), suggested.axis);
}

namespace {

struct SupportAdvice {
  std::string words;
  bool is_the_cause = false;  ///< another support was seen to have an equilibrium
};

SupportAdvice advice_without_equilibrium(const Problem& problem) {
  const TissueBody& body = *problem.body;
  if (free_motions(body).cols() > 0) return {};
  // How far ends sag that are fixed says nothing of springs.
  if (is_held_by_springs(body))
    return {"take stiffer springs (support_stiffness), a smaller load or a stiffer material"};
  const std::optional<double> present = hangs(body) ? linear_sag(body) : std::nullopt;
  if (!present) return {std::string(general)};
  const double size =
      (body.mesh().points.rowwise().maxCoeff() - body.mesh().points.rowwise().minCoeff()).maxCoeff();
  const std::string now = fmt::format("linear elasticity makes this support sag by {}, in a body of {}",
                                      millimetres(*present), millimetres(size));
  const UnheldBody unheld(problem);
  const std::vector<EndSag> ends = sags_of_ends(unheld);
  // Another end that is hardly better is not worth another search.
  if (ends.empty() || ends.front().sag > 0.7 * *present)
    return {fmt::format("{}, and no other end holds it better; {}", now, general)};
  const auto [axis, sag] = ends.front();
  TissueSettings settings = body.settings();
  settings.supports = {{.points = unheld.points(axis)}};
  settings.elastic_supports.clear();
  Problem held = with_settings(problem, std::move(settings));
  held.y0 = Eigen::VectorXd::Zero(held.body->dim());
  const StaticSolution solution = found_equilibrium(held, 1, {.tolerance = 1e-9}, [] { return 0.0; });
  if (!solution.converged)
    return {fmt::format(
        "{}; --set axis={} would sag by {}, and no equilibrium was found there either; {}, or more points as supports",
        now, axis, millimetres(sag), general)};
  const bool named = std::ranges::any_of(problem.parameters, [](const auto& each) {
    return each.first.starts_with(fmt::format("{}:", support_name));
  });
  return {
      fmt::format("the support is the cause: {}; with --set axis={}{} it sags by {} and has an equilibrium",
                  now, axis, named ? " in place of --support" : "", millimetres(sag)),
      true};
}

/// What the body would do with a model that resists inversion, in words; empty where there is no other.
std::string words_of_resisting_model(const Problem& problem) {
  const auto other = with_resisting_model(problem);
  // The parts of elements of ten nodes are not the mesh that the other model would have.
  if (!other || problem.body->mesh().has_ten_nodes()) return {};
  const StaticSettings settings{.tolerance = 1e-9};
  const Clock no_clock = [] { return 0.0; };
  const StaticSolution solution =
      beyond_inversion(*other, 1, settings, no_clock, found_equilibrium(*other, 1, settings, no_clock));
  const std::string_view id = settings_of(*other).model.id, outcome = outcome_of(*other, solution);
  if (outcome == "inverted")
    return fmt::format("; with {} the only equilibrium found has inverted elements, at {}", id,
                       millimetres(largest_displacement(solution.q)));
  if (outcome != "converged") return fmt::format("; with {} no equilibrium was found either", id);
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
  const bool by_elements = solution.barred || outcome_of(problem, solution) == "inverted";
  const bool resists = settings_of(problem).model.resists_crushing;
  const bool on_springs = !by_elements && is_held_by_springs(*problem.body);
  if (advice.is_the_cause || on_springs || (by_elements && resists && !solution.barred))
    return cause_of(problem, solution) + "; " + advice.words;
  const std::string tried = by_elements ? words_of_resisting_model(problem) : "";
  return status_of(problem, solution, tried.empty()) + tried;
}

}  // namespace hmax
