#include "bench/body_balance.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "problems/tissue/body.hpp"

namespace hmax {

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
  // Small strains know no volume, and have one balance.
  const bool may_invert = body->settings().model != TissueModel::fem_cauchy;
  return {.dofs = body->dofs(),
          .force =
              [body, zero, load](const Eigen::VectorXd& q, Eigen::VectorXd& f) {
                f.resize(q.size());
                body->force(0, q, zero, f);
                f += load;
              },
          .stiffness = [body, zero](const Eigen::VectorXd& q,
                                    StaticModel::Matrix& K) { body->stiffness(0, q, zero, K); },
          // Supports that move drag their neighbours along with a force that no energy has.
          .energy = body->is_autonomous()
                        ? [body, load](const Eigen::VectorXd& q) { return body->energy(0, q) - load.dot(q); }
                        : decltype(StaticModel::energy){},
          .rounding = rounding,
          .admissible = may_invert
                            ? [body](const Eigen::VectorXd& q) { return body->least_volume(0, q).first > 0; }
                            : decltype(StaticModel::admissible){}};
}

StaticSolution found_balance(const StaticModel& model, const StaticSettings& settings, const Clock& clock) {
  StaticSolution at_once = solve_static(model, settings, clock);
  if (!at_once.barred) return at_once;
  StaticSettings by_steps = settings;
  by_steps.load_steps = 10;
  StaticSolution solution = solve_static(model, by_steps, clock);
  const StaticIterate& end = at_once.history.back();
  for (StaticIterate& iterate : solution.history) {
    iterate.seconds += end.seconds;
    iterate.inner += end.inner;
  }
  solution.history.insert(solution.history.begin(), at_once.history.begin(), at_once.history.end());
  solution.iterations += at_once.iterations;
  if (solution.converged && solution.note.empty())
    solution.note =
        "the whole load at once leads to elements turned inside out, so it was brought on in ten steps";
  return solution;
}

std::string_view outcome_of(const Problem& problem, const StaticSolution& solution) {
  if (!(problem.body->least_volume(0, solution.q).first > 0)) return "inverted";
  if (solution.barred) return "collapsed";
  return solution.converged ? "converged" : "not_converged";
}

std::string status_of(const Problem& problem, const StaticSolution& solution) {
  const auto [volume, tetrahedron] = problem.body->least_volume(0, solution.q);
  if (solution.barred)
    return fmt::format(
        "tetrahedron {} is crushed to {:.3g} of its volume, and the steps of the search turn elements inside out; "
        "take more load steps, a smaller load{}",
        tetrahedron_number(problem, tetrahedron), volume,
        problem.body->settings().model == TissueModel::fem_neo_hookean
            ? " or a stiffer material"
            : ", a stiffer material, or fem_neo_hookean, which resists being crushed");
  if (volume > 0) return solution.note;
  return fmt::format("{}{}tetrahedron {} is turned inside out: its volume is {:.3g} of that at rest",
                     solution.note, solution.note.empty() ? "" : "; ",
                     tetrahedron_number(problem, tetrahedron), volume);
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
