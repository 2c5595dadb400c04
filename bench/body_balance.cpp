#include "bench/body_balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "analysis/dynamic_relaxation.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {
/// Small strains know no volume: their one equilibrium is that, inverted elements or not.
bool may_invert(const Problem& problem) { return problem.body->settings().model == TissueModel::fem_cauchy; }
}  // namespace

double largest_displacement(const Eigen::VectorXd& q) {
  return q.size() == 0 ? 0 : std::sqrt(q.reshaped(3, q.size() / 3).colwise().squaredNorm().maxCoeff());
}

StaticModel static_model(const Problem& problem, double load_scale) {
  const auto body = problem.body;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body->dofs());
  Eigen::VectorXd load = zero;
  body->force(0, zero, zero, load);
  load *= load_scale - 1;
  StaticModel::Matrix K;
  body->stiffness(0, zero, zero, K);
  // Positions have eps |x| of rounding, which the stiffness makes forces of.
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * K.diagonal().cwiseAbs().maxCoeff() *
                          body->mesh().points.cwiseAbs().maxCoeff() *
                          std::sqrt(static_cast<double>(body->dofs()));
  return {.dofs = body->dofs(),
          .force =
              [body, zero, load](const Eigen::VectorXd& q, Eigen::VectorXd& f) {
                f.resize(q.size());
                body->force(0, q, zero, f);
                f += load;
              },
          .stiffness = [body, zero](const Eigen::VectorXd& q,
                                    StaticModel::Matrix& tangent) { body->stiffness(0, q, zero, tangent); },
          // Supports that move drag their neighbours along with a force that no energy has.
          .energy = body->is_autonomous()
                        ? [body, load](const Eigen::VectorXd& q) { return body->energy(0, q) - load.dot(q); }
                        : decltype(StaticModel::energy){},
          .rounding = rounding,
          .admissible = may_invert(problem)
                            ? decltype(StaticModel::admissible){}
                            : [body](const Eigen::VectorXd& q) { return body->least_volume(0, q).first > 0; },
          .resists_inversion = body->settings().model == TissueModel::fem_neo_hookean};
}

namespace {

/// As one solution: the history of what was tried before comes first.
void add_history(const StaticSolution& before, StaticSolution& solution) {
  const StaticIterate end = before.history.back();
  for (StaticIterate& iterate : solution.history) {
    iterate.seconds += end.seconds;
    iterate.inner += end.inner;
  }
  solution.history.insert(solution.history.begin(), before.history.begin(), before.history.end());
  solution.iterations += before.iterations;
}

/// From the last equilibrium by dynamic relaxation, which ends near the next one, and on by Newton's method.
StaticSolution relaxed(const StaticModel& model, const StaticSettings& settings, StaticSolution before,
                       const Clock& clock) {
  constexpr double near = 1e-6;
  constexpr int most = 10'000;
  const double start = clock();
  StaticSettings last = settings;
  last.start = before.equilibrium;
  if (!relax_dynamically(model, *last.start, near, most)) return before;
  const double seconds = clock() - start;
  StaticModel free = model;
  free.admissible = nullptr;
  StaticSolution solution = solve_static(free, last, clock);
  const bool is_admissible = !model.admissible || model.admissible(solution.q);
  if (!solution.converged) return before;
  if (!is_admissible) {
    solution.load_share = before.load_share;
    solution.is_limit = before.is_limit;
  }
  if (is_admissible && solution.note.empty())
    solution.note = "found by dynamic relaxation, where Newton's method did not";
  for (StaticIterate& iterate : solution.history) iterate.seconds += seconds;
  add_history(before, solution);
  return solution;
}

}  // namespace

StaticSolution found_balance(const StaticModel& model, const StaticSettings& settings, const Clock& clock) {
  StaticSolution at_once = solve_static(model, settings, clock);
  const bool searches =
      settings.line_search && settings.method == StaticMethod::newton && model.energy && model.admissible;
  if (at_once.converged || at_once.iterations == 0 || !(at_once.barred || searches)) return at_once;
  StaticSettings by_steps = settings;
  by_steps.adaptive = true;
  by_steps.load_steps = 4;
  StaticSolution solution = solve_static(model, by_steps, clock);
  add_history(at_once, solution);
  if (solution.converged && solution.note.empty())
    solution.note = fmt::format("the load was applied in {} steps: at once it leads to inverted elements",
                                solution.history.back().load_step);
  // What becomes of a body that collapses is told only where it means something.
  const bool ends = solution.converged || !searches || (solution.barred && !model.resists_inversion);
  return ends ? solution : relaxed(model, settings, std::move(solution), clock);
}

namespace {

/// Rounded down to two digits: where it is right, what is said of it is.
std::string percent(double share) {
  if (share >= 1 || share <= 0) return share > 0 ? "100 %" : "0 %";
  const double digit = std::pow(10, std::floor(std::log10(share)) - 1);
  return fmt::format("{:g} %", 100 * std::floor(share / digit * (1 + 1e-12)) * digit);
}

/// What has an equilibrium: elastic forces are as E, so that a share of the load is as good as a multiple of
/// E.
std::string remedy(const Problem& problem, const StaticSolution& solution,
                   std::string_view converging_model) {
  std::string text = solution.is_limit ? "use a smaller load" : "use more load steps, a smaller load";
  const auto E = std::ranges::find(problem.parameters, "E", &std::pair<std::string, double>::first);
  const bool scales = std::ranges::none_of(
      problem.parameters, [](const auto& each) { return each.first == "k" || each.first.starts_with("E:"); });
  if (E != problem.parameters.end() && scales && solution.is_limit && solution.load_share > 0) {
    const double needed = 1.01 * E->second / solution.load_share;
    const double digit = std::pow(10, std::floor(std::log10(needed)) - 1);
    text += fmt::format(", or E = {:g} Pa", std::ceil(needed / digit) * digit);
  } else {
    text += " or a stiffer material";
  }
  if (!converging_model.empty()) text += fmt::format(", or --model {}, which converges", converging_model);
  return text;
}

}  // namespace

std::string_view outcome_of(const Problem& problem, const StaticSolution& solution) {
  if (!may_invert(problem) && !(problem.body->least_volume(0, solution.q).first > 0)) return "inverted";
  if (solution.barred) return "collapsed";
  return solution.converged ? "converged" : "not_converged";
}

std::string status_of(const Problem& problem, const StaticSolution& solution,
                      std::string_view converging_model) {
  const auto [volume, tetrahedron] = problem.body->least_volume(0, solution.q);
  const std::int64_t number = tetrahedron_number(problem, tetrahedron);
  const std::string share = percent(solution.load_share);
  if (solution.barred)
    return fmt::format("no static equilibrium {}: tetrahedron {} collapses ({:.2g} of its volume); {}",
                       solution.is_limit ? fmt::format("above {} of the load", share) : "was found", number,
                       volume, remedy(problem, solution, converging_model));
  const bool is_inverted = !(volume > 0);
  if (is_inverted && !may_invert(problem) && solution.converged)
    return fmt::format(
        "tetrahedron {} is inverted ({:.2g} of its volume) in the static equilibrium, as elements are "
        "above {} of the load; {}",
        number, volume, share, remedy(problem, solution, converging_model));
  std::string text = solution.note;
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
  if (!solution.converged && solution.load_share > 0)
    add(fmt::format("{} of the load has a static equilibrium; {}", share,
                    remedy(problem, solution, converging_model)));
  if (is_inverted) add(fmt::format("tetrahedron {} is inverted ({:.2g} of its volume)", number, volume));
  if (is_inverted && may_invert(problem))
    add("displacements are too large for small strains: take another model");
  return text;
}

std::int64_t tetrahedron_number(const Problem& problem, Eigen::Index tetrahedron) {
  return problem.tetrahedron_numbers.at(static_cast<std::size_t>(tetrahedron));
}

NamedElement named_element(const Problem& problem, Eigen::Index element) {
  const bool springs = problem.body->settings().model == TissueModel::mass_spring;
  const Eigen::Index tetrahedra = springs ? 0 : problem.body->mesh().tetrahedron_count();
  if (element < tetrahedra) return {"tetrahedron", tetrahedron_number(problem, element)};
  return {springs ? "spring" : "skin triangle", element - tetrahedra + 1};
}

}  // namespace hmax
