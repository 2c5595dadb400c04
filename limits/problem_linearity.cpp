#include "limits/problem_linearity.hpp"

#include <array>
#include <cmath>
#include <variant>

#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {

std::string_view name_of(Linearity linearity) {
  switch (linearity) {
    case Linearity::linear:
      return "linear";
    case Linearity::time_varying:
      return "time_varying";
    case Linearity::nonlinear:
      return "nonlinear";
    case Linearity::unknown:
      break;
  }
  return "unknown";
}

Linearity linearity_of(const Problem& problem) {
  if (problem.matrices)
    return times_of_matrices(problem).empty() ? Linearity::linear : Linearity::time_varying;
  // Loads and moving supports are forces b(t).
  if (problem.body) return has_linear_forces(*problem.body) ? Linearity::linear : Linearity::nonlinear;
  if (const auto* oscillator = std::get_if<Oscillator>(&problem.system))
    return oscillator->parameters().k3 == 0 ? Linearity::linear : Linearity::nonlinear;
  return std::get<AnySystem>(problem.system).linearity();
}

namespace {

/// What an entry is known to, beside the largest of its row.
double known_to(JacobianOrigin origin) { return origin == JacobianOrigin::analytic ? 1e-12 : 1e-6; }

/// The largest entry of each row of a matrix, in modulus.
Eigen::VectorXd largest_of_rows(const AnyMatrix& matrix) {
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(rows(matrix));
  each_entry(matrix, [&](Eigen::Index i, Eigen::Index, double value) {
    largest[i] = std::max(largest[i], std::abs(value));
  });
  return largest;
}

}  // namespace

bool jacobian_differs(const LinearModel& A, const LinearModel& B) {
  const AnyMatrix of_A = A.J(), of_B = B.J();
  if (of_A.index() != of_B.index()) return true;
  const AnyMatrix difference = std::visit(
      [&]<class Matrix>(const Matrix& held) -> AnyMatrix { return Matrix(held - std::get<Matrix>(of_B)); },
      of_A);
  const Eigen::ArrayXd size = largest_of_rows(of_A).cwiseMax(largest_of_rows(of_B)).array();
  const double known = std::max(known_to(A.origin), known_to(B.origin));
  return !(largest_of_rows(difference).array() <= known * size).all();
}

bool depends_on_state(const LinearModel& here,
                      const std::function<LinearModel(const Eigen::VectorXd& y)>& model_at) {
  constexpr std::array distances{1e-6, 1e-3, 1.0, 1e3};
  const Eigen::VectorXd& y = here.y;
  const double largest = y.size() == 0 ? 0 : y.cwiseAbs().maxCoeff();
  Eigen::VectorXd direction(y.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    // No two components alike, so that differences of them change too.
    const double share = 0.5 + 0.5 * std::abs(std::sin(1.0 + static_cast<double>(i)));
    direction[i] = share * (y[i] != 0 ? std::abs(y[i]) : largest > 0 ? largest : 1);
  }
  for (const double distance : distances)
    for (const double sign : {1.0, -1.0}) {
      try {
        if (jacobian_differs(here, model_at(y + sign * distance * direction))) return true;
      } catch (const InputError&) {  // a Jacobian that is not finite there tells nothing of here
      }
    }
  return false;
}

}  // namespace hmax
