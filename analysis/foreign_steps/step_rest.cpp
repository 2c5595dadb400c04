#include "analysis/foreign_steps/step_rest.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "analysis/foreign_steps/step_derivative.hpp"
#include "core/dense_solvers.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

using Eigen::VectorXd;

StepRest by_newton(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale,
                   int slot, VectorXd y, double h, StepPattern& pattern, double tolerance) {
  const Eigen::Index n = coordinates.size();
  StepRest rest{.y = std::move(y)};
  rest.left = rest.error = distance_of_step(engine, coordinates, scale, slot, rest.y, h);
  for (int k = 0; k < 10 && rest.left > tolerance && std::isfinite(rest.left); ++k) {
    StepDerivative derivative(engine, coordinates, scale, slot, rest.y, h);
    const VectorXd step = coordinates.of(rest.y, derivative.next()).cwiseQuotient(scale);
    const std::optional<Eigen::SparseMatrix<double>> grouped =
        pattern.pays() ? derivative.grouped_matrix(pattern) : std::nullopt;
    const Eigen::MatrixXd J = grouped ? Eigen::MatrixXd(*grouped) : derivative.matrix(pattern);
    rest.error = infinity;
    if (!J.allFinite()) break;
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n) - J;
    const double threshold = std::max(1e-12, derivative.error() / A.norm());
    const VectorXd x = minimum_norm_solution(A, step, threshold);
    rest.error = x.cwiseAbs().maxCoeff();
    const VectorXd tried = coordinates.at(rest.y, x.cwiseProduct(scale));
    const double now = distance_of_step(engine, coordinates, scale, slot, tried, h);
    if (!(now < 0.5 * rest.left)) break;
    rest = {.y = tried, .left = now, .error = rest.error * now / rest.left};
  }
  return rest;
}

}  // namespace

double distance_of_step(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale,
                        int slot, const VectorXd& y, double h) {
  const VectorXd next = engine.after(slot, y, h, 1);
  return next.allFinite() ? coordinates.of(y, next).cwiseQuotient(scale).cwiseAbs().maxCoeff() : infinity;
}

StepRest rest_of_step(ForeignStepper& engine, const StateCoordinates& coordinates, const VectorXd& scale,
                      int slot, const VectorXd& y, double h, StepPattern& pattern, double tolerance,
                      double near_rest) {
  constexpr std::int64_t run = 2000;
  const auto near = [&](const VectorXd& start) {
    return by_newton(engine, coordinates, scale, slot, start, h, pattern, tolerance);
  };
  StepRest found = near(y);
  if (found.left <= near_rest) return found;
  const VectorXd later = engine.after(slot, y, h, run);
  if (!later.allFinite()) return found;
  const StepRest settled = near(later);
  return settled.left < found.left ? settled : found;
}

}  // namespace hmax
