#include "bench/body_balance.hpp"

#include <cmath>

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
          .admissible = [body](const Eigen::VectorXd& q) { return body->least_volume(0, q).first > 0; }};
}

std::string why_unbalanced(const Problem& problem, const StaticSolution& solution) {
  const auto [volume, tetrahedron] = problem.body->least_volume(0, solution.q);
  if (solution.barred)
    return fmt::format(
        "tetrahedron {} is crushed to {:.3g} of its volume, and every way down the energy turns an element "
        "inside out; take a smaller load{}",
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
