/// A relaxation oscillator: long quiet phases, jumps between them.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/test_set/common.hpp"

namespace hmax {

struct VanDerPolParameters {
  double mu = 1000;  ///< strength of the nonlinear damping [1]; stiff when large
  static constexpr ParameterNames<VanDerPolParameters, 1> names{{{"mu", &VanDerPolParameters::mu}}};
};

/// x'' - mu (1 - x^2) x' + x = 0 as y = (x, x'), y(0) = (2, 0); everything without unit.
///   y1' = y2,   y2' = mu (1 - y1^2) y2 - y1
/// With mu = 1000 the time 2000 lies behind two jumps.
/// @source  [vanderpol1926relaxation]; end point of [mazzia2008test], whose last two digits are wrong: 113
///          bits give 1.70616773217046500848, -8.9280970102481654777e-4
template <class Real>
class VanDerPol {
 public:
  using State = Eigen::Matrix<Real, 2, 1>;
  using Jacobian = Eigen::Matrix<Real, 2, 2>;
  using Parameters = VanDerPolParameters;
  static constexpr std::string_view id = "van_der_pol", source = "mazzia2008test",
                                    note = "x'' - mu (1 - x^2) x' + x = 0, a stiff relaxation oscillator";
  static constexpr bool autonomous = true, stiff = true;
  static constexpr double t_end = 2000;
  /// y(t_end) for the default parameters, and its error relative to each component.
  static constexpr std::array<long double, 2> end_point{0.1706167732170469e1L, -0.8928097010248125e-3L};
  static constexpr double end_point_error = 5e-15;

  explicit VanDerPol(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)), mu_(static_cast<Real>(parameters.mu)) {}

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  static constexpr Eigen::Index dim() { return 2; }
  [[nodiscard]] Linearity linearity() const { return mu_ == 0 ? Linearity::linear : Linearity::nonlinear; }
  [[nodiscard]] static std::vector<std::string> states() { return {"x", "v"}; }
  [[nodiscard]] static State y0() { return {Real(2), Real(0)}; }

  void rhs(Real /*t*/, const State& y, State& dydt) const noexcept {
    const Real x = y[0], v = y[1];
    dydt[0] = v;
    dydt[1] = mu_ * ((Real(1) - x * x) * v) - x;
  }
  void jacobian(Real /*t*/, const State& y, Jacobian& J) const noexcept {
    const Real x = y[0], v = y[1];
    J << Real(0), Real(1),  //
        Real(-2) * mu_ * x * v - Real(1), mu_ * (Real(1) - x * x);
  }

 private:
  Parameters parameters_;
  Real mu_;
};

}  // namespace hmax
