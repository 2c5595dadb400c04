#include "advice/motion/candidate.hpp"

#include <fmt/format.h>

#include "catalogue/methods/choice/simulators.hpp"
#include "catalogue/methods/unsuited.hpp"

namespace hmax {

RunSpec Candidate::spec(double h, double t_end) const {
  RunSpec spec{.t_end = t_end, .h = h};
  spec.jacobian = jacobian;
  spec.linear_solve = linear_solve;
  return spec;
}

std::string Candidate::options() const {
  std::string words;
  if (jacobian != JacobianUpdate{}) words = fmt::format("Jacobian {}", to_string(jacobian));
  if (linear_solve != LinearSolve{}) words += (words.empty() ? "" : ", ") + to_string(linear_solve);
  return words;
}

std::string Candidate::words() const {
  const std::string chosen = options();
  return chosen.empty() ? method.id : method.id + ", " + chosen;
}

std::vector<std::string> simulator_methods() {
  std::vector<std::string> names{"explicit_euler",
                                 "rk2_heun",
                                 "rk4",
                                 "symplectic_euler",
                                 "explicit_newmark",
                                 "central_difference",
                                 "adams_bashforth_2",
                                 "rkc_2",
                                 "linearly_implicit_euler",
                                 "implicit_euler",
                                 "trapezoidal",
                                 "newmark",
                                 "hht_alpha",
                                 "sdirk_4",
                                 "imex_euler"};
  names.insert(names.end(), iterated_by_simulators.begin(), iterated_by_simulators.end());
  return names;
}

std::string why_no_candidate(const Method& method, const Problem& problem) {
  if (!method.bind) return "no stepper takes it";
  if (!method.fixed_step) return "chooses its steps itself, and frames are divided into fixed steps";
  if (!suits(method, problem)) return why_unsuited(method, problem);
  if (is_too_slow(method, problem.y0.size()))
    return fmt::format("takes too long on {} states", problem.y0.size());
  return {};
}

std::vector<Candidate> candidates(const std::vector<Method>& methods, const Problem& problem) {
  const JacobianUpdate exact{1}, tenth{10}, frozen{JacobianUpdate::frozen};
  const LinearSolve direct{.by = LinearSolve::By::direct},
      truncated{.by = LinearSolve::By::conjugate_gradients, .tolerance = 1e-3, .iterations = 20};
  std::vector<Candidate> all;
  for (const Method& method : methods) {
    if (!why_no_candidate(method, problem).empty()) continue;
    if (!method.linearly_implicit) {
      all.push_back({method, {}, {}});
    } else if (!problem.body) {
      for (const JacobianUpdate update : {exact, tenth, frozen}) all.push_back({method, update, {}});
    } else {
      for (const JacobianUpdate update : {exact, tenth, frozen}) all.push_back({method, update, direct});
      all.push_back({method, exact, truncated});
    }
  }
  return all;
}

}  // namespace hmax
