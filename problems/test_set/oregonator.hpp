/// The Belousov-Zhabotinskii reaction in three concentrations.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/test_set/common.hpp"

namespace hmax {

struct OregonatorParameters {
  double s = 77.27;     ///< [1]
  double w = 0.161;     ///< [1]
  double q = 8.375e-6;  ///< [1]
  static constexpr ParameterNames<OregonatorParameters, 3> names{
      {{"s", &OregonatorParameters::s}, {"w", &OregonatorParameters::w}, {"q", &OregonatorParameters::q}}};
};

/// Scaled concentrations and time, all without unit, y(0) = (1, 2, 3); a limit cycle over five powers of ten.
///   y1' = s (y2 + y1 (1 - q y1 - y2))
///   y2' = (y3 - (1 + y1) y2) / s
///   y3' = w (y1 - y3)
/// @source  [field1974oscillations]; end point of [mazzia2008test], of which 15, 13 and 12 digits are right:
///          113 bits give 1.00081487031852271628, 1228.17852154988798372, 132.055494284650828774
template <class Real>
class Oregonator {
 public:
  using State = Eigen::Matrix<Real, 3, 1>;
  using Jacobian = Eigen::Matrix<Real, 3, 3>;
  using Parameters = OregonatorParameters;
  static constexpr std::string_view id = "oregonator", source = "mazzia2008test",
                                    note = "the Belousov-Zhabotinskii reaction, a stiff limit cycle";
  static constexpr bool autonomous = true, stiff = true;
  static constexpr double t_end = 360;
  /// y(t_end) for the default parameters, and its error relative to each component.
  static constexpr std::array<long double, 3> end_point{0.1000814870318523e1L, 0.1228178521549917e4L,
                                                        0.1320554942846706e3L};
  static constexpr double end_point_error = 2e-13;

  /// @throws std::invalid_argument  when s is zero or a parameter not finite
  explicit Oregonator(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)),
        s_(static_cast<Real>(parameters.s)),
        w_(static_cast<Real>(parameters.w)),
        q_(static_cast<Real>(parameters.q)) {
    detail::require_positive(parameters.s, "s", id);
  }

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  static constexpr Eigen::Index dim() { return 3; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::nonlinear; }
  [[nodiscard]] static std::vector<std::string> states() { return {"y1", "y2", "y3"}; }
  [[nodiscard]] static State y0() { return {Real(1), Real(2), Real(3)}; }

  void rhs(Real /*t*/, const State& y, State& dydt) const noexcept {
    dydt[0] = s_ * (y[1] + y[0] * (Real(1) - q_ * y[0] - y[1]));
    dydt[1] = (y[2] - (Real(1) + y[0]) * y[1]) / s_;
    dydt[2] = w_ * (y[0] - y[2]);
  }
  void jacobian(Real /*t*/, const State& y, Jacobian& J) const noexcept {
    J << s_ * (Real(1) - Real(2) * q_ * y[0] - y[1]), s_ * (Real(1) - y[0]), Real(0),  //
        -y[1] / s_, -(Real(1) + y[0]) / s_, Real(1) / s_,                              //
        w_, Real(0), -w_;
  }

 private:
  Parameters parameters_;
  Real s_, w_, q_;
};

}  // namespace hmax
