#include "limits/largest_stable_step.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/spectrum/spectrum.hpp"
#include "analysis/statics/equilibrium.hpp"
#include "core/input_error.hpp"
#include "core/text/sentences.hpp"
#include "limits/kinks.hpp"
#include "limits/linearised_problem.hpp"
#include "limits/predict.hpp"
#include "limits/verification.hpp"

namespace hmax {
namespace {

/// A Jacobian by differences, without a pattern, is dense.
void require_differences_are_affordable(const AnySystem& system) {
  if (system.has_jacobian() || system.has_sparsity() || system.dim() <= most_dense_rows) return;
  throw input_error(
      "a system of {} unknowns has neither jacobian() nor sparsity(), and differences make a dense "
      "Jacobian, which is taken up to {}; give it one of the two",
      system.dim(), most_dense_rows);
}

Problem problem_of(const AnySystem& system, const Eigen::VectorXd& y) {
  if (y.size() != system.dim())
    throw std::invalid_argument(
        fmt::format("the state has {} numbers, but the system has {}; give one number for each unknown",
                    y.size(), system.dim()));
  require_differences_are_affordable(system);
  return {.id = "system", .y0 = y, .t_end = 1, .system = system};
}

StepAnswer answer_of(const MethodChoice& choice, const Problem& problem, const Linearised& near,
                     bool verified) {
  const Method& method = choice.method();
  Prediction row = predict(method, near);
  if (verified) verify(row, method, problem, near);
  StepAnswer answer{.method = row.method,
                    .bound = row.bound,
                    .limiting = row.limiting,
                    .state_kind = std::string(name_of(near.point.kind)),
                    .status = near.point.status};
  if (row.h_max) answer.h_max = *row.h_max;
  const auto say = [&](const std::string& sentence) { add_sentence(answer.status, sentence); };
  if (near.point.at_kink) say(std::string(at_a_kink));
  say(row.note);
  if (!verified) return answer;
  if (row.observed && !std::isnan(row.observed->h_max))
    answer.observed = row.observed->h_max;
  else if (row.note.empty())
    say("not verified: no run shows this");
  return answer;
}

/// A mode as engineers read it.
std::string words_of(const Mode& mode) {
  if (mode.rates)
    return fmt::format("the overdamped mode of the rates {:.6g} and {:.6g} 1/s", (*mode.rates)[0],
                       (*mode.rates)[1]);
  if (mode.omega && mode.zeta)
    return fmt::format("the mode omega = {:.6g} rad/s, zeta = {:.6g}", *mode.omega, *mode.zeta + 0.0);
  if (mode.lambda.imag() == 0)
    return fmt::format("the mode of the eigenvalue {:.6g} 1/s", mode.lambda.real());
  return fmt::format("the mode of the eigenvalue {:.6g} {:+.6g}i 1/s", mode.lambda.real(),
                     mode.lambda.imag());
}

std::string words_of_bound(const StepAnswer& answer) {
  switch (answer.bound) {
    case Bound::stability:
      return fmt::format("h_max = {:.7g} s, limited by stability{}", answer.h_max,
                         answer.limiting ? " of " + words_of(*answer.limiting) : "");
    case Bound::accuracy:
      return "no step is unstable; accuracy limits it";
    case Bound::newton:
      return "no step is unstable; Newton's method must still solve its equations";
    case Bound::every_step:
      return "every step is unstable";
    case Bound::model:
      return "no step is stable";
    case Bound::error_control:
    case Bound::unknown:
      break;
  }
  return "no limit is known";
}

}  // namespace

StepAnswer largest_stable_step(const MethodChoice& method, const AnySystem& system, const Eigen::VectorXd& y,
                               const StepOptions& options) {
  const Problem problem = problem_of(system, y);
  if (!options.find_equilibrium) {
    if (options.verify)
      throw std::invalid_argument(
          "verify is without find_equilibrium, but runs show the limit of an equilibrium only; set both");
    return answer_of(method, problem, linearised(problem, options.t, y), false);
  }
  if (options.verify && options.t != 0 && !system.is_autonomous())
    throw std::invalid_argument(fmt::format(
        "verify is for the instant 0, at which its runs begin, but t is {:.6g} s; leave verify out, or "
        "ask for a system that does not depend on time",
        options.t));
  const EquilibriumSearch search = find_equilibrium(system, options.t, y);
  Linearised near = linearised(problem, options.t, search.found() ? search.state : y);
  near.point.at_equilibrium = search.found();
  near.point.kind = search.found() ? StateKind::equilibrium : StateKind::initial;
  if (!search.found()) near.point.status = search.message;
  if (search.found() && take_stiffest_side(near.point, problem))
    near.modes = mode_set(near.point.model, false);
  StepAnswer answer = answer_of(method, problem, near, options.verify && search.found());
  // Runs from a state that is no equilibrium leave it, whatever the step.
  if (options.verify && !search.found()) answer.status += "; not verified: this state is no equilibrium";
  return answer;
}

namespace detail {
StepAnswer step_of_structure(const MethodChoice& method, const AnySystem& structure,
                             const StepOptions& options) {
  const Problem problem = problem_of(structure, Eigen::VectorXd::Zero(structure.dim()));
  Linearised near = linearised(problem, 0, problem.y0);
  near.point.at_equilibrium = true;
  near.point.kind = StateKind::equilibrium;
  return answer_of(method, problem, near, options.verify);
}
}  // namespace detail

std::string describe(const StepAnswer& answer) {
  std::string text = fmt::format("{}: {}", answer.method, words_of_bound(answer));
  if (answer.observed)
    text += std::isinf(*answer.observed) ? "; runs show no limit either"
                                         : fmt::format("; runs show {:.7g} s", *answer.observed);
  if (!answer.status.empty()) text += "; " + answer.status;
  return text;
}

}  // namespace hmax
