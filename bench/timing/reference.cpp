/// References: solutions that errors are measured against, made by engines that take no part.
#include "bench/timing/reference.hpp"

#include <algorithm>
#include <limits>
#include <memory>

#include "bench/timing/extrapolation_reference.hpp"
#include "bench/timing/formula_reference.hpp"
#include "problems/oscillator/oscillator_reference.hpp"

namespace hmax {

namespace {

/// A closed form computed in long double: rounding to double is all its error, with a margin for a motion
/// that is largest between two points looked at.
Reference exact_reference(const Problem& problem, double t_end, const std::function<void()>& watch) {
  double largest = 0;
  constexpr int points = 1000;
  for (int i = 0; i <= points; ++i) {
    if (watch) watch();
    largest = std::max(largest, static_cast<double>(problem.exact(t_end * i / points).cwiseAbs().maxCoeff()));
  }
  return {.at = [exact = problem.exact](double t) -> Eigen::VectorXd { return exact(t).cast<double>(); },
          .valid_until = t_end,
          .error_bound = largest* std::numeric_limits<double>::epsilon(),
          .name = "exact solution in long double",
          .extended_at = problem.exact};
}

/// Extrapolation by the rule that suits the problem; by the other one when it does not get to the end.
Reference extrapolated_reference(const Problem& problem, double t_end, const std::function<void()>& watch) {
  using enum ExtrapolatedRule;
  const ExtendedSystem::State y0 = problem.y0.cast<long double>();
  const auto by = [&](ExtrapolatedRule rule) {
    return std::make_shared<const ExtrapolationReference>(*problem.extended, y0, t_end, rule, watch);
  };
  auto reference = by(problem.stiff ? implicit_euler : explicit_midpoint);
  if (reference->valid_until() < t_end && !problem.stiff && problem.extended->has_jacobian())
    if (auto other = by(implicit_euler); other->valid_until() > reference->valid_until()) reference = other;
  return {.at = [reference](double t) { return reference->at(t); },
          .valid_until = reference->valid_until(),
          .error_bound = reference->error_bound(),
          .name = reference->name(),
          .extended_at = [reference](long double t) -> Eigen::Vector<long double, Eigen::Dynamic> {
            return reference->extended_at(t);
          },
          .extended_error = reference->extended_error_bound()};
}

}  // namespace

Reference make_reference(const Problem& problem, double t_end, const std::function<void()>& watch) {
  if (const auto* oscillator = std::get_if<Oscillator>(&problem.system)) {
    auto taylor = std::make_shared<const OscillatorReference>(oscillator->parameters(),
                                                              Eigen::Vector2d(problem.y0), t_end);
    return {.at = [taylor](double t) -> Eigen::VectorXd { return taylor->at(t); },
            .valid_until = taylor->valid_until(),
            .error_bound = taylor->error_bound(),
            .name = "Taylor series of order 30 in long double",
            .extended_at = [taylor](long double t) -> Eigen::Vector<long double, Eigen::Dynamic> {
              return taylor->extended_at(t);
            }};
  }
  if (problem.exact) return exact_reference(problem, t_end, watch);
  if (problem.extended && problem.extended->has_jacobian())
    return extrapolated_reference(problem, t_end, watch);
  auto formula =
      std::make_shared<FormulaReference>(std::get<AnySystem>(problem.system), problem.y0, t_end, watch);
  return {.at = [formula](double t) { return formula->at(t); },
          .valid_until = formula->valid_until(),
          .error_bound = formula->error_bound(),
          .name = formula->name(),
          .extended_at = nullptr};
}

}  // namespace hmax
