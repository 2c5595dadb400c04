#include "limits/jacobian_changes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>

#include "core/errors.hpp"
#include "problems/matrix_entries.hpp"

namespace hmax {

namespace {

bool is_analytic(const LinearModel& model) { return model.origin == JacobianOrigin::analytic; }

/// What an entry is known to, beside itself.
double known_to(const LinearModel& model) { return is_analytic(model) ? 1e-12 : 1e-6; }

/// What rounding makes of the entries of a Jacobian of differences: that of f_i over the increment of y_j.
/// The entries of one row have different units, which a comparison with the largest of them would mix.
class RoundingOfDifferences {
 public:
  /// @param J  that of `model`
  RoundingOfDifferences(const LinearModel& model, const AnyMatrix& J) {
    if (is_analytic(model)) return;
    const double largest = model.y.size() == 0 ? 0 : model.y.cwiseAbs().maxCoeff();
    increments_ = model.y.unaryExpr([&](double y) { return detail::central_increment(y, largest); });
    terms_.setZero(rows(J));
    each_entry(J, [&](Eigen::Index i, Eigen::Index j, double value) {
      terms_[i] = std::max(terms_[i], std::abs(value) * increments_[j]);
    });
    constexpr double roundings = 256, epsilon = std::numeric_limits<double>::epsilon();
    terms_ *= roundings * epsilon / std::cbrt(epsilon);
  }
  /// 0 of analytic Jacobians.
  [[nodiscard]] double of(Eigen::Index i, Eigen::Index j) const {
    return terms_.size() == 0 ? 0 : terms_[i] / increments_[j];
  }

 private:
  Eigen::VectorXd increments_, terms_;  ///< terms: roundings of the largest |J_ij y_j| of each row
};

}  // namespace

bool jacobian_differs(const LinearModel& A, const LinearModel& B) {
  const AnyMatrix of_A = A.J(), of_B = B.J();
  if (of_A.index() != of_B.index()) return true;
  const double known = std::max(known_to(A), known_to(B));
  const AnyMatrix beyond = std::visit(
      [&]<class Matrix>(const Matrix& a) -> AnyMatrix {
        const auto& b = std::get<Matrix>(of_B);
        return Matrix((a - b).cwiseAbs() - known * (a.cwiseAbs() + b.cwiseAbs()));
      },
      of_A);
  const RoundingOfDifferences rounding_A(A, of_A), rounding_B(B, of_B);
  bool differs = false;
  each_entry(beyond, [&](Eigen::Index i, Eigen::Index j, double value) {
    differs = differs || !(value <= rounding_A.of(i, j) + rounding_B.of(i, j));
  });
  return differs;
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
