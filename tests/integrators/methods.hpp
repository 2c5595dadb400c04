/// What the typed suites share: every explicit method as a test type, and small systems with known solutions.
#pragma once

#include <complex>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "integrators/explicit/explicit_rk.hpp"
#include "integrators/explicit/tableaux.hpp"

namespace hmax {

template <class Tuple>
struct TestTypesOf;
template <class... Methods>
struct TestTypesOf<std::tuple<Methods...>> {
  using type = testing::Types<Methods...>;
};

/// Every explicit method; a test of the suite is named Suite/rk4.Sentence.
using EveryMethod = TestTypesOf<tableaux::All>::type;
struct MethodId {
  template <class Method>
  static std::string GetName(int) {
    return std::string(Method::id);
  }
};

/// y' = lambda y, in every component with a factor of its own: y_i(t) = y_i(0) exp(lambda_i t).
template <class StateT>
struct Decay {
  using State = StateT;
  State lambda;  // shape (n)
  [[nodiscard]] Eigen::Index dim() const { return lambda.size(); }
  void rhs(real_of<State>, const State& y, State& dydt) const {
    for (Eigen::Index i = 0; i < y.size(); ++i) dydt[i] = lambda[i] * y[i];
  }
};

/// A pendulum with damping and a drive, nonlinear in y and in t: x' = v, v' = -sin x - v / 10 + cos(3 t).
template <class StateT>
struct Pendulum {
  using State = StateT;
  using Scalar = typename State::Scalar;
  [[nodiscard]] static Eigen::Index dim() { return 2; }
  void rhs(real_of<State> t, const State& y, State& dydt) const {
    dydt[0] = y[1];
    dydt[1] = std::cos(3 * t) - std::sin(y[0]) - y[1] / Scalar(10);
  }
};

/// A function f(t, y, dydt) as a system of n equations.
template <class StateT, class F>
struct SystemOf {
  using State = StateT;
  F f;
  Eigen::Index n = State::RowsAtCompileTime;
  [[nodiscard]] Eigen::Index dim() const { return n; }
  void rhs(real_of<State> t, const State& y, State& dydt) const { f(t, y, dydt); }
};
template <class State, class F>
SystemOf<State, F> system_of(F f, Eigen::Index n = State::RowsAtCompileTime) {
  return {f, n};
}

/// A norm that shows one component of the error estimate as it is.
struct Component {
  Eigen::Index i;
  template <class State, class Error>
  real_of<State> squared(const State&, const State&, const Error& error) const {
    return Eigen::numext::abs2(error(i));
  }
};

}  // namespace hmax
