/// Three reactions whose rates lie nine powers of ten apart.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "problems/test_set/common.hpp"

namespace hmax {

struct RobertsonParameters {
  double k1 = 0.04;  ///< rate of A -> B [1/s]
  double k2 = 3e7;   ///< rate of 2 B -> B + C [1/s], concentrations without unit
  double k3 = 1e4;   ///< rate of B + C -> A + C [1/s]
  static constexpr ParameterNames<RobertsonParameters, 3> names{
      {{"k1", &RobertsonParameters::k1}, {"k2", &RobertsonParameters::k2}, {"k3", &RobertsonParameters::k3}}};
};

/// Concentrations y = (A, B, C) without unit, time in s, y(0) = (1, 0, 0).
///   y1' = -k1 y1 + k3 y2 y3
///   y2' =  k1 y1 - k3 y2 y3 - k2 y2^2
///   y3' =  k2 y2^2
/// y1 + y2 + y3 stays 1. A component that turns negative makes the solution run away: y2 is of size 1e-5 and
/// less, so an absolute tolerance means nothing without looking at each component.
/// @source  [robertson1966solution]; end point of [mazzia2008test], whose sum misses 1 by 1e-14: 113 bits
///          give 2.08334014970129423058e-8, 8.3333607703347834007e-14, 0.99999997916651516938
template <class Real>
class Robertson {
 public:
  using State = Eigen::Matrix<Real, 3, 1>;
  using Jacobian = Eigen::Matrix<Real, 3, 3>;
  using Parameters = RobertsonParameters;
  static constexpr std::string_view id = "robertson", source = "mazzia2008test",
                                    note = "three reactions with rates from 0.04 to 3e7";
  static constexpr bool autonomous = true, stiff = true;
  static constexpr double t_end = 1e11;
  /// y(t_end) for the default parameters, and its error relative to each component.
  static constexpr std::array<long double, 3> end_point{0.2083340149701255e-7L, 0.8333360770334713e-13L,
                                                        0.9999999791665050L};
  static constexpr double end_point_error = 2e-14;

  explicit Robertson(const Parameters& parameters = {})
      : parameters_(detail::finite_parameters(parameters, id)),
        k1_(static_cast<Real>(parameters.k1)),
        k2_(static_cast<Real>(parameters.k2)),
        k3_(static_cast<Real>(parameters.k3)) {}

  [[nodiscard]] const Parameters& parameters() const noexcept { return parameters_; }
  static constexpr Eigen::Index dim() { return 3; }
  [[nodiscard]] static constexpr Linearity linearity() { return Linearity::nonlinear; }
  [[nodiscard]] static std::vector<std::string> states() { return {"A", "B", "C"}; }
  [[nodiscard]] static State y0() { return {Real(1), Real(0), Real(0)}; }

  void rhs(Real /*t*/, const State& y, State& dydt) const noexcept {
    const Real back = k3_ * y[1] * y[2], forth = k1_ * y[0], product = k2_ * y[1] * y[1];
    dydt[0] = back - forth;
    dydt[1] = (forth - back) - product;
    dydt[2] = product;
  }
  void jacobian(Real /*t*/, const State& y, Jacobian& J) const noexcept {
    J << -k1_, k3_ * y[2], k3_ * y[1],                         //
        k1_, -k3_ * y[2] - Real(2) * k2_ * y[1], -k3_ * y[1],  //
        Real(0), Real(2) * k2_ * y[1], Real(0);
  }

  /// No concentration is negative but for what rounding and tolerances make of 0.
  [[nodiscard]] static bool admits(const State& y) noexcept {
    return y.minCoeff() >= Real(-0.1) * std::max(Real(1), total(y));
  }

  /// y1 + y2 + y3, constant along solutions.
  [[nodiscard]] static Real total(const State& y) noexcept { return y[0] + y[1] + y[2]; }

 private:
  Parameters parameters_;
  Real k1_, k2_, k3_;
};

}  // namespace hmax
