/// Every diagonally implicit method and Radau IIA as test types, with what their suites share.
#pragma once

#include <complex>
#include <string_view>

#include <gtest/gtest.h>

#include "integrators/implicit/dirk.hpp"
#include "integrators/implicit/dirk_tableaux.hpp"
#include "integrators/implicit/radau.hpp"
#include "integrators/integrate.hpp"
#include "tests/integrators/methods.hpp"

namespace hmax {

template <class T>
struct DirkMethod {
  static constexpr std::string_view id = T::id;
  static constexpr int order = T::order, error_order = T::error_order;
  static constexpr bool l_stable = T::l_stable;
  static constexpr const auto& tableau = T::tableau;
  template <class State, class Matrix = jacobian_of<State>>
  using Stepper = Dirk<T, State, Matrix>;
};
struct RadauMethod {
  static constexpr std::string_view id = "radau_iia_5";
  static constexpr int order = 5, error_order = 4;
  static constexpr bool l_stable = true;
  static constexpr const auto& tableau = radau::tableau;
  template <class State, class Matrix = jacobian_of<State>>
  using Stepper = RadauIIA5<State, Matrix>;
};

using ImplicitEuler = DirkMethod<tableaux::ImplicitEuler>;
using Trapezoidal = DirkMethod<tableaux::Trapezoidal>;
using ImplicitMidpoint = DirkMethod<tableaux::ImplicitMidpoint>;
using TrBdf2 = DirkMethod<tableaux::TrBdf2>;
using Sdirk4 = DirkMethod<tableaux::Sdirk4>;
using EveryImplicitMethod =
    testing::Types<ImplicitEuler, Trapezoidal, ImplicitMidpoint, TrBdf2, Sdirk4, RadauMethod>;
using EveryAdaptiveImplicitMethod = testing::Types<ImplicitEuler, Trapezoidal, TrBdf2, Sdirk4, RadauMethod>;

/// y' = lambda y in its real form, y = (Re, Im).
struct RotatingDecay {
  using State = Eigen::Vector2d;
  static constexpr bool autonomous = true;
  std::complex<double> lambda;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(double, const State& y, State& dydt) const {
    dydt[0] = lambda.real() * y[0] - lambda.imag() * y[1];
    dydt[1] = lambda.imag() * y[0] + lambda.real() * y[1];
  }
  void jacobian(double, const State&, Eigen::Matrix2d& J) const {
    J << lambda.real(), -lambda.imag(), lambda.imag(), lambda.real();
  }
};

}  // namespace hmax
