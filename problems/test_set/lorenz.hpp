/// Deterministic chaos.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/test_set/common.hpp"

namespace hmax {

struct LorenzParameters {
  double sigma = 10;      ///< Prandtl number [1]
  double rho = 28;        ///< Rayleigh number over its critical value [1]
  double beta = 8 / 3.0;  ///< shape of the convection cell [1]
  static constexpr ParameterNames<LorenzParameters, 3> names{{{"sigma", &LorenzParameters::sigma},
                                                              {"rho", &LorenzParameters::rho},
                                                              {"beta", &LorenzParameters::beta}}};
};

/// Convection in three modes, everything without unit, y(0) = (0, 1, 0).
///   x' = sigma (y - x),   y' = x (rho - z) - y,   z' = x y - beta z
/// Errors grow about like e^(0.9 t): twenty units of time cost eight digits.
/// @source  [lorenz1963deterministic]; the end point was computed in 113 bits, by the extrapolation that in
///          long double serves as the reference
template <class Real>
class Lorenz {
 public:
  using State = Eigen::Matrix<Real, 3, 1>;
  using Jacobian = Eigen::Matrix<Real, 3, 3>;
  using Parameters = LorenzParameters;
  static constexpr std::string_view id = "lorenz", source = "lorenz1963deterministic",
                                    note = "convection in three modes, chaotic";
  static constexpr bool autonomous = true, stiff = false;
  static constexpr double t_end = 20;
  /// y(t_end) for the default parameters, and its error relative to its largest component.
  static constexpr std::array<long double, 3> end_point{-1.3563489845808243968L, -2.3873000522778245816L,
                                                        12.389984994086302357L};
  static constexpr double end_point_error = 1e-17;

  explicit Lorenz(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)),
        sigma_(static_cast<Real>(parameters.sigma)),
        rho_(static_cast<Real>(parameters.rho)),
        beta_(static_cast<Real>(parameters.beta)) {}

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  static constexpr Eigen::Index dim() { return 3; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::nonlinear; }
  [[nodiscard]] static std::vector<std::string> states() { return {"x", "y", "z"}; }
  [[nodiscard]] static State y0() { return {Real(0), Real(1), Real(0)}; }

  void rhs(Real /*t*/, const State& y, State& dydt) const noexcept {
    const Real x = y[0], v = y[1], z = y[2];
    dydt[0] = sigma_ * (v - x);
    dydt[1] = x * (rho_ - z) - v;
    dydt[2] = x * v - beta_ * z;
  }
  void jacobian(Real /*t*/, const State& y, Jacobian& J) const noexcept {
    J << -sigma_, sigma_, Real(0),     //
        rho_ - y[2], Real(-1), -y[0],  //
        y[1], y[0], -beta_;
  }

 private:
  Parameters parameters_;
  Real sigma_, rho_, beta_;
};

}  // namespace hmax
