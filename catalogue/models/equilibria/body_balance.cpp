#include "catalogue/models/equilibria/body_balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/models/equilibria/resisting_model.hpp"
#include "catalogue/models/free_parts.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

double equilibrium_time(const TissueBody& body) {
  return std::isfinite(body.steady_from()) ? body.steady_from() : 0;
}

double equilibrium_time(const Problem& problem) { return problem.body ? equilibrium_time(*problem.body) : 0; }

namespace {

/// The stiffness of a part that nothing holds has no inverse. Where no net force acts on it, it stays where
/// it is, and whatever stiffness its points are given beside their own leads there.
void fix_loose(const std::vector<std::vector<Eigen::Index>>& loose, StaticModel::Matrix& K) {
  constexpr double little = 1e-6;
  const double shift = little * K.diagonal().cwiseAbs().mean();
  for (const std::vector<Eigen::Index>& part : loose)
    for (const Eigen::Index i : part) K.coeffRef(i, i) += shift;
}

/// Whether a net force acts on a part that nothing holds.
bool pushes_loose(const TissueBody& body, const StaticModel& model) {
  const std::vector<std::vector<Eigen::Index>> loose = loose_dofs(body);
  if (loose.empty()) return false;
  Eigen::VectorXd load;
  model.force(Eigen::VectorXd::Zero(model.dofs), load);
  return std::ranges::any_of(loose, [&](const std::vector<Eigen::Index>& part) {
    Eigen::Vector3d net = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < part.size(); ++i) net[static_cast<Eigen::Index>(i % 3)] += load[part[i]];
    return net.norm() > model.rounding;
  });
}

/// The equilibrium of forces as they are at t, of the displacements q beyond `from`, shape (dofs).
StaticModel model_from(const Problem& problem, double load_scale, double t, const Eigen::VectorXd& from) {
  const auto body = problem.body;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body->dofs());
  Eigen::VectorXd load = zero;
  body->force(t, from, zero, load);
  load *= load_scale - 1;
  StaticModel::Matrix K0;
  body->stiffness(t, from, zero, K0);
  // Positions have eps |x| of rounding, which the stiffness makes forces of.
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * K0.diagonal().cwiseAbs().maxCoeff() *
                          body->mesh().points.cwiseAbs().maxCoeff() *
                          std::sqrt(static_cast<double>(body->dofs()));
  // Small strains know no volume, and have one equilibrium.
  const bool may_invert = !body->settings().model.is_linear;
  return {
      .dofs = body->dofs(),
      .force =
          [body, t, from, zero, load](const Eigen::VectorXd& q, Eigen::VectorXd& f) {
            f.resize(q.size());
            body->force(t, from + q, zero, f);
            f += load;
          },
      .stiffness =
          [body, t, from, zero, loose = loose_dofs(*body)](const Eigen::VectorXd& q, StaticModel::Matrix& K) {
            body->stiffness(t, from + q, zero, K);
            fix_loose(loose, K);
          },
      // Supports that move drag their neighbours along with a force that no energy has.
      .energy = body->steady_from() == t
                    ? [body, t, from,
                       load](const Eigen::VectorXd& q) { return body->energy(t, from + q) - load.dot(q); }
                    : decltype(StaticModel::energy){},
      .rounding = rounding,
      .admissible =
          may_invert ? [body, t,
                        from](const Eigen::VectorXd& q) { return body->least_volume(t, from + q).first > 0; }
                     : decltype(StaticModel::admissible){}};
}

/// Puts what was done before into the history of a solution.
void prepend(const StaticSolution& before, StaticSolution& solution) {
  if (before.history.empty()) return;
  const StaticIterate& end = before.history.back();
  for (StaticIterate& iterate : solution.history) {
    iterate.seconds += end.seconds;
    iterate.inner += end.inner;
    iterate.iteration += before.iterations;
  }
  solution.history.insert(solution.history.begin(), before.history.begin(), before.history.end());
  solution.iterations += before.iterations;
}

/// Where a search that leaves unstable equilibria has found no stable one, looks for one that it has left.
void look_for_unstable(const StaticModel& model, StaticSettings settings, const Clock& clock,
                       StaticSolution& solution) {
  if (settings.method != StaticMethod::newton || !settings.line_search || !settings.leave_saddles) return;
  settings.leave_saddles = false;
  StaticSolution other = solve_static(model, settings, clock);
  if (!other.converged) return;
  prepend(solution, other);
  solution = std::move(other);
  if (solution.stable.value_or(true)) return;
  solution.converged = false;
  solution.unstable = true;
  solution.note = "its equilibrium under this load is not stable, and no other was found";
  solution.remedy = "a smaller load or a stiffer material";
}

/// When about this share of the way of a ramp is done, in its time: the inverse of 3 u^2 - 2 u^3, which is
/// near to that of TimeProfile; strides near the ends are a little shorter than in the middle.
double time_of(double share) { return 0.5 - std::sin(std::asin(1 - 2 * share) / 3); }

/// The equilibrium at the end of ramps, followed along them: a tool that stood at the end of its path at once
/// would press on the wrong side of the surface. A stride that finds no equilibrium is halved.
StaticSolution followed_equilibrium(const Problem& problem, const StaticSettings& settings,
                                    const Clock& clock) {
  constexpr int usual_stages = 20, most_halvings = 4, most_on_the_way = 40;
  const int stages = settings.load_steps.value_or(usual_stages);
  const double t_end = equilibrium_time(problem);
  StaticSolution solution;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(problem.body->dofs());
  int halvings = 0;
  for (double done = 0; done < 1;) {
    const double share = std::min(1.0, done + std::ldexp(1.0 / stages, -halvings));
    const bool last = share > 1 - 1e-9;
    const auto number = [&](StaticIterate& iterate) {
      iterate.load_step = std::clamp(static_cast<int>(std::ceil(share * stages - 1e-9)), 1, stages);
      iterate.load_steps = stages;
    };
    StaticSettings of_stage = settings;
    of_stage.load_steps = 1;
    if (!last) {
      // Beside the forces of a stride, which are less than the whole load; and what takes long is better
      // tried with half the stride.
      of_stage.tolerance = std::max(settings.tolerance, 1e-9);
      of_stage.iterations = std::min(settings.iterations, most_on_the_way);
    }
    if (settings.seen)
      of_stage.seen = [&](StaticIterate iterate) {
        number(iterate);
        settings.seen(iterate);
      };
    StaticSolution next =
        solve_static(model_from(problem, 1, last ? t_end : t_end * time_of(share), q), of_stage, clock);
    std::ranges::for_each(next.history, number);
    prepend(solution, next);
    solution = std::move(next);
    // Before the end what is nearly an equilibrium leads on as well.
    const bool good =
        solution.converged || (!last && !solution.barred && solution.history.back().residual < 1e-2);
    if (!good && halvings < most_halvings) {
      ++halvings;
      continue;
    }
    q += solution.q;
    if (!good) break;
    done = last ? 1 : share;
  }
  solution.q = std::move(q);
  return solution;
}

}  // namespace

StaticModel static_model(const Problem& problem, double load_scale) {
  return model_from(problem, load_scale, equilibrium_time(problem),
                    Eigen::VectorXd::Zero(problem.body->dofs()));
}

StaticSolution found_equilibrium(const Problem& problem, double load_scale, const StaticSettings& settings,
                                 const Clock& clock) {
  if (equilibrium_time(problem) > 0) return followed_equilibrium(problem, settings, clock);
  const StaticModel model = static_model(problem, load_scale);
  if (pushes_loose(*problem.body, model)) {
    StaticSolution none;
    none.q = Eigen::VectorXd::Zero(model.dofs);
    none.singular = true;
    none.history.push_back({1, 1, 1, 0, 0});
    return none;
  }
  StaticSolution solution = solve_static(model, settings, clock);
  if (solution.barred && !settings.load_steps) {
    StaticSettings by_steps = settings;
    by_steps.load_steps = 10;
    StaticSolution later = solve_static(model, by_steps, clock);
    prepend(solution, later);
    solution = std::move(later);
    if (solution.converged && solution.note.empty())
      solution.note = "the whole load at once inverts elements, so it was applied in ten steps";
  }
  if (!solution.converged) look_for_unstable(model, settings, clock, solution);
  return solution;
}

StaticSolution beyond_inversion(const Problem& problem, double load_scale, const StaticSettings& settings,
                                const Clock& clock, StaticSolution solution) {
  const bool pushes_back = settings_of(problem).model.resists_crushing;
  // Steps of the load that somebody chose may be too few; loads that move are followed.
  if (!solution.barred || !pushes_back || settings.load_steps || equilibrium_time(problem) > 0)
    return solution;
  StaticModel model = static_model(problem, load_scale);
  model.admissible = nullptr;
  StaticSolution other = solve_static(model, settings, clock);
  if (!other.converged) return solution;
  prepend(solution, other);
  other.converged = problem.body->least_volume(equilibrium_time(problem), other.q).first > 0;
  const std::string_view found = other.converged ? "the search for this equilibrium passed inverted elements"
                                                 : "the only equilibrium found has inverted elements";
  other.note = fmt::format("{}{}{}", found, other.note.empty() ? "" : "; ", other.note);
  return other;
}

std::string_view outcome_of(const Problem& problem, const StaticSolution& solution) {
  if (!(problem.body->least_volume(equilibrium_time(problem), solution.q).first > 0)) return "inverted";
  if (solution.unstable) return "buckles";
  if (solution.barred) return "collapsed";
  return solution.converged ? "converged" : "not_converged";
}

std::string cause_of(const Problem& problem, const StaticSolution& solution) {
  const auto [volume, tetrahedron] = problem.body->least_volume(equilibrium_time(problem), solution.q);
  if (solution.barred)
    return fmt::format(
        "tetrahedron {} is crushed to {:.3g} of its volume, and the steps of the search invert elements",
        tetrahedron_number(problem, tetrahedron), volume);
  if (solution.singular)
    if (std::string free = free_parts_in_words(problem); !free.empty()) return free;
  if (volume > 0) return solution.note;
  return fmt::format("{}{}tetrahedron {} is inverted: its volume is {:.3g} of that at rest", solution.note,
                     solution.note.empty() ? "" : "; ", tetrahedron_number(problem, tetrahedron), volume);
}

namespace {

/// What else may help where an element collapses: for a model that does not resist it, one that does.
std::string remedy_of_collapse(const TissueModel& model, bool names_model) {
  const TissueModel* other = names_model ? resisting_model(model) : nullptr;
  if (!other) return ", a smaller load or a stiffer material";
  return fmt::format(", a smaller load, a stiffer material, or {}, which resists being crushed", other->id);
}

}  // namespace

std::string status_of(const Problem& problem, const StaticSolution& solution, bool names_model) {
  std::string remedy = solution.remedy;
  if (solution.barred) remedy += remedy_of_collapse(settings_of(problem).model, names_model);
  return cause_of(problem, solution) + (remedy.empty() ? "" : "; take " + remedy);
}

NamedElement named_element(const Problem& problem, Eigen::Index element) {
  const TissueBody& body = *problem.body;
  const auto pieces = static_cast<Eigen::Index>(body.element_pieces());
  NamedElement named{.kind = "tetrahedron", .number = 0, .points = {}};
  if (element < std::min(pieces, body.mesh().element_count())) {
    named.number = tetrahedron_number(problem, body.mesh().first_part(element));
    for (const auto point : body.mesh().element(element))
      named.points.push_back(point_number(problem, point));
    return named;
  }
  Eigen::Index e = 0;
  body.visit_rest_stiffness([&](std::span<const TissueBody::Index> points, const auto&) {
    if (e++ != element) return;
    for (const auto point : points) named.points.push_back(point_number(problem, point));
  });
  const bool averages = element < pieces;
  named.kind = averages                                ? "nodal pressure"
               : named.points.size() == 1              ? "support spring"
               : body.settings().model.is_of_springs() ? "spring"
                                                       : "skin triangle";
  named.number = averages ? named.points.front() : element - pieces + 1;
  return named;
}

std::string in_words(const NamedElement& element) {
  if (element.kind == "tetrahedron") return fmt::format("tetrahedron {}", element.number);
  if (element.kind == "nodal pressure") return fmt::format("the pressure at node {}", element.number);
  return fmt::format("the {} of point{} {}", element.kind, element.points.size() == 1 ? "" : "s",
                     fmt::join(element.points, ", "));
}

}  // namespace hmax
