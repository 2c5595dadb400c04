/// High irradiance response of a plant: eight concentrations.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/test_set/common.hpp"

namespace hmax {

/// Growth and differentiation of plant tissue under light, independent of photosynthesis: concentrations y
/// without unit, time in minutes, y(0) = (1, 0, 0, 0, 0, 0, 0, 0.0057).
///   y1' = -1.71 y1 + 0.43 y2 + 8.32 y3 + 0.0007
///   y2' =  1.71 y1 - 8.75 y2
///   y3' = -10.03 y3 + 0.43 y4 + 0.035 y5
///   y4' =  8.32 y2 + 1.71 y3 - 1.12 y4
///   y5' = -1.745 y5 + 0.43 y6 + 0.43 y7
///   y6' = -280 y6 y8 + 0.69 y4 + 1.71 y5 - 0.43 y6 + 0.69 y7
///   y7' =  280 y6 y8 - 1.81 y7
///   y8' = -y7'
/// y7 + y8 stays 0.0057.
/// @source  [schafer1975new]; end point of [mazzia2008test], right to its last digit for these decimals. As
///          doubles, 321.8122 above all, they move it by up to 2e-13.
template <class Real>
class Hires {
 public:
  using State = Eigen::Matrix<Real, 8, 1>;
  using Jacobian = Eigen::Matrix<Real, 8, 8>;
  using Parameters = NoParameters;
  static constexpr std::string_view id = "hires", source = "mazzia2008test",
                                    note = "high irradiance response of a plant, eight concentrations";
  static constexpr bool autonomous = true, stiff = true;
  static constexpr double t_end = 321.8122;
  /// y(t_end), and its error relative to each component when all numbers are doubles.
  static constexpr std::array<long double, 8> end_point{
      0.7371312573325668e-3L, 0.1442485726316185e-3L, 0.5888729740967575e-4L, 0.1175651343283149e-2L,
      0.2386356198831331e-2L, 0.6238968252742796e-2L, 0.2849998395185769e-2L, 0.2850001604814231e-2L};
  static constexpr double end_point_error = 2e-13;

  explicit Hires(const Parameters& /*none*/ = {}) {}

  [[nodiscard]] static Parameters parameters() noexcept { return {}; }
  static constexpr Eigen::Index dim() { return 8; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::nonlinear; }
  [[nodiscard]] static std::vector<std::string> states() {
    return {"y1", "y2", "y3", "y4", "y5", "y6", "y7", "y8"};
  }
  [[nodiscard]] static State y0() {
    State y = State::Zero();
    y[0] = Real(1);
    y[7] = r(0.0057);
    return y;
  }

  void rhs(Real /*t*/, const State& y, State& dydt) const noexcept {
    const Real pair = r(280) * y[5] * y[7];
    dydt[0] = r(-1.71) * y[0] + r(0.43) * y[1] + r(8.32) * y[2] + r(0.0007);
    dydt[1] = r(1.71) * y[0] - r(8.75) * y[1];
    dydt[2] = r(-10.03) * y[2] + r(0.43) * y[3] + r(0.035) * y[4];
    dydt[3] = r(8.32) * y[1] + r(1.71) * y[2] - r(1.12) * y[3];
    dydt[4] = r(-1.745) * y[4] + r(0.43) * (y[5] + y[6]);
    dydt[5] = -pair + r(0.69) * y[3] + r(1.71) * y[4] - r(0.43) * y[5] + r(0.69) * y[6];
    dydt[6] = pair - r(1.81) * y[6];
    dydt[7] = -dydt[6];
  }
  void jacobian(Real /*t*/, const State& y, Jacobian& J) const noexcept {
    J.setZero();
    J(0, 0) = r(-1.71), J(0, 1) = r(0.43), J(0, 2) = r(8.32);
    J(1, 0) = r(1.71), J(1, 1) = r(-8.75);
    J(2, 2) = r(-10.03), J(2, 3) = r(0.43), J(2, 4) = r(0.035);
    J(3, 1) = r(8.32), J(3, 2) = r(1.71), J(3, 3) = r(-1.12);
    J(4, 4) = r(-1.745), J(4, 5) = r(0.43), J(4, 6) = r(0.43);
    J(5, 3) = r(0.69), J(5, 4) = r(1.71), J(5, 5) = -r(280) * y[7] - r(0.43), J(5, 6) = r(0.69);
    J(5, 7) = -r(280) * y[5];
    J(6, 5) = r(280) * y[7], J(6, 6) = r(-1.81), J(6, 7) = r(280) * y[5];
    J.row(7) = -J.row(6);
  }

 private:
  static constexpr Real r(double value) { return static_cast<Real>(value); }
};

}  // namespace hmax
