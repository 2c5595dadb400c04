/// A stiff relaxation towards a smooth motion.
#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/test_set/common.hpp"

namespace hmax {

struct ProtheroRobinsonParameters {
  double lambda = -1e6;  ///< rate of the relaxation [1/s]; stiff when very negative
  static constexpr ParameterNames<ProtheroRobinsonParameters, 1> names{
      {{"lambda", &ProtheroRobinsonParameters::lambda}}};
};

/// y' = lambda (y - phi(t)) + phi'(t) with phi(t) = cos t and y(0) = phi(0) = 1, so that y = phi for every
/// lambda. For |h lambda| >> 1 a Runge-Kutta method falls to about its stage order here. t in s, y without
/// unit. The stiff part of the split is lambda (y - phi).
/// @source  [prothero1974stability]; [hairer1996solving, IV.15]
template <class Real>
class ProtheroRobinson {
 public:
  using State = Eigen::Matrix<Real, 1, 1>;
  using Jacobian = Eigen::Matrix<Real, 1, 1>;
  using Parameters = ProtheroRobinsonParameters;
  static constexpr std::string_view id = "prothero_robinson", source = "prothero1974stability",
                                    note = "y' = lambda (y - cos t) - sin t, where stiffness reduces orders";
  static constexpr bool autonomous = false, stiff = true;
  static constexpr double t_end = 10;

  explicit ProtheroRobinson(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)),
        lambda_(static_cast<Real>(parameters.lambda)) {}

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  static constexpr Eigen::Index dim() { return 1; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::linear; }
  [[nodiscard]] static std::vector<std::string> states() { return {"y"}; }
  [[nodiscard]] static State y0() { return State(Real(1)); }

  void rhs(Real t, const State& y, State& dydt) const noexcept {
    using std::cos, std::sin;
    dydt[0] = lambda_ * (y[0] - cos(t)) - sin(t);
  }
  void jacobian(Real /*t*/, const State& /*y*/, Jacobian& J) const noexcept { J(0, 0) = lambda_; }
  /// df/dt = lambda sin t - cos t.
  void time_derivative(Real t, const State& /*y*/, State& dfdt) const noexcept {
    using std::cos, std::sin;
    dfdt[0] = lambda_ * sin(t) - cos(t);
  }
  [[nodiscard]] Real spectral_radius(Real /*t*/, const State& /*y*/) const noexcept {
    return std::abs(lambda_);
  }

  static constexpr bool linear_stiff_part = true;
  void rhs_stiff(Real t, const State& y, State& dydt) const noexcept {
    using std::cos;
    dydt[0] = lambda_ * (y[0] - cos(t));
  }
  void jacobian_stiff(Real t, const State& y, Jacobian& J) const noexcept { jacobian(t, y, J); }
  void rhs_nonstiff(Real t, const State& /*y*/, State& dydt) const noexcept {
    using std::sin;
    dydt[0] = -sin(t);
  }

  /// cos t + (y(0) - 1) e^(lambda t).
  [[nodiscard]] State exact(Real t, const State& start) const {
    using std::cos, std::exp;
    const Real gap = start[0] - Real(1);
    return State(gap == Real(0) ? cos(t) : cos(t) + gap * exp(lambda_ * t));
  }

 private:
  Parameters parameters_;
  Real lambda_;
};

}  // namespace hmax
