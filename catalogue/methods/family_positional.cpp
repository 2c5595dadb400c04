/// Implicit Euler by a fixed number of iterations, as simulators of soft bodies step it: of bodies alone.
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "catalogue/methods/bind.hpp"
#include "catalogue/methods/families.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "integrators/positional/compliant_constraints.hpp"
#include "integrators/positional/positional_euler.hpp"
#include "integrators/positional/projective_dynamics.hpp"
#include "integrators/positional/truncated_newton.hpp"
#include "integrators/positional/vertex_block_descent.hpp"
#include "problems/tissue/positional_body.hpp"

namespace hmax {

namespace {

/// A whole number of at least 1.
/// @throws InputError  where a parameter is none
int count_of(std::string_view method, const Parameters& values, std::size_t which) {
  constexpr double most = 1e6;
  const auto& [name, value] = values[which];
  if (!(value >= 1 && value <= most) || value != std::floor(value))
    throw input_error(
        "{0} of {1} is {2} but must be a whole number from 1 to 1000000; write for "
        "instance {1}:{0}=10",
        name, method, to_text(value));
  return static_cast<int>(value);
}

/// 0 or 1.
/// @throws InputError  where a parameter is neither
bool is_chosen(std::string_view method, const Parameters& values, std::size_t which, const char* meaning) {
  const auto& [name, value] = values[which];
  if (value != 0 && value != 1)
    throw input_error("{} of {} is {} but must be 0 or 1: {}", name, method, to_text(value), meaning);
  return value == 1;
}

/// The last body that was asked for, with its verbs: maps of one step bind the method in every step.
class LastBody {
 public:
  PositionalBody of(const std::shared_ptr<const TissueBody>& body, PositionalVerbs verbs) {
    const std::lock_guard lock(mutex_);
    if (!made_ || made_->first != body) made_.emplace(body, PositionalBody(body, verbs));
    return made_->second;
  }

 private:
  std::mutex mutex_;
  std::optional<std::pair<std::shared_ptr<const TissueBody>, PositionalBody>> made_;
};

/// What all of them have in common.
/// @param make  Parameters -> the iteration of PositionalEuler
template <class Make>
Method positional(std::string id, std::string source, PositionalVerbs verbs, const Parameters& values,
                  const Make& make) {
  Method method{.id = std::move(id), .order = 1, .stages = 1, .source = std::move(source)};
  method.is_explicit = false;
  method.needs_second_order = true;
  const int iterations = count_of(method.id, values, 0), substeps = count_of(method.id, values, 1);
  const auto iteration = make(values);
  method.unsuited = [verbs](const Problem& problem) {
    return problem.body ? PositionalBody::why_not(*problem.body, verbs)
                        : fmt::format("moves the points of a body, and {} is none; take a mesh with --mesh",
                                      problem.id);
  };
  method.bind = [=, last = std::make_shared<LastBody>()](const Problem& problem) {
    using Stepper = PositionalEuler<std::decay_t<decltype(iteration)>>;
    return make_runner(detail::StepperEngine<Stepper>{Stepper(iteration, iterations, substeps), 0},
                       last->of(problem.body, verbs), problem.y0);
  };
  return method;
}

Method vbd(const Parameters& values) {
  Method method =
      positional("vbd", "chen2024vertex", PositionalVerbs::points, values, [](const Parameters& p) {
        const double rho = p[2].second;
        if (!(rho >= 0 && rho < 1))
          throw input_error(
              "rho of vbd is {} but must lie between 0 and 1: it is the spectral "
              "radius of the iteration, 0 takes it as it is",
              to_text(rho));
        return VertexBlockDescent(rho);
      });
  method.note = "moves one point after the other to where its force vanishes";
  return method;
}

Method xpbd(const Parameters& values) {
  Method method =
      positional("xpbd", "macklin2016xpbd", PositionalVerbs::constraints, values, [](const Parameters& p) {
        return CompliantConstraints(
            is_chosen("xpbd", p, 2, "1 forgets the multipliers in every iteration, as some engines do"));
      });
  method.note = "meets one compliant constraint after the other";
  return method;
}

Method pbd(const Parameters& values) {
  Method method =
      positional("pbd", "muller2007position", PositionalVerbs::constraints, values, [](const Parameters& p) {
        const double stiffness = p[2].second;
        if (!(stiffness > 0 && stiffness <= 1))
          throw input_error(
              "stiffness of pbd is {} but must lie above 0 and at most at 1: it is the share of a "
              "constraint that all iterations together meet",
              to_text(stiffness));
        return CompliantConstraints::stiff(CompliantConstraints::share_of(stiffness, p[0].second));
      });
  method.unsuited = [of_constraints = method.unsuited](const Problem& problem) -> std::string {
    if (problem.body && !problem.body->settings().model.is_of_springs()) {
      // What keeps points from moving one by one keeps all that are named here away.
      if (std::string why = PositionalBody::why_no_pieces(*problem.body); !why.empty()) return why;
      return "keeps the lengths of springs, and a tetrahedron has none; take mass_spring, or of fem_neo_hookean the method xpbd";
    }
    if (std::string why = of_constraints(problem); !why.empty()) return why;
    if (problem.body->settings().beta != 0)
      return "has no damping of stiffness; leave beta out, or take the method xpbd";
    return {};
  };
  method.note = "gives springs their lengths, one after the other, whatever their stiffness";
  return method;
}

Method projective_dynamics(const Parameters& values) {
  Method method = positional("projective_dynamics", "bouaziz2014projective", PositionalVerbs::weights, values,
                             [](const Parameters&) { return ProjectiveDynamics(); });
  method.note = "iterations with one factored matrix for all of them";
  return method;
}

Method newton_truncated(const Parameters& values) {
  const bool frozen =
      is_chosen("newton_truncated", values, 3, "1 keeps the stiffness and damping of the start of the run");
  Method method = positional(
      "newton_truncated", "baraff1998large", PositionalVerbs::forces, values,
      [frozen](const Parameters& p) { return TruncatedNewton(count_of("newton_truncated", p, 2), frozen); });
  method.keeps_start = frozen;
  method.note =
      "iterations of Newton's method, each of a few conjugate gradients (cg); frozen=1 keeps the matrix of the start";
  return method;
}

}  // namespace

void add_positional(std::vector<Method>& all) {
  all.push_back(with_defaults(vbd, {{"iterations", 10}, {"substeps", 1}, {"rho", 0}}));
  all.push_back(with_defaults(xpbd, {{"iterations", 10}, {"substeps", 1}, {"reset", 0}}));
  all.push_back(with_defaults(pbd, {{"iterations", 10}, {"substeps", 1}, {"stiffness", 1}}));
  all.push_back(with_defaults(projective_dynamics, {{"iterations", 10}, {"substeps", 1}}));
  all.push_back(
      with_defaults(newton_truncated, {{"iterations", 1}, {"substeps", 1}, {"cg", 10}, {"frozen", 0}}));
}

}  // namespace hmax
